// SPDX-License-Identifier: Apache-2.0
// Bytes that are written once and read again, and need not fit into memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace cluxel {

/// Throws Error (StoreUnavailable): a temporary file cannot be "made", or what else was tried. `code`: as errno.
[[noreturn]] void failTemporaryFile(const std::string& what, int code);
/// Throws it when the process may not write files of so many bytes: to do so would send a signal that ends it.
void requireFileSize(const std::string& what, std::uint64_t bytes);

/// A file without a name in the folder for temporary files, made when the first bytes come. A kill leaves nothing.
class TemporaryBytes {
 public:
  TemporaryBytes() = default;
  TemporaryBytes(const TemporaryBytes&) = delete;
  TemporaryBytes& operator=(const TemporaryBytes&) = delete;
  ~TemporaryBytes();

  /// Returns where the bytes begin. Throws Error (StoreUnavailable) when the folder cannot be used or is full.
  std::uint64_t append(std::string_view bytes);
  /// Reads `count` bytes that were appended. Throws as append().
  void read(std::uint64_t place, char* into, std::size_t count) const;
  /// How many bytes were appended.
  std::uint64_t size() const { return size_; }
  /// Forgets all bytes, and gives their room on the disk back. Throws as append().
  void clear();

 private:
  std::uint64_t size_ = 0;
  int file_ = -1;
};

}  // namespace cluxel
