// SPDX-License-Identifier: Apache-2.0
// Chunks of pages are mapped one by one. Room for them on the disk is reserved first: a write to a page without room
// would end the process.
#include "rdf/store/indexes/draft_pages.hpp"

#include <fcntl.h>
#include <sys/mman.h>

#include <cerrno>
#include <new>
#include <string>
#include <system_error>

#include "base/sorting/nameless_file.hpp"
#include "rdf/file/lmdb_handles.hpp"

namespace cluxel::rdf {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kChunkBytes = std::size_t{4} << 20U, kPagesOfChunk = kChunkBytes / DraftPages::kPageBytes;
constexpr std::size_t kChunksInMemory = 4;

void* anonymousMap() {
  return ::mmap(nullptr, kChunkBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
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
  if (chunks_.size() == kChunksInMemory) openFile();
  void* const chunk = file_.get() < 0 ? anonymousMap() : mapOfFile();
  if (chunk == MAP_FAILED) throw std::bad_alloc();
  chunks_.push_back(chunk);
  for (std::size_t page = kPagesOfChunk; page-- > 0;)
    free_.push_back(static_cast<std::uint8_t*>(chunk) + page * kPageBytes);
}

std::size_t DraftPages::bytes() const {
  return chunks_.size() * kChunkBytes;
}

/// The folder of a map may be closed to those who may write the map, and that of a temporary map is gone.
void DraftPages::openFile() {
  file_ = Descriptor(openNamelessFile(folder_));
  if (file_.get() >= 0) return;
  std::error_code ignored;
  folder_ = fs::temp_directory_path(ignored);
  file_ = Descriptor(openNamelessFile(folder_));
}

void* DraftPages::mapOfFile() {
  const auto at = static_cast<off_t>((chunks_.size() - kChunksInMemory) * kChunkBytes);
  int code = EINTR;
  while (code == EINTR) code = ::posix_fallocate(file_.get(), at, static_cast<off_t>(kChunkBytes));
  if (code != 0) failStore(folder_, code, "reserve room for an index that changes");
  return ::mmap(nullptr, kChunkBytes, PROT_READ | PROT_WRITE, MAP_SHARED, file_.get(), at);
}

}  // namespace cluxel::rdf
