// SPDX-License-Identifier: Apache-2.0
// Rows processed in batches give the same results as single rows, also at the borders of batches.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <optional>
#include <random>

#include "rdf/vocabulary.hpp"
#include "sparql/support/store_fixture.hpp"

namespace cluxel::test {

using namespace rdf;
using namespace sparql;
namespace {

using testing::ElementsAre;
using testing::ElementsAreArray;

constexpr std::array<std::size_t, 12> kCounts = {0, 1, 2, 3, 4, 5, 63, 64, 65, 127, 129, 300};

Term iri(const std::string& local) {
  return Term::iri("http://example.org/" + local);
}
Term decimal(unsigned hundredths) {
  const std::string rest = std::to_string(hundredths % 100);
  return Term::literal(std::to_string(hundredths / 100) + "." + (rest.size() < 2 ? "0" : "") + rest,
                       vocabulary::xsd("decimal"));
}

/// A random value of a random kind, or no value. Later texts share shorter prefixes.
std::optional<Term> mixed(std::size_t kind, std::size_t number, std::size_t of, std::mt19937& random) {
  const std::string text =
      std::string(40 - number * 40 / of, 'm') + static_cast<char>('a' + random() % 26) + std::to_string(random() % 50);
  const std::string day = std::to_string(10 + random() % 19);
  switch (kind % 8) {
    case 0:
      return Term::literal(text);
    case 1:
      return iri(text);
    case 2:
      return Term::langLiteral(text, random() % 2 == 0 ? "de" : "en");
    case 3:
      return Term::literal(random() % 2 == 0 ? "true" : "false", vocabulary::xsd("boolean"));
    case 4:
      return Term::literal("2026-11-" + day, vocabulary::xsd("date"));
    case 5:
      return decimal(random() % 300);
    case 6:
      return Term::literal(std::to_string(random() % 20), vocabulary::xsd("integer"));
    default:
      return std::nullopt;
  }
}

/// Objects in two graphs with heights (many of them equal), a few names and neighbours.
class Batching : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    store = new SmallStore();
    std::mt19937 random(4);
    std::vector<Quad> quads;
    // Term ids are assigned in insertion order, so later objects have higher ids.
    for (std::size_t i = 0; i < kThings; ++i) {
      quads.push_back({iri("thing" + std::to_string(i)), iri("is"), iri("thing"), Term::iri("")});
    }
    for (std::size_t i = 0; i < kThings; ++i) {
      const Term self = iri("thing" + std::to_string(i));
      quads.push_back({self, iri("height"), decimal(random() % 300), Term::iri("")});
      const std::size_t kind = i < 4 ? 0 : random();  // the first texts are strings here, and IRIs there
      if (const auto value = mixed(kind, i, kThings, random))
        quads.push_back({self, iri("mixed"), *value, Term::iri("")});
      if (const auto value = mixed(kind + 1, i, kThings, random))
        quads.push_back({self, iri("other"), *value, Term::iri("")});
      if (i % 3 != 0)
        quads.push_back({self, iri("name"), Term::literal("name " + std::to_string(random() % 2000)), Term::iri("")});
      for (unsigned k = 0; k < random() % 4; ++k) {
        quads.push_back({self, iri("near"), iri("thing" + std::to_string(random() % kThings)),
                         k % 2 == 0 ? Term::iri("") : iri("graph")});
      }
    }
    store->load(quads);
  }
  static void TearDownTestSuite() { delete store; }

  /// VALUES of ?o with the first `count` objects in shuffled order; some are not in the store.
  static std::vector<std::string> things(std::size_t count) {
    std::mt19937 random(static_cast<unsigned>(count) + 9);
    std::vector<std::string> names;
    for (std::size_t i = 0; i < count; ++i) names.push_back(":thing" + std::to_string(random() % (kThings + 40)));
    return names;
  }
  static std::string valuesOf(const std::vector<std::string>& names) {
    std::string text = "VALUES ?o {";
    for (const std::string& name : names) text += " " + name;
    return text + " }";
  }

  static constexpr std::size_t kThings = 6000;
  static SmallStore* store;
};
SmallStore* Batching::store = nullptr;

