// SPDX-License-Identifier: Apache-2.0
// The links of a group against all pairs of cluxels.
#include "rules/objects/seed_links.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include "rules/box_world.hpp"
#include "rules/decide/threshold_margins.hpp"
#include "rules/propose/fragment_search.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
using namespace rules;
namespace {

using Links = std::map<std::pair<std::size_t, std::size_t>, double>;

Links linksOfAllPairs(const ReasoningState& state, const GroupSpec& group, const std::vector<FragmentIndex>& members) {
  Links links;
  for (std::size_t a = 0; a < members.size(); ++a)
    for (std::size_t b = a + 1; b < members.size(); ++b)
      for (const std::uint32_t c : state.fragments[members[a]].cluxels)
        for (const std::uint32_t d : state.fragments[members[b]].cluxels) {
          const CluxelGap gap = gapBetween(state.scene.cluxels, c, d);
          const auto near = state.scene.cluxels.neighbours(c);
          const bool joined = group.adjacent && std::find(near.begin(), near.end(), d) != near.end();
          const bool is_near = group.near_m && gap.gap() <= *group.near_m;
          const bool is_stacked =
              group.horizontal_m && gap.horizontal <= *group.horizontal_m && gap.vertical <= *group.vertical_m;
          if (!joined && !is_near && !is_stacked) continue;
          double& smallest = links.try_emplace({a, b}, 1e9).first->second;
          smallest = std::min(smallest, joined ? 0 : gap.gap());
        }
  return links;
}

BoxScene scatteredBoxes(std::mt19937& random) {
  std::uniform_real_distribution<double> place(-9, 9), height(0, 5), size(0.1, 2);
  BoxScene scene;
  for (int i = 0; i < 40; ++i)
    scene.boxes.push_back(box("b" + std::to_string(i), i % 2 == 0 ? kColumn : kScatter,
                              {place(random), place(random), height(random)},
                              {size(random), size(random), size(random)}));
  return scene;
}

TEST(SeedLinks, AreThoseOfAllPairs) {
  std::mt19937 random(11);
  const RuleSet rules = outdoorRules();
  std::vector<GroupSpec> groups(4);
  groups[0].near_m = 0.7;
  groups[1].horizontal_m = 0.4, groups[1].vertical_m = 3;
  groups[2].near_m = 1.5, groups[2].adjacent = true;
  groups[3].near_m = 0.9, groups[3].horizontal_m = 0, groups[3].vertical_m = 1.2;
  std::size_t found = 0;
  for (int round = 0; round < 2; ++round) {
    const BuiltBoxScene built = sceneOfBoxes(scatteredBoxes(random));
    std::vector<Links> expected;
    for (const unsigned threads : {1U, 2U}) {
      const ReasoningContext context{.threads = threads};
      const ReasoningState state(built.scene, rules, context);
      std::vector<FragmentIndex> members;
      for (FragmentIndex fragment = 0; fragment < state.fragments.size(); ++fragment)
        if (fragment % 5 != 0) members.push_back(fragment);
      for (std::size_t g = 0; g < groups.size(); ++g) {
        if (threads == 1) expected.push_back(linksOfAllPairs(state, groups[g], members));
        Links links;
        SeedLink last{-1, 0, 0};
        for (const SeedLink& link : seedLinks(state, groups[g], members).links) {
          EXPECT_LT(link.a, link.b);
          EXPECT_LT(std::tie(last.gap, last.a, last.b), std::tie(link.gap, link.a, link.b));
          EXPECT_TRUE(links.try_emplace({link.a, link.b}, link.gap).second) << "a pair is linked once";
          last = link;
        }
        EXPECT_EQ(links, expected[g]) << "group " << g;
        found += links.size();
      }
    }
  }
  EXPECT_GT(found, 100U);
}

using Rows = std::vector<std::tuple<double, std::uint32_t, std::size_t, std::size_t>>;

constexpr double kNear_m = 1.5;

/// The links and then the notes, in their order. What lies beyond the distance that is looked at narrows no margin.
Rows rowsOf(const SeedLinks& links) {
  Rows rows;
  for (const SeedLink& link : links.links) rows.emplace_back(link.gap, 0, link.a, link.b);
  for (const LinkNote& note : links.notes)
    if (note.distance_m <= searchedAround(kNear_m)) rows.emplace_back(note.distance_m, note.threshold, note.a, note.b);
  return rows;
}

TEST(SeedLinks, OfFewerMembersAreTheSameWhenThoseOfMoreAreKnown) {
  std::mt19937 random(12);
  const RuleSet rules = outdoorRules();
  std::vector<GroupSpec> groups(2);
  groups[0].near_m = kNear_m, groups[0].near_threshold = 1, groups[0].adjacent = true;
  groups[1].horizontal_m = 0.8, groups[1].vertical_m = 2;
  groups[1].horizontal_threshold = 2, groups[1].vertical_threshold = 3;
  const BuiltBoxScene built = sceneOfBoxes(scatteredBoxes(random));
  ThresholdMargins margins(built.scene, rules);
  const ReasoningContext context{.margins = &margins};
  const ReasoningState state(built.scene, rules, context);
  std::size_t reused = 0;
  for (const GroupSpec& group : groups) {
    std::vector<FragmentIndex> all, members;
    for (FragmentIndex fragment = 0; fragment < state.fragments.size(); ++fragment) all.push_back(fragment);
    KnownLinks known;
    EXPECT_EQ(rowsOf(seedLinks(state, group, all, &known)), rowsOf(seedLinks(state, group, all)));
    for (int round = 0; round < 10; ++round) {
      members = all;
      std::erase_if(members, [&](FragmentIndex) { return random() % 3 == 0; });
      const TileMargins before = margins.found();
      const Rows links = rowsOf(seedLinks(state, group, members, &known));
      EXPECT_EQ(known.members, all);
      EXPECT_EQ(links, rowsOf(seedLinks(state, group, members)));
      EXPECT_EQ(margins.found(), before) << "what matters was noted before";
      reused += links.size();
    }
    KnownLinks others{members, seedLinks(state, group, members)};
    EXPECT_EQ(rowsOf(seedLinks(state, group, all, &others)), rowsOf(known.links)) << "some are not known";
    EXPECT_EQ(others.members, all);
  }
  EXPECT_GT(reused, 100U);
}

}  // namespace
}  // namespace cluxel::testing
