// SPDX-License-Identifier: Apache-2.0
// Traces: for each primitive a hash of all steps of a run that it took part in.
#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "perception/segments/scene.hpp"
#include "rules/decide/step_members.hpp"

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

/// Hashes are of content: no numbers of primitives, cluxels, fragments or objects enter, and nothing that depends on
/// what happens far away. A step that is repeated without any change is noted once, because rounds that change nothing
/// here may be due to a change elsewhere.
class TraceRecorder {
 public:
  explicit TraceRecorder(std::size_t primitives) : traces_(primitives, 0) {}

  /// From now on the members of steps are kept, too.
  void keepMembers() { steps_.emplace(traces_.size()); }

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

  bool keepsMembers() const { return steps_.has_value(); }
  /// kNobody when no members are kept, as in the next two.
  MemberSet setOf(std::span<const perception::PrimitiveIndex> members) {
    return steps_ ? steps_->unionOf({members.begin(), members.end()}) : kNobody;
  }
  MemberSet unionOf(MemberSet a, MemberSet b) { return steps_ ? steps_->unionOf({a, b}) : kNobody; }
  MemberSet unionOf(std::vector<MemberSet> sets) { return steps_ ? steps_->unionOf(std::move(sets)) : kNobody; }
  /// Keeps the members of a step. Of each step, also of one that changes nothing.
  void keep(MemberSet members) {
    if (steps_) steps_->addStep(members);
  }

  /// Back to an earlier state. Members of steps stay: a seam must enclose the groups that were looked at.
  void takeBack(const TraceRecorder& earlier) {
    traces_ = earlier.traces_, known_ = earlier.known_;
    part_ = earlier.part_, round_ = earlier.round_;
  }

  std::vector<std::uint64_t> takeTraces() { return std::move(traces_); }
  /// After keepMembers().
  const StepMembers& steps() const { return *steps_; }

 private:
  std::vector<std::uint64_t> traces_;
  std::uint64_t part_ = 0, round_ = 0;
  std::unordered_map<std::uint64_t, std::uint64_t> known_;
  std::optional<StepMembers> steps_;
};

}  // namespace cluxel::rules
