// SPDX-License-Identifier: Apache-2.0
// Looks for layers of a window in which a run over it and the run before agree. Decision 0092 has the proof.
#pragma once

#include <cstdint>
#include <set>
#include <vector>

#include "rules/decide/local_run.hpp"
#include "rules/decide/reasoning_state.hpp"

namespace cluxel::rules {

/// The layers of a window in which both runs agree, and those that are not all in the window.
class SeamSearch {
 public:
  /// `layers`: layersAround(). Both must outlive the search.
  SeamSearch(const LocalInput& input, const std::vector<std::uint32_t>& layers);

  /// Whether the narrowest seam next to the change is in the window.
  bool mayFind() const;
  /// All seams, the nearest first. `wide_steps`: TraceRecorder::spans() of the run.
  std::vector<Seam> find(const ReasoningResult& result, const std::set<LayerSpan>& wide_steps) const;

 private:
  std::vector<char> agreeingLayers(const std::vector<std::uint64_t>& traces) const;

  const LocalInput& input_;
  const std::vector<std::uint32_t>& layer_;
  std::uint32_t last_ = 0, first_open_ = kNoLayer;
};

/// What the first strata took, each primitive by itself, takes part in no later step: its trace is that of the run
/// before, and a change does not go on through it. By primitive; after these strata.
std::vector<char> fixedPrimitives(const ReasoningState& state);

}  // namespace cluxel::rules