TEST_F(Batching, GivesWhatEachRowGivesAlone) {
  const std::vector<std::string> patterns = {
      "?o :height ?h",
      "?o :near ?n . ?n :height ?h",
      "?n :near ?o",
      "?o ?p ?v",
      "OPTIONAL { ?o :name ?t }",
      "OPTIONAL { ?o :near ?n OPTIONAL { ?n :name ?t } }",
      "?o :height ?h FILTER(?h > 1.5)",
      "?o :name ?t FILTER(CONTAINS(?t, \"7\"))",
      "?o :height ?h BIND(?h * 2 AS ?twice) FILTER(?twice < 3.0)",
      "?o :height ?h BIND(STR(?h) AS ?text) FILTER(?text < \"1\" || BOUND(?text))",
      "?o :near ?n BIND(IRI(CONCAT(STR(?n), \"0\")) AS ?other) OPTIONAL { ?other :height ?h }",
      "FILTER NOT EXISTS { ?o :near ?n . ?n :name ?t }",
      "?o :near ?n MINUS { ?n :height ?h FILTER(?h > 1) }",
      "GRAPH ?g { ?o :near ?n } OPTIONAL { ?n :near ?o }",
      "{ ?o :name ?v } UNION { ?o :height ?v }",
  };
  for (const std::string& pattern : patterns) {
    for (const std::size_t count : kCounts) {
      const std::vector<std::string> names = things(count);
      std::vector<std::string> alone;
      for (const std::string& name : names) {
        const auto rows = store->rows("SELECT * { " + valuesOf({name}) + " " + pattern + " }");
        alone.insert(alone.end(), rows.begin(), rows.end());
      }
      std::sort(alone.begin(), alone.end());
      EXPECT_THAT(store->rows("SELECT * { " + valuesOf(names) + " " + pattern + " }"), ElementsAreArray(alone))
          << pattern << count;
    }
  }
}

void expectFirstRows(const SmallStore& store, const std::string& unordered, const std::vector<std::string>& orders) {
  for (const std::string& order : orders) {
    const std::string query = unordered + " ORDER BY " + order;
    const auto whole = store.ordered(query);
    ASSERT_EQ(whole.size(), 6000U);
    for (const std::size_t limit : {0U, 1U, 10U, 63U, 64U, 65U, 1000U, 2900U, 5999U, 6000U, 7000U}) {
      const std::size_t count = std::min(limit, whole.size());
      EXPECT_THAT(store.ordered(query + " LIMIT " + std::to_string(limit)),
                  ElementsAreArray(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(count)))
          << order << limit;
    }
    const std::vector<std::string> later(whole.begin() + 20, whole.begin() + 27);
    EXPECT_THAT(store.ordered(query + " LIMIT 7 OFFSET 20"), ElementsAreArray(later)) << order;
  }
}

TEST_F(Batching, FirstRowsAreThoseOfTheWholeOrder) {
  expectFirstRows(
      *store, "SELECT ?o ?h ?t { ?o :height ?h OPTIONAL { ?o :name ?t } }",
      {"?h ?o", "DESC(?h) ?o", "?h", "DESC(?h)", "?t DESC(?h)", "?o", "DESC(?o)", "DESC(?t)", "(?h + 1) STR(?o)"});
}

TEST_F(Batching, FirstRowsAreThoseOfTheWholeOrderOfMixedKinds) {
  for (const char* property : {"mixed", "other"}) {
    expectFirstRows(*store, std::string("SELECT ?o ?m { ?o :is :thing OPTIONAL { ?o :") + property + " ?m } }",
                    {"?m", "DESC(?m)", "?m ?o", "DESC(?m) DESC(?o)", "DATATYPE(?m) ?m", "STR(?m)", "DESC(STR(?m)) ?m"});
    std::vector<std::string> iris, strings;
    for (const std::string& row : store->ordered(std::string("SELECT ?m { ?o :") + property + " ?m } ORDER BY ?m")) {
      if (row.front() == ':') iris.push_back(row);
      if (row.front() == '"' && row.back() == '"') strings.push_back(row);
    }
    EXPECT_TRUE(std::is_sorted(iris.begin(), iris.end())) << property;
    EXPECT_TRUE(std::is_sorted(strings.begin(), strings.end())) << property;
    EXPECT_GT(std::min(iris.size(), strings.size()), kThings / 10);
  }
}

