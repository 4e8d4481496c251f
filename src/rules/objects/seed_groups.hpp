// SPDX-License-Identifier: Apache-2.0
// Selects the seeds of a rule: single fragments, height slices of fragments, or groups of fragments.
#pragma once

#include <optional>
#include <vector>

#include "rules/decide/reasoning_state.hpp"
#include "rules/objects/seed_links.hpp"

namespace cluxel::rules {

/// Cuts the height slices that a rule uses as seeds out of free fragments, and joins those that no object took back to
/// the rest.
class SliceScope {
 public:
  SliceScope(ReasoningState& state, const Rule& rule);
  /// The slices, in canonical order.
  const std::vector<FragmentIndex>& slices() const { return slices_; }
  /// Joins unused slices again. Call it once, after the rule has processed all its seeds.
  void putBack();

 private:
  struct Cut {
    std::optional<FragmentIndex> rest;  ///< the cluxels outside the slices
    std::vector<FragmentIndex> slices;
  };
  ReasoningState& state_;
  std::vector<Cut> cuts_;
  std::vector<FragmentIndex> slices_;
};

/// The seed groups of a rule, by decreasing number of points, then in canonical order. For a rule with sliced seeds the
/// members are `slices`. Of the state only the traces change. `known`: see seedLinks().
std::vector<std::vector<FragmentIndex>> seedGroups(ReasoningState& state, const Rule& rule,
                                                   const std::vector<FragmentIndex>& slices,
                                                   KnownLinks* known = nullptr);

}  // namespace cluxel::rules
