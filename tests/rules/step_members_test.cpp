// SPDX-License-Identifier: Apache-2.0
// Sets of members against sets that are written out.
#include "rules/decide/step_members.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "rules/decide/local_layers.hpp"

namespace cluxel::rules {
namespace {

using Members = std::set<std::uint32_t>;

TEST(StepMembers, AreThoseOfTheStepsAcrossTheLayers) {
  std::mt19937 random(7);
  for (int round = 0; round < 300; ++round) {
    const std::uint32_t count = 2 + random() % 20;
    StepMembers steps(count);
    std::vector<Members> sets;  // by number
    for (std::uint32_t primitive = 0; primitive < count; ++primitive) sets.push_back({primitive});
    std::vector<Members> kept;
    for (int i = 0; i < 25; ++i) {
      std::vector<MemberSet> parts;
      Members all;
      for (std::uint32_t part = random() % 4; part > 0; --part) {
        parts.push_back(random() % 8 == 0 ? kNobody : static_cast<MemberSet>(random() % sets.size()));
        if (parts.back() != kNobody) all.insert(sets[parts.back()].begin(), sets[parts.back()].end());
      }
      const MemberSet made = steps.unionOf(parts);
      ASSERT_EQ(made == kNobody, all.empty());
      if (made == sets.size()) sets.push_back(all);
      if (made != kNobody) {
        ASSERT_EQ(sets.at(made), all);
      }
      if (random() % 2 == 0) {
        steps.addStep(made);
        kept.push_back(all);
      }
    }
    std::vector<std::uint32_t> layers;
    for (std::uint32_t primitive = 0; primitive < count; ++primitive)
      layers.push_back(random() % 6 == 0 ? kNoLayer : random() % 5);
    const std::uint32_t near = random() % 3, far = near + 1 + random() % 2;
    Members expected;
    for (const Members& members : kept) {
      const auto has = [&](const auto& test) {
        return std::any_of(members.begin(), members.end(), [&](std::uint32_t member) { return test(layers[member]); });
      };
      if (has([&](std::uint32_t layer) { return layer <= near; }) &&
          has([&](std::uint32_t layer) { return layer >= far; }))
        expected.insert(members.begin(), members.end());
    }
    const std::vector<std::uint32_t> found = steps.ofStepsAcross(layers, near, far);
    EXPECT_EQ(Members(found.begin(), found.end()), expected);
    EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
  }
}

}  // namespace
}  // namespace cluxel::rules
