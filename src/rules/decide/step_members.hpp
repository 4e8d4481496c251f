// SPDX-License-Identifier: Apache-2.0
// Who took part in the steps of a run of the rules.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace cluxel::rules {

/// A set of primitives, by its number in a StepMembers. A single primitive is the set of its own number.
using MemberSet = std::uint32_t;
inline constexpr MemberSet kNobody = std::numeric_limits<MemberSet>::max();

/// Sets are made of earlier sets: an object that grows by a primitive costs one entry, however large it is.
class StepMembers {
 public:
  explicit StepMembers(std::size_t primitives) : primitives_(primitives), begin_{0} {}

  /// kNobody in `sets` adds nothing. Cost: sorts `sets`.
  MemberSet unionOf(std::vector<MemberSet> sets);
  /// Notes that these were the members of one step.
  void addStep(MemberSet members);

  /// The members of all steps that have a member in a layer up to `near` and one in a layer from `far` on, or in none
  /// (kNoLayer). `layers` by primitive. Ascending. Cost: linear in all entries.
  std::vector<std::uint32_t> ofStepsAcross(const std::vector<std::uint32_t>& layers, std::uint32_t near,
                                           std::uint32_t far) const;

 private:
  std::size_t primitives_;
  std::vector<MemberSet> parts_;    ///< of the unions, one after the other
  std::vector<std::size_t> begin_;  ///< where the parts of each union begin; one more for the end
  std::vector<MemberSet> steps_;
};

}  // namespace cluxel::rules
