// SPDX-License-Identifier: Apache-2.0
// Giving memory back: `vector = {}` and clear() keep it.
#pragma once

#include <vector>

namespace cluxel {

template <typename... Values>
void freeMemory(std::vector<Values>&... vectors) {
  (std::vector<Values>().swap(vectors), ...);
}

}  // namespace cluxel
