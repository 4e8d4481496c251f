// SPDX-License-Identifier: Apache-2.0
// Chunks of pages are mapped one by one. Room for them on the disk is reserved first: a write to a page without room
// would end the process.
#include "rdf/store/indexes/draft_pages.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <new>
#include <string>

#include "rdf/file/lmdb_handles.hpp"

namespace cluxel::rdf {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kChunkBytes = std::size_t{4} << 20U, kPagesOfChunk = kChunkBytes / DraftPages::kPageBytes;
constexpr std::size_t kChunksInMemory = 4;

/// Some file systems know no files without a name.
int openNameless(const fs::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (descriptor >= 0) return descriptor;
  std::string name = folder / ".cluxel-index-XXXXXX";
  const int named = ::mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) ::unlink(name.c_str());
  return named;
}

}  // namespace

DraftPages::~DraftPages() {
  for (void* const chunk : chunks_) ::munmap(chunk, kChunkBytes);
}

std::uint8_t* DraftPages::take() {
  if (free_.empty()) addChunk();
  std::uint8_t* const page = free_.back();
  free_.pop_back();
  return page;
}

void DraftPages::addChunk() {
  chunks_.reserve(chunks_.size() + 1);
  free_.reserve(free_.size() + kPagesOfChunk);
  void* const chunk = chunks_.size() < kChunksInMemory
                          ? ::mmap(nullptr, kChunkBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0)
                          : mapOfFile();
  if (chunk == MAP_FAILED) throw std::bad_alloc();
  chunks_.push_back(chunk);
  for (std::size_t page = kPagesOfChunk; page-- > 0;)
    free_.push_back(static_cast<std::uint8_t*>(chunk) + page * kPageBytes);
}

void* DraftPages::mapOfFile() {
  const fs::path folder = folder_.empty() ? "." : folder_;
  if (file_.get() < 0) file_ = Descriptor(openNameless(folder));
  if (file_.get() < 0) failStore(folder, errno, "make a file for an index that changes");
  const auto at = static_cast<off_t>((chunks_.size() - kChunksInMemory) * kChunkBytes);
  if (const int code = ::posix_fallocate(file_.get(), at, static_cast<off_t>(kChunkBytes)); code != 0)
    failStore(folder, code, "reserve room for an index that changes");
  return ::mmap(nullptr, kChunkBytes, PROT_READ | PROT_WRITE, MAP_SHARED, file_.get(), at);
}

}  // namespace cluxel::rdf
