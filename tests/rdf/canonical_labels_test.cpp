// SPDX-License-Identifier: Apache-2.0
// Canonical labels of random graphs, against a comparison that tries all ways to match blank nodes.
#include "rdf/io/canonical_labels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <set>

namespace cluxel::rdf {
namespace {

using Graph = std::set<std::array<int, 4>>;  ///< subject, predicate, object, graph; negative: a named node

constexpr int kNodes = 5;

Graph randomGraph(std::mt19937& random) {
  Graph graph;
  const auto node = [&] { return static_cast<int>(random() % (kNodes + 1)) - (random() % 6 == 0 ? kNodes + 1 : 0); };
  for (std::size_t count = 1 + random() % 8; count > 0; --count)
    graph.insert({node(), static_cast<int>(random() % 2), node(), random() % 4 == 0 ? node() : -1});
  return graph;
}

Term termOf(int node, const std::vector<int>& labels) {
  if (node < 0) return Term::iri("http://x/n" + std::to_string(-node));
  return Term::blank("l" + std::to_string(labels.at(static_cast<std::size_t>(node))));
}

bool namesBlank(const Quad& quad) {
  return quad.subject.kind == TermKind::BlankNode || quad.object.kind == TermKind::BlankNode ||
         quad.graph.kind == TermKind::BlankNode;
}

/// The lines with canonical labels, of a store that numbers its blank nodes otherwise.
std::set<std::string> canonical(const Graph& graph, std::mt19937& random) {
  std::vector<int> labels(kNodes + 1);
  std::iota(labels.begin(), labels.end(), static_cast<int>(random() % 100));
  std::shuffle(labels.begin(), labels.end(), random);
  std::vector<Quad> quads, with_blanks;
  for (const auto& [s, p, o, g] : graph)
    quads.push_back(
        {termOf(s, labels), Term::iri("http://x/p" + std::to_string(p)), termOf(o, labels), termOf(g, labels)});
  std::shuffle(quads.begin(), quads.end(), random);
  std::copy_if(quads.begin(), quads.end(), std::back_inserter(with_blanks), namesBlank);
  const auto found = canonicalLabels(with_blanks);
  std::set<std::string> lines;
  for (Quad& quad : quads) {
    for (Term* term : {&quad.subject, &quad.object, &quad.graph})
      if (term->kind == TermKind::BlankNode) term->text = found.at(term->text);
    lines.insert(toNQuads(quad));
  }
  EXPECT_EQ(lines.size(), graph.size());
  return lines;
}

bool areIsomorphic(const Graph& a, const Graph& b) {
  std::vector<int> match(kNodes + 1);
  std::iota(match.begin(), match.end(), 0);
  const auto matched = [&](int node) { return node < 0 ? node : match[static_cast<std::size_t>(node)]; };
  do {
    Graph renamed;
    for (const auto& [s, p, o, g] : a) renamed.insert({matched(s), p, matched(o), matched(g)});
    if (renamed == b) return true;
  } while (std::next_permutation(match.begin(), match.end()));
  return false;
}

TEST(CanonicalLabels, FollowFromTheGraphAlone) {
  std::mt19937 random(9);
  for (int round = 0; round < 1500; ++round) {
    const Graph graph = randomGraph(random);
    ASSERT_EQ(canonical(graph, random), canonical(graph, random)) << round;
  }
}

TEST(CanonicalLabels, TellGraphsApartThatAreNotTheSame) {
  std::mt19937 random(10);
  std::size_t same = 0;
  for (int round = 0; round < 400; ++round) {
    const Graph a = randomGraph(random);
    Graph b;
    std::vector<int> other(kNodes + 1);
    std::iota(other.begin(), other.end(), 0);
    std::shuffle(other.begin(), other.end(), random);
    const auto renamed = [&](int node) { return node < 0 ? node : other[static_cast<std::size_t>(node)]; };
    for (const auto& [s, p, o, g] : a) b.insert({renamed(s), p, renamed(o), renamed(g)});
    if (round % 2 == 0) {  // one end of one quad moves
      std::array<int, 4> moved = *b.begin();
      b.erase(b.begin());
      moved[2] = static_cast<int>(random() % (kNodes + 1));
      b.insert(moved);
    }
    const bool expected = a.size() == b.size() && areIsomorphic(a, b);
    ASSERT_EQ(canonical(a, random) == canonical(b, random), expected) << round;
    same += expected ? 1 : 0;
  }
  EXPECT_GT(same, 200U);
  EXPECT_LT(same, 350U);
}

/// The first example of the recommendation: two nodes of which what is said differs.
TEST(CanonicalLabels, AreThoseOfTheRecommendation) {
  const auto iri = [](const std::string& name) { return Term::iri("http://example.com/#" + name); };
  const std::vector<Quad> quads{{iri("p"), iri("q"), Term::blank("e0"), Term::iri("")},
                                {iri("p"), iri("r"), Term::blank("e1"), Term::iri("")},
                                {Term::blank("e0"), iri("s"), iri("u"), Term::iri("")},
                                {Term::blank("e1"), iri("t"), iri("u"), Term::iri("")}};
  EXPECT_EQ(canonicalLabels(quads), (std::map<std::string, std::string>{{"e0", "c14n0"}, {"e1", "c14n1"}}));
}

TEST(CanonicalLabels, AreNotFoundWhenTooManyOrdersWouldHaveToBeTried) {
  std::vector<Quad> quads;
  for (int a = 0; a < 12; ++a)
    for (int b = 0; b < 12; ++b)
      if (a != b)
        quads.push_back({Term::blank("n" + std::to_string(a)), Term::iri("http://x/p"),
                         Term::blank("n" + std::to_string(b)), Term::iri("")});
  EXPECT_TRUE(canonicalLabels(quads, 1000).empty());
  std::vector<Quad> chain;
  for (int i = 0; i < 5000; ++i)
    chain.push_back({Term::blank("n" + std::to_string(i)), Term::iri("http://x/p"),
                     Term::blank("n" + std::to_string(i + 1)), Term::iri("")});
  EXPECT_TRUE(canonicalLabels(chain).empty());
}

}  // namespace
}  // namespace cluxel::rdf
