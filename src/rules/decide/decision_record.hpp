// SPDX-License-Identifier: Apache-2.0
// Describes what a rule decided about a candidate, with the path through its tree and its evidence.
#pragma once

#include <cstdint>

#include "rules/propose/tree_walk.hpp"

namespace cluxel::rules {

/// A walk through the tree of a rule together with its outcome.
struct Verdict {
  Decision decision;
  Bindings bindings;  ///< what the walk bound
  std::optional<OwnerIndex> related;
  std::uint64_t trace = 0;                          ///< a hash of all of this
  std::vector<perception::PrimitiveIndex> members;  ///< of what is bound, ascending
  const AcceptLeaf* accept = nullptr;               ///< absent for a rejection
  bool leaves_unknown = false;                      ///< a rejection after which no rule may take the seed
};

/// Walks the tree of the rule for a group of seeds and weighs the evidence when a leaf accepts.
Verdict judge(const ReasoningState& state, const Rule& rule, const std::vector<FragmentIndex>& group);

/// The reason of a rejection that the tree would not have given.
inline constexpr const char* kAgainstEvidence = "the evidence speaks against it";
/// A candidate without rivals is rejected when the evidence leaves it a chance below one in twenty.
inline constexpr double kMinLogOdds = -3;

/// The log-odds that the fragments which `accept` would own are no object at all.
struct LogOddsOfNothing {
  double sum = 0;     ///< each by itself
  double as_one = 0;  ///< all together: their mean, weighted by points

  /// What a candidate with these log-odds gains over leaving its fragments uncovered, in units of 1e-6. It can win
  /// when this is above 0. Each fragment counts, but many of them alone make no candidate likelier.
  std::int64_t scoreOf(double log_odds) const;
};
LogOddsOfNothing logOddsOfNothing(const ReasoningState& state, const AcceptLeaf& accept, const Bindings& bindings);

}  // namespace cluxel::rules
