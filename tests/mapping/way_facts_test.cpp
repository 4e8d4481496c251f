// SPDX-License-Identifier: Apache-2.0
// Facts about ways are exchanged where ways change, and are then those of the whole graph.
#include "mapping/facts/way_facts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

namespace cluxel::mapping {
namespace {

using Quads = std::set<rdf::QuadIds>;

/// Few places, so that some resources lie at the same one.
class ChangingGraph {
 public:
  explicit ChangingGraph(unsigned seed) : random_(seed) {
    for (int i = 0; i < 4; ++i) graph.regions.push_back(region());
    for (int i = 0; i < 6; ++i) graph.junctions.push_back({place(), 3});
    for (int i = 0; i < 8; ++i) graph.ways.push_back(way());
    for (int i = 0; i < 5; ++i) graph.kerbs.push_back({line(), number(), number()});
  }

  void change() {
    switch (random_() % 8) {
      case 0:
        graph.regions[random_() % graph.regions.size()] = region();
        break;
      case 1:
        graph.regions[random_() % graph.regions.size()].area_m2 += 1;
        break;
      case 2:
        graph.junctions[random_() % graph.junctions.size()].place = place();
        break;
      case 3:
        graph.ways[random_() % graph.ways.size()] = way();
        break;
      case 4:
        graph.ways[random_() % graph.ways.size()].region = random_() % graph.regions.size();
        break;
      case 5:
        graph.ways.push_back(graph.ways.front());
        break;
      case 6:
        if (graph.ways.size() > 1) graph.ways.erase(graph.ways.begin());
        break;
      default:
        graph.kerbs.push_back({graph.kerbs.front().line, number(), number()});
        graph.kerbs.erase(graph.kerbs.begin());
    }
  }

  WayGraph graph;

 private:
  double number() { return 1 + random_() % 3; }
  Eigen::Vector3d place() { return {number(), number(), 0}; }
  std::vector<Eigen::Vector3d> line() { return {place(), place()}; }
  Region region() { return {{0, 0}, {number(), number()}, {number(), number()}, number()}; }
  Way way() {
    Way way{line(), number(), number(), number(), 0, 0, 0, random_() % graph.regions.size(), {}};
    if (random_() % 2 == 0) way.junctions = {random_() % graph.junctions.size()};
    return way;
  }

  std::mt19937 random_;
};

class WayFacts : public testing::TestWithParam<unsigned> {
 protected:
  WayFacts() : environment_(rdf::Environment::temporary()), transaction_(environment_->write()) {}

  Quads told(const WayGraph& graph, const std::vector<ToldWay>& before, ToldWays& ways) {
    FactSink facts(transaction_, "g", FactsOf::Collected);
    ways = addWayFacts(graph, before, facts);
    const std::vector<rdf::QuadIds> quads = facts.take();
    facts.writer().flush();
    return {quads.begin(), quads.end()};
  }

  rdf::TermId idOf(const std::string& iri) const {
    return rdf::QuadReader(static_cast<const rdf::ReadTransaction&>(transaction_)).idOf(Term::iri(iri)).value_or(0);
  }

  std::shared_ptr<rdf::Environment> environment_;
  rdf::WriteTransaction transaction_;
};

TEST_P(WayFacts, OfAChangeAreThoseOfTheWhole) {
  ChangingGraph changing(GetParam());
  ToldWays before;
  Quads stored = told(changing.graph, {}, before);
  std::size_t kept = 0;
  for (int step = 0; step < 60; ++step) {
    changing.change();
    ToldWays whole, change;
    const Quads all = told(changing.graph, {}, whole);
    const Quads added = told(changing.graph, before.now, change);
    for (const auto& [kind, name] : change.exchanged) {
      const std::string iri = iriOfWay(kind, name);
      const rdf::TermId self = idOf(iri), shape = idOf(iri + "/shape");
      std::erase_if(stored, [&](const rdf::QuadIds& quad) { return quad.s == self || quad.s == shape; });
    }
    kept += stored.size();
    stored.insert(added.begin(), added.end());
    ASSERT_EQ(stored, all) << "step " << step;
    ASSERT_EQ(change.now, whole.now) << "step " << step;
    storeToldWays(transaction_, change.now);
    ASSERT_EQ(storedToldWays(transaction_), change.now) << "step " << step;
    before = std::move(change);
  }
  EXPECT_GT(kept, 60U * 100) << "most facts stay";
}

INSTANTIATE_TEST_SUITE_P(Seeds, WayFacts, testing::Range(1U, 6U));

TEST_P(WayFacts, AreNoneWithoutAChange) {
  const ChangingGraph changing(GetParam());
  ToldWays before, again;
  told(changing.graph, {}, before);
  EXPECT_TRUE(told(changing.graph, before.now, again).empty());
  EXPECT_TRUE(again.exchanged.empty());
}

}  // namespace
}  // namespace cluxel::mapping
