// SPDX-License-Identifier: Apache-2.0
// Which things a rule looks at: single pieces, slices of pieces, or pieces that were grouped.
#pragma once

#include <optional>
#include <vector>

#include "reasoning/reasoning_state.hpp"

namespace cluxel {

/// Cuts the slices that a rule's seeds ask for out of free pieces, and puts back those that no object took.
class SliceScope {
 public:
  SliceScope(ReasoningState& state, const Rule& rule);
  /// The slices, in canonical order.
  const std::vector<PieceIndex>& slices() const { return slices_; }
  /// Call once, when the rule has had all its seeds.
  void putBack();

 private:
  struct Cut {
    std::optional<PieceIndex> rest;  ///< what is not in any slice
    std::vector<PieceIndex> slices;
  };
  ReasoningState& state_;
  std::vector<Cut> cuts_;
  std::vector<PieceIndex> slices_;
};

/// The groups of seed pieces of a rule: those with most points first, then in canonical order. `slices` are used
/// instead of whole pieces when the rule asks for them.
std::vector<std::vector<PieceIndex>> seedGroups(const ReasoningState& state, const Rule& rule,
                                                const std::vector<PieceIndex>& slices);

}  // namespace cluxel
