// SPDX-License-Identifier: Apache-2.0
// The reasoning stage around a change, with the outcome of the run over the whole scene. Decision 0092 has the proof.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
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

/// Layers up to this one are decided anew; those from the next on to kLastLayer are known to be as before.
inline constexpr std::uint32_t kLastDecidedLayer = 1;

/// What holds in the run over the whole new scene:
/// - of primitives in layers up to kLastDecidedLayer the traces, the decisions that have one of them as a seed, and the
///   objects that have one of them as a member are those of `result`;
/// - of all other primitives, and of objects without a member in these layers, they are those of the run before.
/// A class-wide object (`merge_into: class`) consists of the members that both runs gave it.
struct LocalOutcome {
  ReasoningResult result;
  std::vector<std::uint32_t> layer;  ///< by primitive; all kNoLayer when nothing changed
};

class SeamSearch;

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

  /// By primitive: the layers around what is dirty, and after decide() around all that came out otherwise than before.
  /// A window in which some of them are open is too small.
  const std::vector<std::uint32_t>& layers() const;

  /// Runs the rules, and compares traces in the layers around the change with those stored. What has another trace
  /// counts as changed, and so do the members of a step that reaches across these layers. False when a layer is not
  /// within the window: then try again in a window that holds the layers that layers() gives now. Several changes may
  /// be decided in windows of their own; each window marks all that is dirty in it. To be called once.
  bool decide();
  /// After decide(): looks again, with these primitives counted as changed. False, too, when they all are already.
  bool decideWith(std::span<const perception::PrimitiveIndex> changed);
  /// After decide(); empty without any change.
  const ReasoningResult& result() const { return result_; }
  ReasoningResult takeResult() { return std::move(result_); }

 private:
  bool findSeam();

  const RuleSet& rules_;
  std::unique_ptr<ReasoningState> state_;
  std::vector<char> is_fixed_;
  std::unique_ptr<SeamSearch> seam_;
  bool has_run_ = false;
  ReasoningResult result_;
};

/// Both steps at once. Absent when the window is too small.
std::optional<LocalOutcome> decideLocally(const LocalInput& input, const RuleSet& rules,
                                          const ReasoningContext& context, double reach_m);

}  // namespace cluxel::rules
