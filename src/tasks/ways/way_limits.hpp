// SPDX-License-Identifier: Apache-2.0
// The limits of the numbers of walks: for commands, tasks by name and the facade.
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
    kDetection{0, 1}, kAlternatives{1, 9}, kTourStops{1, 100}, kMinutes{0, 600}, kSpeed_m_s{0.01, 100};
/// 0 is no limit in requests and for tasks by name. Commands and the facade, where it can be left out, refuse 0, as
/// commands refuse a walk of 0 minutes.
inline constexpr Limits kBudget_m{0, 1e6};
inline constexpr std::array<double, 4> kCells_m{0.125, 0.25, 0.5, 1};

/// Throws Error (InvalidArgument) for a number beyond its limits, and for NaN. `name` says what it is.
void requireWithin(const Limits& limits, double value, const std::string& name);

/// Throws Error (InvalidArgument) for numbers that no walk can have. It is for requests of programs: commands and tasks
/// by name check each number by its limits where they read it.
void requireValid(const WayRequest& request);
/// The same for a search.
void requireValid(const SearchRequest& request);

}  // namespace cluxel::tasks
