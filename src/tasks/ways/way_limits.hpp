// SPDX-License-Identifier: Apache-2.0
// The limits of the numbers of walks: the same for commands, tasks by name and the facade.
#pragma once

#include <array>
#include <string>

#include "tasks/search/search_tour.hpp"
#include "tasks/ways/route.hpp"

namespace cluxel::tasks {

/// Limits of a number, both included.
struct Limits {
  double min = 0, max = 0;
};

inline constexpr Limits kWidth_m{0, 20}, kMaxSlope{0, 10}, kMaxStep_m{0, 2}, kClearance_m{0.3, 20}, kView_m{1, 100},
    kDetection{0, 1}, kAlternatives{1, 9}, kTourStops{1, 100};
inline constexpr std::array<double, 4> kCells_m{0.125, 0.25, 0.5, 1};

/// Throws Error (InvalidArgument) for a number beyond its limits, and for NaN. `name` says what it is.
void requireWithin(const Limits& limits, double value, const std::string& name);

/// Throws Error (InvalidArgument) for numbers that no walk can have.
void requireValid(const WayRequest& request);
/// The same for a search, and for a budget below 0.
void requireValid(const SearchRequest& request);

}  // namespace cluxel::tasks
