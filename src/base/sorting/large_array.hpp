// SPDX-License-Identifier: Apache-2.0
// Arrays that may not fit into memory: large ones are mapped from temporary files, whose pages the system writes out
// and takes back when it needs the memory.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

namespace cluxel {

/// An array of more bytes is in a file.
inline constexpr std::size_t kMostBytesInMemory = std::size_t{16} << 20U;

/// Memory from a file without a name in the folder for temporary files, with room on the disk for all of it. Throws
/// Error (StoreUnavailable) when the folder cannot be used or is full, and when the process may not write files of this
/// size; std::bad_alloc when no addresses are left.
void* mapTemporaryFile(std::size_t bytes);
void unmapTemporaryFile(void* memory, std::size_t bytes) noexcept;

template <typename Value>
struct LargeArrayAllocator {
  using value_type = Value;

  LargeArrayAllocator() = default;
  template <typename Other>
  explicit(false) LargeArrayAllocator(const LargeArrayAllocator<Other>& /*other*/) {}

  Value* allocate(std::size_t count) {
    if (!isInFile(count)) return std::allocator<Value>().allocate(count);
    return static_cast<Value*>(mapTemporaryFile(count * sizeof(Value)));
  }
  void deallocate(Value* values, std::size_t count) noexcept {
    if (!isInFile(count)) return std::allocator<Value>().deallocate(values, count);
    unmapTemporaryFile(values, count * sizeof(Value));
  }
  template <typename Other>
  bool operator==(const LargeArrayAllocator<Other>& /*other*/) const {
    return true;
  }

 private:
  static bool isInFile(std::size_t count) { return count > kMostBytesInMemory / sizeof(Value); }
};

/// A vector of plain values. Which of them are in files changes no answer.
template <typename Value>
using LargeArray = std::vector<Value, LargeArrayAllocator<Value>>;

}  // namespace cluxel