TEST_F(Batching, LimitsMayBeLargerThanWhatCanBeCounted) {
  const std::string query = "SELECT ?o ?h { ?o :height ?h } ORDER BY ?h ?o";
  const auto whole = store->ordered(query);
  ASSERT_EQ(whole.size(), kThings);
  const auto expectFrom = [&](const std::string& cut, std::ptrdiff_t first) {
    EXPECT_THAT(store->ordered(query + cut), ElementsAreArray(whole.begin() + first, whole.end())) << cut;
  };
  for (const char* limit : {"9223372036854775679", "9223372036854775680", "9223372036854775807", "9223372036854775808",
                            "18446744073709551615"}) {
    expectFrom(std::string(" LIMIT ") + limit, 0);
    expectFrom(std::string(" LIMIT ") + limit + " OFFSET 2", 2);
    expectFrom(std::string(" LIMIT ") + limit + " OFFSET 10", 10);
  }
  EXPECT_TRUE(store->ordered(query + " LIMIT 18446744073709551615 OFFSET 18446744073709551615").empty());
}

TEST_F(Batching, TextsAreOrderedByTheirBytes) {
  for (const char* column : {"?o", "?t"}) {
    auto rows = store->ordered(std::string("SELECT ") + column + " { ?o :name ?t } ORDER BY " + column);
    EXPECT_TRUE(std::is_sorted(rows.begin(), rows.end())) << column;
    EXPECT_EQ(rows.size(), kThings / 3 * 2);
  }
  const SmallStore texts(
      ":a :p \"\", \"x\", \"x\\u0001\", \"xy\", \"xyzzyxyz\", \"xyzzyxyzA\", \"xyzzyxyz\\u00e4\", \"xyzzyxyB\" .");
  EXPECT_THAT(texts.ordered("SELECT ?t { :a :p ?t } ORDER BY ?t"),
              ElementsAreArray({"\"\"", "\"x\"", "\"x\x01\"", "\"xy\"", "\"xyzzyxyB\"", "\"xyzzyxyz\"", "\"xyzzyxyzA\"",
                                "\"xyzzyxyz\u00e4\""}));
}

TEST_F(Batching, FiltersOnBindsAreDecidedBeforeThemOnlyWhereNothingChanges) {
  const SmallStore small(":a :p 1 . :b :p \"no number\" . :c :p 7 .");
  EXPECT_THAT(small.rows("SELECT ?s ?d { ?s :p ?v BIND(?v + 1 AS ?d) FILTER(?d > 2) }"),
              ElementsAreArray({":c \"8\"^^integer"}));
  EXPECT_THAT(small.rows("SELECT ?s { ?s :p ?v BIND(?v + 1 AS ?d) FILTER(!BOUND(?d)) }"), ElementsAreArray({":b"}));
  EXPECT_THAT(small.rows("SELECT ?s { ?s :p ?v BIND(?v + 1 AS ?d) FILTER(COALESCE(?d, 99) > 8) }"),
              ElementsAreArray({":b"}));
  EXPECT_THAT(small.rows("SELECT ?s { ?s :p ?v BIND(?v + 1 AS ?d) BIND(?d * 2 AS ?e) FILTER(?e = 4) }"),
              ElementsAreArray({":a"}));
  EXPECT_THAT(small.rows("SELECT ?s { ?s :p ?v BIND(?v AS ?d) FILTER EXISTS { ?x :p ?d FILTER(?d = 7) } }"),
              ElementsAreArray({":c"}));
  EXPECT_THAT(small.rows("SELECT ?s { ?s :p ?v BIND(RAND() AS ?d) FILTER(?d = ?d && ISNUMERIC(?v)) }"),
              ElementsAreArray({":a", ":c"}));
  const QuadReader reader = small.reader();
  const auto filters_first = [&](const std::string& rest) {
    const std::string plan = explainQuery(reader, kPrefixes + "SELECT ?s { ?s :p ?v BIND(?v + 1 AS ?d) " + rest + " }");
    return plan.find("filter") > plan.find("bind");  // a plan is told from its top
  };
  EXPECT_TRUE(filters_first("FILTER(?d > 2)"));
  EXPECT_FALSE(filters_first("FILTER(BOUND(?d))"));
  EXPECT_FALSE(filters_first("FILTER(?d * ?d * ?d > 2)"));
  EXPECT_TRUE(filters_first("OPTIONAL { ?s :p ?w } FILTER(?d > 2)"));
  EXPECT_FALSE(filters_first("OPTIONAL { ?s :p ?d } FILTER(?d > 2)"));
  EXPECT_THAT(small.rows("SELECT ?s { ?s :p ?v BIND(?v + 1 AS ?d) OPTIONAL { ?s :p ?w } FILTER(?d = ?w + 1) }"),
              ElementsAreArray({":a", ":c"}));
}

