// SPDX-License-Identifier: Apache-2.0
// Traces: for each primitive a hash of all steps of a run that it took part in.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>
#include <set>
#include <span>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "perception/segments/scene.hpp"

namespace cluxel::rules {

/// A hash of two values; their order matters.
constexpr std::uint64_t mixed(std::uint64_t a, std::uint64_t b) {
  std::uint64_t x = a * 0x9E3779B97F4A7C15U + b;
  x = (x ^ (x >> 32U)) * 0xD6E8FEB86659FD93U;
  x = (x ^ (x >> 32U)) * 0xD6E8FEB86659FD93U;
  return x ^ (x >> 32U);
}
inline std::uint64_t mixed(std::uint64_t a, double b) {
  return mixed(a, std::bit_cast<std::uint64_t>(b));
}
std::uint64_t hashOf(std::string_view text);

/// What a step does, so that steps of different kinds never have the same hash.
enum class StepKind : std::uint8_t {
  Owned,
  Cut,
  Joined,
  Grouped,
  Refused,
  Judged,
  Rivals,
  Merged,
  Split,
  Gathered,
  Absorbed,
  Finished,
};
constexpr std::uint64_t mixed(StepKind kind, std::uint64_t what) {
  return mixed(static_cast<std::uint64_t>(kind) + 1, what);
}

/// The smallest and the largest layer of some primitives; see layersAround().
struct LayerSpan {
  std::uint32_t low = std::numeric_limits<std::uint32_t>::max(), high = 0;

  void add(std::uint32_t layer) { add(LayerSpan{layer, layer}); }
  void add(const LayerSpan& other) { low = std::min(low, other.low), high = std::max(high, other.high); }
  auto operator<=>(const LayerSpan&) const = default;
};

/// Steps with members fewer layers apart than this are not kept.
inline constexpr std::uint32_t kFewestLayers = 2;

/// Hashes are of content: no numbers of primitives, cluxels, fragments or objects enter, and nothing that depends on
/// what happens far away. A step that is repeated without any change is noted once, because rounds that change nothing
/// here may be due to a change elsewhere.
class TraceRecorder {
 public:
  explicit TraceRecorder(std::size_t primitives) : traces_(primitives, 0) {}

  /// From now on the spans of steps are kept. `layers` by primitive, valid as long as the recorder.
  void useLayers(const std::vector<std::uint32_t>& layers) { layers_ = &layers; }

  /// Begins a part of the run. What was noted in earlier parts may be noted again.
  void enter(std::uint64_t part);
  void enterRound(std::uint64_t round) { round_ = mixed(part_, round); }

  void note(perception::PrimitiveIndex primitive, std::uint64_t what) {
    traces_[primitive] = mixed(mixed(traces_[primitive], round_), what);
  }
  /// Notes a step of several primitives.
  void noteStep(std::span<const perception::PrimitiveIndex> members, std::uint64_t what) {
    for (const perception::PrimitiveIndex member : members) note(member, what);
  }
  /// Whether `what` is not what was last known about `thing` in this part of the run; it is known from now on.
  bool isNews(std::uint64_t thing, std::uint64_t what);

  bool hasLayers() const { return layers_ != nullptr; }
  LayerSpan spanOf(perception::PrimitiveIndex primitive) const {
    return layers_ == nullptr ? LayerSpan{} : LayerSpan{(*layers_)[primitive], (*layers_)[primitive]};
  }
  LayerSpan spanOf(std::span<const perception::PrimitiveIndex> members) const;
  /// Keeps the span of a step's members when it is wide.
  void keep(const LayerSpan& span) {
    if (layers_ != nullptr && span.low <= span.high && span.high - span.low >= kFewestLayers) spans_.insert(span);
  }

  /// Back to an earlier state. Spans of steps stay: a seam must enclose the groups that were looked at.
  void takeBack(const TraceRecorder& earlier) {
    traces_ = earlier.traces_, known_ = earlier.known_;
    part_ = earlier.part_, round_ = earlier.round_;
  }

  std::vector<std::uint64_t> takeTraces() { return std::move(traces_); }
  const std::set<LayerSpan>& spans() const { return spans_; }

 private:
  std::vector<std::uint64_t> traces_;
  const std::vector<std::uint32_t>* layers_ = nullptr;
  std::uint64_t part_ = 0, round_ = 0;
  std::unordered_map<std::uint64_t, std::uint64_t> known_;
  std::set<LayerSpan> spans_;
};

}  // namespace cluxel::rules
