// SPDX-License-Identifier: Apache-2.0
// A map file in memory, apart from LMDB's own mapping.
#pragma once

#include <sys/mman.h>

#include <cerrno>
#include <cstdint>
#include <filesystem>

#include "rdf/file/lmdb_handles.hpp"

namespace cluxel::rdf {

/// A read-only mapping of the whole file.
class FileMapping {
 public:
  FileMapping(int descriptor, std::size_t size, const std::filesystem::path& file) : size_(size) {
    memory_ = ::mmap(nullptr, size, PROT_READ, MAP_SHARED, descriptor, 0);
    if (memory_ == MAP_FAILED) failStore(file, ENOMEM, "map the file");
  }
  FileMapping(const FileMapping&) = delete;
  FileMapping& operator=(const FileMapping&) = delete;
  ~FileMapping() { ::munmap(memory_, size_); }
  const std::uint8_t* bytes() const { return static_cast<const std::uint8_t*>(memory_); }

 private:
  std::size_t size_;
  void* memory_;
};

}  // namespace cluxel::rdf
