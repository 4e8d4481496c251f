// SPDX-License-Identifier: Apache-2.0
// No text that a query makes grows without end: doubling one again and again would fill any memory.
#pragma once

#include "cluxel/base/diagnostic.hpp"

namespace cluxel::sparql {

inline constexpr std::size_t kMostTextBytes = std::size_t{64} << 20;

/// Throws Error (BudgetExceeded) above kMostTextBytes.
inline void requireTextSize(std::size_t bytes) {
  if (bytes > kMostTextBytes) throw Error(ExitCode::BudgetExceeded, "query: a text grows beyond 64 MiB");
}

}  // namespace cluxel::sparql
