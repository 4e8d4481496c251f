// SPDX-License-Identifier: Apache-2.0
// Known splits of crowns: taken where nothing has changed, and nowhere else.
#include "rules/objects/known_splits.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>
#include <string>
#include <utility>

#include "rules/cluxel_cloud.hpp"

namespace cluxel::testing {

using namespace perception;
using namespace rules;
namespace {

/// A crown to split, as a value that tests change.
struct SplitCase {
  SceneCluxels all;
  std::vector<std::uint32_t> crown;
  std::vector<CrownSource> sources;

  std::vector<std::uint32_t> split(KnownSplits* known = nullptr) const {
    return splitCrown(all, crown, sources, 1, known);
  }
  void addToTrunk(std::uint32_t source, std::uint32_t cluxel) {
    std::erase(crown, cluxel);
    sources[source].trunk.push_back(cluxel);
  }
};

/// Two trunks (cluxels 0 and 1) in a common crown, and a third one (cluxel 2) far away with a crown of its own.
SplitCase twoCrowns() {
  std::vector<Eigen::Vector3d> points{{0, 0, 2}, {2, 0, 2}, {40, 0, 2}};
  for (int i = 0; i < 12; ++i) points.emplace_back(0.25 * i - 0.3, 0.1 * (i % 3), 2.3 + 0.02 * i);
  for (int i = 0; i < 5; ++i) points.emplace_back(40, 0.3 * i, 2.4);
  SplitCase made{cloudOf(points, 0.45), {}, std::vector<CrownSource>(3)};
  for (std::uint32_t i = 3; i < points.size(); ++i) made.crown.push_back(i);
  for (std::uint32_t s = 0; s < 3; ++s) {
    made.sources[s] = {{s}, 8, 0.5, 0.6, 1.5, {}};
    made.sources[s].may_take = [](std::uint32_t) { return true; };
  }
  return made;
}

KnownSplits knownAfter(const SplitCase& earlier) {
  KnownSplits known;
  earlier.split(&known);
  return KnownSplits(known.stored());
}

TEST(KnownSplits, AreTakenInsteadOfASearch) {
  const SplitCase both = twoCrowns();
  CrownParts parts{both.all, both.sources, {}};
  for (const CrownSource& source : both.sources) parts.tops.push_back(topOf(both.all, source.trunk));
  const std::vector<SourceGroup> groups = groupsOf(parts, both.crown);
  ASSERT_EQ(groups.size(), 2U);
  std::vector<SearchPlace> places(both.all.size());
  for (std::uint32_t g = 0; g < 2; ++g)
    for (std::uint32_t i = 0; i < groups[g].cluxels.size(); ++i) places[groups[g].cluxels[i]] = {g, i};
  // An outcome that no search comes to: nothing of the crown far away is taken.
  KnownSplits false_outcome;
  false_outcome.note(causeOf(parts, groups[1], 1, places), SplitOutcome(groups[1].cluxels.size(), kNoSource), false);
  KnownSplits known(false_outcome.stored());
  const auto taken = both.split(&known);
  auto expected = both.split();
  EXPECT_EQ(std::count(expected.begin(), expected.end(), 2U), 5);
  std::replace(expected.begin(), expected.end(), 2U, kNoSource);
  EXPECT_EQ(taken, expected);
  EXPECT_EQ(known.count(), 2U);
  EXPECT_EQ(known.reused(), 1U);
  EXPECT_EQ(both.split(&false_outcome), expected) << "what this run has noted is taken, too";
}

TEST(KnownSplits, AreNotTakenWhenAnythingThatTheyFollowFromHasChanged) {
  using Change = std::function<void(SplitCase&)>;
  const std::vector<std::pair<std::string, Change>> changes{
      {"a cluxel moved", [](SplitCase& c) { c.all.center[7].z() += 1e-9; }},
      {"a cluxel grew", [](SplitCase& c) { c.all.extent[7].x() += 1e-6F; }},
      {"an edge is another", [](SplitCase& c) { c.all.edge_target[c.all.edge_offset[7]] = 14; }},
      {"a cluxel is too low", [](SplitCase& c) { c.all.height_above_ground[7] = 1.0F; }},
      {"a cluxel is not claimed",
       [](SplitCase& c) { c.sources[1].may_take = [](std::uint32_t cluxel) { return cluxel != 7; }; }},
      {"a cluxel came", [](SplitCase& c) { c.crown.erase(c.crown.begin() + 4); }},
      {"a trunk's cluxel moved", [](SplitCase& c) { c.all.center[1].x() += 1e-9; }},
      {"a trunk's cluxel grew", [](SplitCase& c) { c.all.extent[1].x() += 1e-6F; }},
      {"a trunk is higher", [](SplitCase& c) { c.all.height_above_ground[1] += 1e-6F; }},
      {"a trunk has another edge", [](SplitCase& c) { c.all.edge_target[c.all.edge_offset[1]] = 3; }},
      {"a trunk has another cluxel", [](SplitCase& c) { c.addToTrunk(1, 14); }},
      {"another reach", [](SplitCase& c) { c.sources[0].reach_m += 1e-9; }},
      {"another jump", [](SplitCase& c) { c.sources[0].jump_m += 1e-9; }},
      {"another start", [](SplitCase& c) { c.sources[0].start_m += 1e-9; }},
      {"another clearance", [](SplitCase& c) { c.sources[0].clearance_m += 1e-9; }},
      {"a trunk less", [](SplitCase& c) { c.sources.erase(c.sources.begin()); }},
      {"trunks in another order", [](SplitCase& c) { std::swap(c.sources[0], c.sources[1]); }},
  };
  const SplitCase earlier = twoCrowns();
  KnownSplits same = knownAfter(earlier);
  EXPECT_EQ(earlier.split(&same), earlier.split());
  EXPECT_EQ(same.reused(), 2U);
  for (const auto& [what, change] : changes) {
    SplitCase now = earlier;
    change(now);
    KnownSplits known = knownAfter(earlier);
    EXPECT_EQ(now.split(&known), now.split()) << what;
    EXPECT_EQ(known.count(), 2U) << what;
    EXPECT_EQ(known.reused(), 1U) << what << ": the crown far away, and only that, has not changed";
  }
}

TEST(KnownSplits, AreFoundWhenCluxelsHaveOtherNumbers) {
  const SplitCase earlier = twoCrowns();
  SplitCase now = earlier;
  now.all.center.insert(now.all.center.begin(), {-30, 0, 2});
  now.all.name.emplace_back();
  now.all.extent.insert(now.all.extent.begin(), Eigen::Vector3f::Constant(0.1F));
  now.all.height_above_ground.insert(now.all.height_above_ground.begin(), 2.0F);
  now.all.edge_offset.insert(now.all.edge_offset.begin(), 0);
  for (std::uint32_t& target : now.all.edge_target) ++target;
  for (std::uint32_t& cluxel : now.crown) ++cluxel;
  for (CrownSource& source : now.sources) ++source.trunk.front();
  KnownSplits known = knownAfter(earlier);
  EXPECT_EQ(now.split(&known), earlier.split());
  EXPECT_EQ(known.reused(), 2U);
}

TEST(KnownSplits, OfRandomChangesGiveTheSameSplits) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(0, 60), beside(-2.5, 2.5), height(1.7, 4);
  SplitCase now;
  std::vector<Eigen::Vector3d> points;
  const std::uint32_t trunks = 16;
  for (std::uint32_t s = 0; s < trunks; ++s) points.emplace_back(place(random), place(random), 2);
  for (std::uint32_t i = 0; i < 800; ++i) {
    const Eigen::Vector3d& trunk = points[i % trunks];
    points.emplace_back(trunk.x() + beside(random), trunk.y() + beside(random), height(random));
  }
  now.sources.resize(trunks);
  for (std::uint32_t s = 0; s < trunks; ++s) now.sources[s] = {{s}, 4, 0.5, 1, 1.8, {}};
  for (std::uint32_t i = trunks; i < points.size(); ++i) now.crown.push_back(i);
  std::string stored;
  std::size_t reused = 0, searched = 0;
  for (int round = 0; round < 25; ++round) {
    now.all = cloudOf(points, 0.6);
    KnownSplits known(stored);
    EXPECT_EQ(now.split(&known), now.split()) << "round " << round;
    stored = known.stored();
    reused += known.reused();
    searched += known.count() - known.reused();
    points[random() % points.size()].x() += beside(random);
  }
  EXPECT_GT(reused, 50U);
  EXPECT_GT(searched, 25U);
}

TEST(KnownSplits, OfDamagedBytesKnowNothing) {
  const SplitCase earlier = twoCrowns();
  KnownSplits known;
  earlier.split(&known);
  const std::string whole = known.stored();
  for (const std::string& damaged : {std::string(), std::string("splits"), whole.substr(0, whole.size() / 2)}) {
    KnownSplits nothing(damaged);
    EXPECT_EQ(earlier.split(&nothing), earlier.split());
    EXPECT_EQ(nothing.reused(), 0U);
  }
}

}  // namespace
}  // namespace cluxel::testing
