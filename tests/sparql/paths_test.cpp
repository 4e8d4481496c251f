// SPDX-License-Identifier: Apache-2.0
// Compares property paths with a brute-force implementation of the specification on random graphs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "sparql/support/store_fixture.hpp"

namespace cluxel::test {

using namespace rdf;
using namespace sparql;
namespace {

using testing::ElementsAre;
using Pairs = std::set<std::pair<int, int>>;

/// A random graph of some nodes with two properties.
struct RandomGraph {
  int nodes = 9;
  Pairs p, q;

  explicit RandomGraph(unsigned seed) {
    std::mt19937 random(seed);
    for (int i = 0; i < 11; ++i) p.emplace(random() % nodes, random() % nodes);
    for (int i = 0; i < 6; ++i) q.emplace(random() % nodes, random() % nodes);
  }
  std::vector<Quad> quads() const {
    std::vector<Quad> result;
    const auto add = [&](const Pairs& pairs, const char* name) {
      for (const auto& [a, b] : pairs)
        result.push_back({node(a), Term::iri(std::string("http://example.org/") + name), node(b), Term::iri("")});
    };
    add(p, "p");
    add(q, "q");
    return result;
  }
  static Term node(int i) { return Term::iri("http://example.org/n" + std::to_string(i)); }
  std::set<int> used() const {
    std::set<int> result;
    for (const Pairs* pairs : {&p, &q}) {
      for (const auto& [a, b] : *pairs) result.insert({a, b});
    }
    return result;
  }
};

Pairs inverse(const Pairs& pairs) {
  Pairs result;
  for (const auto& [a, b] : pairs) result.emplace(b, a);
  return result;
}

Pairs composed(const Pairs& x, const Pairs& y) {
  Pairs result;
  for (const auto& [a, b] : x) {
    for (const auto& [c, d] : y) {
      if (b == c) result.emplace(a, d);
    }
  }
  return result;
}

Pairs both(Pairs x, const Pairs& y) {
  x.insert(y.begin(), y.end());
  return x;
}

Pairs plus(const Pairs& pairs) {
  Pairs result = pairs;
  while (true) {
    const Pairs more = both(result, composed(result, pairs));
    if (more == result) return result;
    result = more;
  }
}

Pairs identity(const RandomGraph& graph) {
  Pairs result;
  for (const int node : graph.used()) result.emplace(node, node);
  return result;
}

class Paths : public testing::TestWithParam<unsigned> {};

TEST_P(Paths, GiveThePairsThatBruteForceGives) {
  const RandomGraph graph(GetParam());
  SmallStore store;
  store.load(graph.quads());
  const Pairs &p = graph.p, &q = graph.q, same = identity(graph);
  const std::vector<std::pair<std::string, Pairs>> cases = {
      {":p+", plus(p)},
      {":p*", both(plus(p), same)},
      {":p?", both(p, same)},
      {"(:p/:q)+", plus(composed(p, q))},
      {"(:p|^:q)*", both(plus(both(p, inverse(q))), same)},
      {"(^:p)+", inverse(plus(p))},
      {"(:p+/:q*)?", both(both(composed(plus(p), both(plus(q), same)), same), {})},
      {"(!:p)+", plus(q)},
      {"(!(:p|^:q))*", both(plus(both(q, inverse(p))), same)}};
  for (const auto& [path, expected] : cases) {
    std::vector<std::string> lines;
    for (const auto& [a, b] : expected) lines.push_back(":n" + std::to_string(a) + " :n" + std::to_string(b));
    std::sort(lines.begin(), lines.end());
    EXPECT_EQ(store.rows("SELECT ?a ?b { ?a " + path + " ?b }"), lines) << path;
    for (int node = 0; node < graph.nodes; ++node) {
      const std::string name = ":n" + std::to_string(node);
      std::vector<std::string> from, to;
      for (const auto& [a, b] : expected) {
        if (a == node) from.push_back(":n" + std::to_string(b));
        if (b == node) to.push_back(":n" + std::to_string(a));
      }
      // A path of length zero reaches a constant end even when the graph does not contain it.
      const bool zero = path.ends_with("*") || path.ends_with("?");
      if (zero && !graph.used().contains(node)) from.push_back(name), to.push_back(name);
      std::sort(from.begin(), from.end());
      std::sort(to.begin(), to.end());
      EXPECT_EQ(store.rows("SELECT ?b { " + name + " " + path + " ?b }"), from) << name << " " << path;
      EXPECT_EQ(store.rows("SELECT ?a { ?a " + path + " " + name + " }"), to) << path << " " << name;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(RandomGraphs, Paths, testing::Range(1u, 9u));

TEST(PathCounts, SequencesAndAlternativesKeepDuplicatesAndClosuresDoNot) {
  const SmallStore store(":a :p :b , :c . :b :q :d . :c :q :d . :a :q :b .");
  EXPECT_THAT(store.rows("SELECT ?x { :a :p/:q ?x }"), ElementsAre(":d", ":d"));
  EXPECT_THAT(store.rows("SELECT ?x { :a (:p|:q) ?x }"), ElementsAre(":b", ":b", ":c"));
  EXPECT_THAT(store.rows("SELECT ?x { :a (:p/:q)+ ?x }"), ElementsAre(":d"));
  EXPECT_THAT(store.rows("SELECT ?x { :a (:p|:q)? ?x }"), ElementsAre(":a", ":b", ":c"));
}

TEST(PathCounts, OfAllPairsEndAndJoinWithPatterns) {
  // Regression test: with two variable ends, the last batch was repeated for ever.
  const SmallStore store(":a a :T ; :n :b . :b a :T ; :n :c . :c a :T .");
  EXPECT_THAT(store.rows("SELECT (COUNT(*) AS ?n) { ?x a :T ; :n+ ?y }"), ElementsAre("\"3\"^^integer"));
  EXPECT_THAT(store.rows("SELECT ?x (COUNT(?y) AS ?n) { ?x a :T . ?x :n+ ?y } GROUP BY ?x HAVING(COUNT(?y) > 1)"),
              ElementsAre(":a \"2\"^^integer"));
  EXPECT_THAT(store.rows("SELECT ?x { ?x :n* ?x }"), ElementsAre(":T", ":a", ":b", ":c"));
}

}  // namespace
}  // namespace cluxel::test
