// SPDX-License-Identifier: Apache-2.0
// The reasoning stage around a change, with the outcome of the run over the whole scene. Decision 0092 has the proof.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "perception/segments/scene.hpp"
#include "rules/decide/local_layers.hpp"
#include "rules/decide/local_reach.hpp"
#include "rules/decide/reason.hpp"

namespace cluxel::rules {

struct ReasoningState;

/// The layers that hold when the strata of lone seeds take just these primitives of those that are not dirty; see
/// layersAround(). By primitive.
struct LikelyLayers {
  std::vector<char> is_fixed;
  std::vector<std::uint32_t> layers;
};

/// A part of a scene around a change. Vectors are by primitive of the window.
struct LocalInput {
  /// The primitives near the change, with the edges and relations among them; see perception::partOf().
  const perception::Scene& window;
  /// New, or anything that it consists of or is related to is not as in the run before.
  std::vector<char> is_dirty;
  /// Something within reach of it, or an edge or a relation of it, is not in the window: its outcome means nothing.
  std::vector<char> is_open;
  /// Where primitives were that are gone, or that were larger before. What is within reach of them counts as dirty.
  std::vector<Eigen::AlignedBox2d> gone;
  /// Of the run before (ReasoningResult::traces); absent for what is new.
  std::vector<std::optional<std::uint64_t>> stored_trace;
  /// Spares the run the search for layers, if these are the right ones.
  LikelyLayers likely{};
};

/// Layers that the run over the window and the run before decided alike, and that no step spans.
struct Seam {
  std::uint32_t first = 0, last = 0;
};

/// What holds in the run over the whole new scene, for the nearest seam and each other one that begins at `j`:
/// - of primitives in layers up to `j` the traces, the decisions that have one of them as a seed, and the objects that
///   have one of them as a member are those of `result`;
/// - of all other primitives, and of objects without a member in these layers, they are those of the run before.
/// An object of a whole class (`merge_into: class`) consists of the members that both runs gave it.
struct LocalOutcome {
  ReasoningResult result;
  std::vector<std::uint32_t> layer;  ///< by primitive; see layersAround()
  std::vector<Seam> seams;           ///< the nearest first; none when nothing changed
};

/// A run of the rules over a window, in two steps: the layers alone tell whether the window is large enough to try. The
/// rules must not ask the map.
class LocalRun {
 public:
  /// `input`, `rules` and the context must outlive the run. `reach_m` is that of localReach(). Cost: some microseconds
  /// a cluxel.
  LocalRun(const LocalInput& input, const RuleSet& rules, const ReasoningContext& context, double reach_m);
  ~LocalRun();
  LocalRun(const LocalRun&) = delete;
  LocalRun& operator=(const LocalRun&) = delete;

  /// By primitive; see layersAround(). A window in which some of the first layers are open is too small.
  const std::vector<std::uint32_t>& layers() const { return layers_; }

  /// Runs the rules, and compares traces in some layers around the change with those stored. Absent when these layers
  /// are not within the window, when no layers agree, or when a step reaches across them: then a larger window may do.
  /// Several changes may be decided in windows of their own; each window marks all that is dirty in it. Without any
  /// change the outcome is empty. To be called once.
  std::optional<LocalOutcome> decide();

 private:
  const LocalInput& input_;
  const RuleSet& rules_;
  std::unique_ptr<ReasoningState> state_;
  std::vector<std::uint32_t> layers_;
};

/// Both steps at once.
std::optional<LocalOutcome> decideLocally(const LocalInput& input, const RuleSet& rules,
                                          const ReasoningContext& context, double reach_m);

}  // namespace cluxel::rules
