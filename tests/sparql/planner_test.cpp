// SPDX-License-Identifier: Apache-2.0
// Tests of the planner: equal answers for every written order, chosen join orders, fast paths, prepared queries.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "cluxel/error.hpp"
#include "sparql/support/store_fixture.hpp"

namespace cluxel::test {

using namespace rdf;
using namespace sparql;
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

/// Many objects of class Common and few of class Rare, with numbers and neighbours.
SmallStore& wideStore() {
  static SmallStore* const made = [] {
    auto* store = new SmallStore;
    std::vector<Quad> quads;
    const auto iri = [](const std::string& name) { return Term::iri("http://example.org/" + name); };
    const auto type = Term::iri("http://www.w3.org/1999/02/22-rdf-syntax-ns#type");
    std::mt19937 random(3);
    for (int i = 0; i < 4000; ++i) {
      const Term self = iri("o" + std::to_string(i));
      quads.push_back({self, type, iri(i % 400 == 0 ? "Rare" : "Common"), Term::iri("")});
      quads.push_back({self, iri("height"), Term::integer(static_cast<std::int64_t>(random() % 100)), Term::iri("")});
      quads.push_back({self, iri("near"), iri("o" + std::to_string(random() % 4000)), Term::iri("")});
      if (i % 3 != 0) quads.push_back({self, iri("label"), Term::literal("thing " + std::to_string(i)), Term::iri("")});
    }
    store->load(quads);
    return store;
  }();
  return *made;
}

TEST(Planner, AnswersTheSameInEveryOrderOfPatterns) {
  std::vector<std::string> patterns = {"?a a :Rare .", "?a :near ?b .", "?b :height ?h .", "?b :label ?l .",
                                       "?a :height ?g ."};
  std::sort(patterns.begin(), patterns.end());
  std::optional<std::vector<std::string>> first;
  do {
    std::string where;
    for (const std::string& pattern : patterns) where += pattern;
    const auto rows = wideStore().rows("SELECT ?a ?b ?h ?l ?g { " + where + " FILTER(?h != ?g) }");
    if (!first) first = rows;
    ASSERT_EQ(rows, *first) << where;
  } while (std::next_permutation(patterns.begin(), patterns.end()));
  EXPECT_FALSE(first->empty());
}

TEST(Planner, BeginsWithTheRarePatternWhereverItStands) {
  const QuadReader reader = wideStore().reader();
  for (const char* where : {"?a a :Rare . ?a :height ?h . ?a :near ?b", "?a :near ?b . ?a :height ?h . ?a a :Rare"}) {
    const std::string plan = explainQuery(reader, kPrefixes + "SELECT * { " + where + " }");
    EXPECT_THAT(plan, HasSubstr("lookup"));
    const std::size_t scan = plan.find("scan");
    ASSERT_NE(scan, std::string::npos) << plan;
    EXPECT_THAT(plan.substr(scan, 120), HasSubstr("Rare")) << plan;
  }
}

TEST(Planner, HashesWhereBothSidesAreLargeOrMakesAColumn) {
  const QuadReader reader = wideStore().reader();
  const std::string query = "SELECT * { ?a a :Common . ?b :near ?a . ?b :height ?h }";
  const std::string column = "lookup by column  ?b <http://example.org/height> ?h";
  QueryOptions strict;  // one graph by itself has no columns
  strict.default_graph = DefaultGraph::Unnamed;
  EXPECT_THAT(explainQuery(reader, kPrefixes + query, strict), AllOf(HasSubstr("hash join"), Not(HasSubstr(column))));
  EXPECT_THAT(explainQuery(reader, kPrefixes + query), HasSubstr(column));
  EXPECT_EQ(wideStore().rows(query), wideStore().rows(query, strict));
}

TEST(Planner, BeginsWithRowsInAnOrderThatOthersCanUse) {
  // There is one height fewer than objects. By row counts alone the plan would begin with the heights, sorted by value.
  SmallStore store;
  std::vector<Quad> quads;
  const auto iri = [](const std::string& name) { return Term::iri("http://example.org/" + name); };
  for (int i = 0; i < 2000; ++i) {
    const Term self = iri("o" + std::to_string(i));
    quads.push_back({self, iri("is"), iri("thing"), Term::iri("")});
    if (i > 0) quads.push_back({self, iri("height"), Term::integer(i * 7919 % 2003), Term::iri("")});
  }
  store.load(quads);
  const std::string plan = explainQuery(store.reader(), kPrefixes + "SELECT * { ?o :height ?h . ?o :is :thing }");
  EXPECT_THAT(plan, HasSubstr("scan posg  ?o <http://example.org/is> <http://example.org/thing>"));
}

TEST(Planner, MergesWhereBothSidesComeSorted) {
  SmallStore store;
  std::vector<Quad> quads;
  const auto type = Term::iri("http://www.w3.org/1999/02/22-rdf-syntax-ns#type");
  const auto iri = [](const std::string& name) { return Term::iri("http://example.org/" + name); };
  for (int i = 0; i < 3000; ++i) {
    const Term self = iri("o" + std::to_string(i * 2654435761u % 3001));
    if (i % 2 == 0) quads.push_back({self, type, iri("A"), Term::iri("")});
    if (i % 3 == 0) quads.push_back({self, type, iri("B"), Term::iri("http://example.org/g")});
    quads.push_back({self, iri("near"), iri("o" + std::to_string((i * 7) % 3001)), Term::iri("")});
  }
  store.load(quads);
  const std::string both = "SELECT ?x { ?x a :A . ?x a :B }", joined = "SELECT ?x ?y { ?y a :A . ?x :near ?y }";
  EXPECT_THAT(explainQuery(store.reader(), kPrefixes + both), HasSubstr("merge join on ?x"));
  EXPECT_THAT(explainQuery(store.reader(), kPrefixes + joined), HasSubstr("merge join on ?y"));
  // Written so that no merge join is possible; the rows are the same.
  EXPECT_EQ(
      store.rows(both),
      store.rows("SELECT ?x { { SELECT ?x { ?x a :A } ORDER BY DESC(?x) LIMIT 100000 } FILTER EXISTS { ?x a :B } }"));
  EXPECT_EQ(store.rows(joined), store.rows("SELECT ?x ?y { ?x :near ?y FILTER EXISTS { ?y a :A } }"));
}

TEST(Planner, FiltersAsSoonAsTheirVariablesAreBound) {
  const QuadReader reader = wideStore().reader();
  const std::string plan = explainQuery(
      reader, kPrefixes + "SELECT * { ?a :near ?b . ?b :label ?l . ?a a :Rare . ?a :height ?h FILTER(?h > 200) }");
  EXPECT_THAT(plan, HasSubstr("actual 0"));
  EXPECT_LT(plan.rfind("filter"), plan.size());
}

TEST(Planner, EstimatesAreWithinReasonForJoins) {
  const QuadReader reader = wideStore().reader();
  const std::string plan = explainQuery(reader, kPrefixes + "SELECT * { ?a a :Rare . ?a :height ?h }");
  EXPECT_THAT(plan, HasSubstr("estimated 10, actual 10"));
}

TEST(PreparedQueries, PlanOnceAndRunWithValues) {
  const QuadReader reader = wideStore().reader();
  PreparedQuery query(reader, kPrefixes + "SELECT ?h { ?x :height ?h FILTER NOT EXISTS { ?x :none ?n } }", {}, {"x"});
  for (int i = 0; i < 20; ++i) {
    const QueryResult result = query.evaluate({{"x", Term::iri("http://example.org/o" + std::to_string(i))}});
    ASSERT_EQ(result.table.row_count, 1u);
  }
  EXPECT_EQ(query.evaluate({{"x", Term::iri("http://example.org/nobody")}}).table.row_count, 0u);
  EXPECT_THROW(query.evaluate({}), Error);
}

TEST(PreparedQueries, SeeTheirParametersEverywhere) {
  const QuadReader reader = wideStore().reader();
  const auto count = [&](const std::string& text) {
    PreparedQuery query(reader, kPrefixes + text, {}, {"limit"});
    const QueryResult result = query.evaluate({{"limit", Term::integer(50)}});
    return result.table.row_count == 1 ? result.table.at(0, 0)->text : "?";
  };
  const std::string expected = wideStore().rows("SELECT (STR(COUNT(*)) AS ?n) { ?x :height ?h FILTER(?h < 50) }").at(0);
  EXPECT_EQ("\"" + count("SELECT (COUNT(*) AS ?n) { ?x :height ?h FILTER(?h < ?limit) }") + "\"", expected);
  EXPECT_EQ(
      "\"" + count("SELECT (COUNT(*) AS ?n) { { ?x :height ?h FILTER(?h < ?limit) } UNION { ?x :none ?h } }") + "\"",
      expected);
  EXPECT_EQ("\"" + count("SELECT ?n { { SELECT (COUNT(*) AS ?n) { ?x :height ?h FILTER(?h < ?limit) } } }") + "\"",
            expected);
  EXPECT_EQ("\"" + count("SELECT (COUNT(*) AS ?n) { ?x :height ?h BIND(?h < ?limit AS ?b) FILTER(?b) }") + "\"",
            expected);
}

TEST(PreparedQueries, AskStopsAtTheFirstSolution) {
  const QuadReader reader = wideStore().reader();
  PreparedQuery query(reader, kPrefixes + "ASK { ?x :near ?y . ?y :near ?z }", {}, {"x"});
  EXPECT_TRUE(query.ask({{"x", Term::iri("http://example.org/o5")}}));
  EXPECT_FALSE(query.ask({{"x", Term::literal("o5")}}));
}

}  // namespace
}  // namespace cluxel::test
