// SPDX-License-Identifier: Apache-2.0
// Looks for layers around a change in which a run over a window and the run before agree. Decision 0092 has the proof.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "rules/decide/local_run.hpp"
#include "rules/decide/reasoning_state.hpp"

namespace cluxel::rules {

/// The seam are layers 1 to 3. Where the runs differ there, the change reaches farther: what differs counts as changed,
/// too, and the layers are those around all of it.
class SeamSearch {
 public:
  /// `layers`: layersAround() what is dirty. All arguments but `layers` must outlive the search.
  SeamSearch(const LocalInput& input, const std::vector<char>& is_fixed, double reach_m,
             std::vector<std::uint32_t> layers);

  /// By primitive: around all that counts as changed by now.
  const std::vector<std::uint32_t>& layers() const { return layers_; }
  /// Whether all layers are in the window as a whole: nothing of them is open.
  bool isInWindow() const;
  /// True when the seam lies in the window. `steps`: those of the run.
  bool find(std::span<const std::uint64_t> traces, const StepMembers& steps);
  /// These primitives count as changed from now on. False when all of them do already.
  bool addChanged(std::span<const perception::PrimitiveIndex> primitives);

 private:
  std::vector<perception::PrimitiveIndex> differing(std::span<const std::uint64_t> traces) const;

  const LocalInput& input_;
  const std::vector<char>& is_fixed_;
  double reach_m_;
  std::vector<char> is_changed_;  ///< by primitive
  std::vector<std::uint32_t> layers_;
  std::optional<LayerSearch> search_;
};

/// What the first strata took, each primitive by itself, takes part in no later step: its trace is that of the run
/// before, and a change does not go on through it. By primitive; after these strata.
std::vector<char> fixedPrimitives(const ReasoningState& state);

}  // namespace cluxel::rules
