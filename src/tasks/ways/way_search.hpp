// SPDX-License-Identifier: Apache-2.0
// Cheapest ways over a grid of cells.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "tasks/ways/passable_grid.hpp"

namespace cluxel::tasks {

/// What a search may use, and what a metre costs.
struct SearchRules {
  bool is_priced = true;  ///< by PassableGrid::factor; false: a metre costs 1
  /// What entering a closed cell, or a step that is too high, costs beside its length; absent: they are not entered.
  std::optional<double> closed_cost = std::nullopt;
  /// Where the search may stop; absent: it reaches every cell.
  std::optional<std::uint32_t> goal = std::nullopt;
};

/// By cell; infinite where no way leads.
struct CheapestWays {
  LargeArray<double> cost;
  LargeArray<std::uint32_t> before;  ///< the cell before on the way; the cell itself at the start
};

/// Ways lead to the eight neighbours; a diagonal needs both cells beside it. Cost: O(cells log cells).
CheapestWays cheapestWays(const PassableGrid& grid, std::uint32_t start, const SearchRules& rules = {});

/// The cells from the start to `goal`, both included; empty when no way leads there.
std::vector<std::uint32_t> wayTo(const CheapestWays& ways, std::uint32_t goal);

}  // namespace cluxel::tasks
