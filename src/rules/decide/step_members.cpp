// SPDX-License-Identifier: Apache-2.0
// Parts of a union always have smaller numbers: one pass upwards finds the layers of all sets, one pass down their
// members.
#include "rules/decide/step_members.hpp"

#include <algorithm>

namespace cluxel::rules {

namespace {

/// The smallest and the largest layer of some primitives.
struct LayerSpan {
  std::uint32_t low = std::numeric_limits<std::uint32_t>::max(), high = 0;
};

}  // namespace

MemberSet StepMembers::unionOf(std::vector<MemberSet> sets) {
  std::erase(sets, kNobody);
  std::sort(sets.begin(), sets.end());
  sets.erase(std::unique(sets.begin(), sets.end()), sets.end());
  if (sets.empty()) return kNobody;
  if (sets.size() == 1) return sets.front();
  const auto number = static_cast<MemberSet>(primitives_ + begin_.size() - 1);
  parts_.insert(parts_.end(), sets.begin(), sets.end());
  begin_.push_back(parts_.size());
  return number;
}

void StepMembers::addStep(MemberSet members) {
  const bool is_union = members != kNobody && members >= primitives_;  // of one member nothing is far apart
  if (is_union && (steps_.empty() || steps_.back() != members)) steps_.push_back(members);
}

std::vector<std::uint32_t> StepMembers::ofStepsAcross(const std::vector<std::uint32_t>& layers, std::uint32_t near,
                                                      std::uint32_t far) const {
  const std::size_t unions = begin_.size() - 1;
  std::vector<LayerSpan> spans(unions);
  for (std::size_t i = 0; i < unions; ++i)
    for (std::size_t part = begin_[i]; part < begin_[i + 1]; ++part) {
      const MemberSet set = parts_[part];
      const LayerSpan of_part = set < primitives_ ? LayerSpan{layers[set], layers[set]} : spans[set - primitives_];
      spans[i] = {std::min(spans[i].low, of_part.low), std::max(spans[i].high, of_part.high)};
    }
  std::vector<char> is_in(primitives_ + unions, 0);
  for (const MemberSet step : steps_)
    if (const LayerSpan& span = spans[step - primitives_]; span.low <= near && span.high >= far) is_in[step] = 1;
  for (std::size_t i = unions; i-- > 0;)
    if (is_in[primitives_ + i] != 0)
      for (std::size_t part = begin_[i]; part < begin_[i + 1]; ++part) is_in[parts_[part]] = 1;
  std::vector<std::uint32_t> members;
  for (std::uint32_t primitive = 0; primitive < primitives_; ++primitive)
    if (is_in[primitive] != 0) members.push_back(primitive);
  return members;
}

}  // namespace cluxel::rules
