// SPDX-License-Identifier: Apache-2.0
// Random spatial queries have the answers of brute force and of plans without spatial steps.
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>

#include "sparql/support/spatial_query_fixture.hpp"
#include "sparql/support/store_fixture.hpp"

namespace cluxel::test {

using namespace sparql;
namespace {

constexpr int kThings = 60, kSeeds = 5;

QueryOptions withoutSpatialPlans() {
  QueryOptions options;
  options.spatial_plans = false;
  return options;
}

int queriesOfOneSeed() {
  const char* told = std::getenv("CLUXEL_DIFFERENTIAL");
  return (told ? std::atoi(told) : 600) / kSeeds;
}

/// True when the plan has a step that the planner without spatial plans does not know.
bool isSpatial(const SmallStore& store, const std::string& text) {
  const QuadReader reader = store.reader();
  const std::string plan = PreparedQuery(reader, kPrefixes + text).explain();
  for (const char* step : {"R-tree", "range join", "nearest"})
    if (plan.find(step) != std::string::npos) return true;
  return false;
}

class SpatialQueries : public testing::TestWithParam<std::uint32_t> {};

TEST_P(SpatialQueries, HaveTheAnswersOfBruteForce) {
  const Town town = madeTown(GetParam(), kThings, false);
  SmallStore store;
  store.load(town.quads);
  SpatialQueryMaker maker(town, GetParam() + 100);
  std::map<std::string, int> found;
  int by_brute_force = 0;
  for (int i = 0; i < queriesOfOneSeed(); ++i) {
    const SpatialQuery query = maker.next();
    if (query.is_ordered) {
      EXPECT_EQ(store.ordered(query.text), store.ordered(query.text, withoutSpatialPlans())) << query.text;
      found[query.family] += 1;
    } else {
      ++by_brute_force;
      EXPECT_EQ(store.rows(query.text), query.rows) << query.family << "\n" << query.text;
      found[query.family] += query.rows.empty() ? 0 : 1;
    }
  }
  for (const auto& [family, count] : found) EXPECT_GT(count, 0) << "no answer has rows: " << family;
  EXPECT_EQ(found.size(), 13U);
  EXPECT_GE(by_brute_force, queriesOfOneSeed() * 5 / 6) << "500 of all 600";
}

TEST_P(SpatialQueries, HaveTheAnswersOfOtherPlansOnStrangeGeometries) {
  const Town town = madeTown(GetParam(), kThings, true);
  SmallStore store;
  store.load(town.quads);
  SpatialQueryMaker maker(town, GetParam() + 200);
  std::map<std::string, int> spatial;
  for (int i = 0; i < queriesOfOneSeed(); ++i) {
    const SpatialQuery query = maker.next();
    // Without DISTINCT, duplicates count too.
    std::string text = query.text;
    if (const std::size_t at = text.find("DISTINCT "); at != std::string::npos) text.erase(at, 9);
    EXPECT_EQ(store.ordered(query.text).size(), store.ordered(query.text, withoutSpatialPlans()).size());
    if (query.is_ordered) {
      EXPECT_EQ(store.ordered(text), store.ordered(text, withoutSpatialPlans())) << text;
    } else {
      EXPECT_EQ(store.rows(text), store.rows(text, withoutSpatialPlans())) << query.family << "\n" << text;
    }
    spatial[query.family] += isSpatial(store, text) ? 1 : 0;
  }
  spatial.erase("nearest first");  // sorting is cheaper in a small town
  for (const auto& [family, count] : spatial) EXPECT_GT(count, 0) << "no spatial plan for " << family;
}

TEST_P(SpatialQueries, GiveTheNearestOfManyStrangeGeometries) {
  const Town town = madeTown(GetParam(), 3000, true);
  SmallStore store;
  store.load(town.quads);
  SpatialQueryMaker maker(town, GetParam() + 300);
  int by_index = 0;
  for (int i = 0; i < 20; ++i) {
    const SpatialQuery query = maker.nearestFirst();
    EXPECT_EQ(store.ordered(query.text), store.ordered(query.text, withoutSpatialPlans())) << query.text;
    by_index += isSpatial(store, query.text) ? 1 : 0;
  }
  EXPECT_GT(by_index, 5);
}

INSTANTIATE_TEST_SUITE_P(Seeds, SpatialQueries, testing::Range(1U, 1U + kSeeds));

}  // namespace
}  // namespace cluxel::test
