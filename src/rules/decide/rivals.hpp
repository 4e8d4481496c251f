// SPDX-License-Identifier: Apache-2.0
// Chooses among candidates that want the same fragments: the set without conflicts that has the highest score.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace cluxel::rules {

/// A candidate as the choice sees it. Candidates are given in canonical order, which settles ties.
struct Rival {
  std::int64_t score = 0;             ///< log-odds over those of leaving its fragments uncovered, in units of 1e-6
  std::vector<std::uint32_t> owned;   ///< items that no other candidate may have
  std::vector<std::uint32_t> shared;  ///< items that candidates of the same class may share
  std::uint32_t share_class = 0;
  bool is_likely = false;     ///< it is decided before its unlikely rivals
  bool is_held_back = false;  ///< for this round, in which its score counts as 0
};

/// Groups of up to this many rivals are solved exactly.
inline constexpr std::size_t kMaxExactRivals = 24;

/// Whether each rival is chosen. Only candidates with a score above 0 are. Among sets with the highest score the one
/// that has the earliest candidates is chosen. Groups of more than kMaxExactRivals start from the best candidates
/// and are improved by exchanges until none helps. Cost: exponential in small groups only.
std::vector<bool> chooseAmongRivals(std::span<const Rival> rivals);

/// For each rival the numbers of those it conflicts with, ascending.
std::vector<std::vector<std::uint32_t>> conflictsOf(std::span<const Rival> rivals);

}  // namespace cluxel::rules