TEST_F(Batching, WhatABindLeavesUnboundMayBeBoundAfterIt) {
  const SmallStore small(":a :p \"no number\" ; :q 7 . :c :p 5 .");
  const std::string start = "SELECT ?s ?d { ?s :p ?v BIND(?v + 1 AS ?d) ";
  const std::string a = ":a \"7\"^^integer", c = ":c \"6\"^^integer";
  EXPECT_THAT(small.rows(start + "OPTIONAL { ?s :q ?d } FILTER(?d > 3) }"), ElementsAre(a, c));
  EXPECT_THAT(small.rows(start + "OPTIONAL { ?s :q ?d } FILTER(?d > 3 && ?d < 7) }"), ElementsAre(c));
  EXPECT_THAT(small.rows(start + "BIND(?d * 2 AS ?e) OPTIONAL { ?s :q ?d } FILTER(?d > 3) }"), ElementsAre(a, c));
  EXPECT_THAT(small.rows(start + "OPTIONAL { ?s :r ?e } OPTIONAL { ?s :q ?d } FILTER(?d > 3) }"), ElementsAre(a, c));
  EXPECT_THAT(small.rows(start + "OPTIONAL { { ?s :q ?d } UNION { ?s :r ?d } } FILTER(?d > 3) }"), ElementsAre(a, c));
  EXPECT_THAT(small.rows(start + "{ ?s :q ?d } FILTER(?d > 3) }"), ElementsAre(a));
  EXPECT_THAT(small.rows(start + "VALUES ?d { 6 7 } FILTER(?d > 3) }"), ElementsAre(":a \"6\"^^integer", a, c));
  EXPECT_THAT(small.rows(start + "{ ?s :q ?d } UNION { ?s :p 5 } FILTER(?d > 3) }"), ElementsAre(a, c));
  EXPECT_TRUE(small.ask("ASK { ?s :p ?v BIND(?v + 1 AS ?d) OPTIONAL { ?s :q ?d } FILTER(?d = 7) }").boolean);
  EXPECT_THAT(
      small.rows("SELECT ?s ?d { ?s :p|:q ?v BIND(IF(?v > 6, ?v, 1/0) AS ?d) OPTIONAL { ?s :p ?d } FILTER(?d >= 1) }"),
      ElementsAre(a, ":c \"5\"^^integer"));
}

TEST_F(Batching, FiltersOfAnInnerGroupDoNotSeeWhatIsBoundAroundIt) {
  const SmallStore small(":a :p \"no number\" ; :q 7 . :c :p 5 .");
  const std::string inner = "?s :p ?v BIND(?v + 1 AS ?d)";
  const std::string a = ":a \"7\"^^integer", c = ":c \"6\"^^integer";
  EXPECT_THAT(small.rows("SELECT ?s ?d { { " + inner + " FILTER(?d > 3) } OPTIONAL { ?s :q ?d } }"), ElementsAre(c));
  EXPECT_THAT(small.rows("SELECT ?s ?d { { " + inner + " FILTER(!BOUND(?d)) } OPTIONAL { ?s :q ?d } }"),
              ElementsAre(a));
  EXPECT_THAT(
      small.rows("SELECT ?s ?d { { ?s :p ?v OPTIONAL { ?s :r ?d } FILTER(!BOUND(?d)) } OPTIONAL { ?s :q ?d } }"),
      ElementsAre(a, ":c -"));
  EXPECT_THAT(
      small.rows("SELECT ?s ?d { { " + inner + " FILTER(!BOUND(?d)) } OPTIONAL { ?s :r ?e } OPTIONAL { ?s :q ?d } }"),
      ElementsAre(a));
  EXPECT_THAT(
      small.rows("SELECT ?s ?d { ?s :p ?w OPTIONAL { { " + inner + " FILTER(?d > 3) } OPTIONAL { ?s :q ?d } } }"),
      ElementsAre(":a -", c));
}

}  // namespace
}  // namespace cluxel::test
