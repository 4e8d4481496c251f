// SPDX-License-Identifier: Apache-2.0
// Giving memory back: `vector = {}` and clear() keep it.
#pragma once

#include <vector>

namespace cluxel {

template <typename... Values>
void freeMemory(std::vector<Values>&... vectors) {
  (std::vector<Values>().swap(vectors), ...);
}

/// Gives memory that is free, but was kept for reuse, back to the system, when it is more than some 300 MB. After a
/// batch the next one begins with the memory that it needs. The system clears the pages when they are needed again.
void returnFreeMemory();

}  // namespace cluxel
