// SPDX-License-Identifier: Apache-2.0
// Asks the C library.
#include "base/free_memory.hpp"

#include <malloc.h>

namespace cluxel {

void returnFreeMemory() {
  constexpr std::size_t kKept = 300'000'000;
  if (::mallinfo2().fordblks > kKept) ::malloc_trim(0);
}

}  // namespace cluxel
