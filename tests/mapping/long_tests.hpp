// SPDX-License-Identifier: Apache-2.0
// Whether the tests are to go through many cases (./run test --long).
#pragma once

#include <cstdlib>

namespace cluxel::mapping {

inline bool isLong() {
  return std::getenv("CLUXEL_LONG_TESTS") != nullptr;
}

}  // namespace cluxel::mapping
