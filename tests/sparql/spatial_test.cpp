// SPDX-License-Identifier: Apache-2.0
// Tests of the R-tree for spatial filters: it may only exclude what the filter excludes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "sparql/support/store_fixture.hpp"
#include "sparql/update_engine.hpp"

namespace cluxel::test {

using namespace rdf;
using namespace sparql;
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kWktDatatype = "http://www.opengis.net/ont/geosparql#wktLiteral";

class GeometryMaker {
 public:
  explicit GeometryMaker(std::uint32_t seed) : random_(seed) {}

  int upTo(int limit) { return static_cast<int>(random_() % static_cast<std::uint32_t>(limit)); }
  std::string pair(int x, int y) { return std::to_string(x) + " " + std::to_string(y); }
  /// Mostly small geometries on a grid, many of which touch; some empty and some faulty ones; one that covers all.
  std::string wkt() {
    const int x = upTo(200), y = upTo(200), w = 1 + upTo(12), h = 1 + upTo(12);
    switch (upTo(12)) {
      case 0:
        return "LINESTRING(" + pair(x, y) + ", " + pair(x + w, y + h) + ")";
      case 1:
      case 2:
      case 3:
        return box(x, y, x + w, y + h);
      case 4:
        return "MULTIPOINT((" + pair(x, y) + "), (" + pair(x + w, y) + "))";
      case 5:
        return upTo(4) == 0 ? "POINT EMPTY" : "POINT(" + pair(x, y) + ")";
      case 6:
        return upTo(4) == 0 ? "POINT(1" : "POINT(" + std::to_string(x) + ".25 " + pair(y, y).substr(0, 1) + ")";
      case 7:
        return upTo(8) == 0 ? "LINESTRING(0 0, 220 220)" : box(x, y, x + w, y + h);
      default:
        return "POINT(" + pair(x, y) + ")";
    }
  }
  std::string condition() {
    const std::string literal = "\"" + wkt() + "\"^^geo:wktLiteral";
    const bool first = upTo(2) == 0;
    const std::string arguments = first ? "(?g, " + literal + ")" : "(" + literal + ", ?g)";
    const std::string limit = std::to_string(upTo(20)) + (upTo(2) == 0 ? ".5" : "");
    switch (upTo(7)) {
      case 0:
        return "geof:sfIntersects" + arguments;
      case 1:
        return "geof:sfWithin" + arguments;
      case 2:
        return "geof:sfContains" + arguments;
      case 3:
        return "geof:sfTouches" + arguments;
      case 4:
        return "geof:distance" + arguments + " <= " + limit;
      case 5:
        return limit + " > geof:distance" + arguments;
      default:
        return "geof:distance" + arguments + " < " + (upTo(6) == 0 ? "-1" : limit);
    }
  }

 private:
  std::string box(int x, int y, int right, int top) {
    return "POLYGON((" + pair(x, y) + ", " + pair(right, y) + ", " + pair(right, top) + ", " + pair(x, top) + ", " +
           pair(x, y) + "))";
  }
  std::mt19937 random_;
};

SmallStore placed(GeometryMaker& maker, int count) {
  SmallStore store;
  std::vector<Quad> quads;
  for (int i = 0; i < count; ++i) {
    const Term self = Term::iri("http://example.org/o" + std::to_string(i));
    const std::string datatype = maker.upTo(30) == 0 ? "http://www.w3.org/2001/XMLSchema#string" : kWktDatatype;
    quads.push_back({self, Term::iri("http://www.opengis.net/ont/geosparql#asWKT"),
                     Term::literal(maker.wkt(), datatype), Term::iri("")});
    quads.push_back({self, Term::iri("http://example.org/kind"), Term::integer(maker.upTo(5)), Term::iri("")});
    if (maker.upTo(3) == 0)
      quads.push_back(
          {self, Term::iri("http://example.org/also"), Term::literal(maker.wkt(), kWktDatatype), Term::iri("")});
  }
  store.load(quads);
  return store;
}

TEST(SpatialIndex, GivesTheAnswersOfTheFilterAlone) {
  int used = 0, found = 0;
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    GeometryMaker maker(seed);
    const SmallStore store = placed(maker, 400);
    for (int i = 0; i < 120; ++i) {
      const std::string condition = maker.condition();
      const std::string patterns[] = {"?o geo:asWKT ?g ", "?o :kind 3 . ?o geo:asWKT ?g ",
                                      "?o :kind ?k ; geo:asWKT ?g OPTIONAL { ?o :also ?h } "};
      const std::string& pattern = patterns[maker.upTo(3)];
      const std::string indexed = "SELECT * { " + pattern + "FILTER(" + condition + ") }";
      // The planner does not analyse IF.
      const std::string alone = "SELECT * { " + pattern + "FILTER(IF(" + condition + ", true, false)) }";
      const auto expected = store.rows(alone);
      EXPECT_EQ(store.rows(indexed), expected) << indexed;
      const QuadReader reader = store.reader();
      EXPECT_THAT(explainQuery(reader, kPrefixes + alone), Not(HasSubstr("R-tree")));
      used += explainQuery(reader, kPrefixes + indexed).find("R-tree") != std::string::npos ? 1 : 0;
      found += expected.empty() ? 0 : 1;
    }
  }
  EXPECT_GT(used, 200) << "the index is hardly used";
  EXPECT_GT(found, 100) << "hardly any filter lets something pass";
}

TEST(SpatialIndex, AlsoAnswersFiltersOnABoundDistance) {
  GeometryMaker maker(9);
  const SmallStore store = placed(maker, 400);
  const std::string distance = "geof:distance(?g, \"POINT(100 100)\"^^geo:wktLiteral)";
  const auto rows = store.rows("SELECT ?o ?d { ?o geo:asWKT ?g BIND(" + distance + " AS ?d) FILTER(?d < 15) }");
  EXPECT_FALSE(rows.empty());
  EXPECT_EQ(
      store.rows("SELECT ?o ?d { ?o geo:asWKT ?g BIND(" + distance + " AS ?d) FILTER(IF(?d < 15, true, false)) }"),
      rows);
  EXPECT_THAT(explainQuery(store.reader(),
                           kPrefixes + "SELECT ?o { ?o geo:asWKT ?g BIND(" + distance + " AS ?d) FILTER(?d < 15) }"),
              HasSubstr("R-tree"));
}

TEST(SpatialIndex, IsOfOneCommit) {
  SmallStore store;
  const std::string near =
      "SELECT ?o { ?o geo:asWKT ?g FILTER(geof:distance(?g, \"POINT(5 5)\"^^geo:wktLiteral) < 1) }";
  std::vector<Quad> far;
  for (int i = 0; i < 20; ++i)
    far.push_back({Term::iri("http://example.org/f" + std::to_string(i)),
                   Term::iri("http://www.opengis.net/ont/geosparql#asWKT"),
                   Term::literal("POINT(" + std::to_string(100 + i) + " 0)", kWktDatatype), Term::iri("")});
  store.load(far);
  const QuadReader before = store.reader();
  EXPECT_THAT(explainQuery(before, kPrefixes + near), HasSubstr("R-tree, 0 of 20"));
  store.load(":new geo:asWKT \"POINT(5 5.5)\"^^geo:wktLiteral .", "");
  EXPECT_THAT(store.rows(near), testing::ElementsAre(":new"));
  EXPECT_EQ(evaluateQuery(before, kPrefixes + near).table.row_count, 0U) << "an older reader sees its own commit";
}

TEST(SpatialIndex, SeesWhatAnUpdateHasWrittenBefore) {
  std::string turtle = ":a geo:asWKT \"POINT(0 0)\"^^geo:wktLiteral .";
  for (int i = 0; i < 20; ++i)
    turtle += " :f" + std::to_string(i) + " geo:asWKT \"POINT(9 " + std::to_string(100 + i) + ")\"^^geo:wktLiteral .";
  SmallStore store(turtle);
  WriteTransaction transaction = store.environment()->write();
  UpdateOptions options;
  options.any_graph_writable = true;
  options.query.default_graph = DefaultGraph::Unnamed;
  const std::string move =
      "DELETE { ?o geo:asWKT ?g } INSERT { ?o geo:asWKT \"POINT(TO)\"^^geo:wktLiteral } "
      "WHERE { ?o geo:asWKT ?g FILTER(geof:distance(?g, \"POINT(AT)\"^^geo:wktLiteral) < 1) }";
  const auto moved = [&](const std::string& from, const std::string& to) {
    std::string request = move;
    request.replace(request.find("AT"), 2, from);
    return request.replace(request.find("TO"), 2, to);
  };
  const UpdateReport report =
      runUpdate(transaction, kPrefixes + moved("0 0", "50 50") + " ; " + moved("50 50", "60 60"), options);
  EXPECT_EQ(report.inserted, 2U) << "the second operation finds the geometry where the first has put it";
}

/// Signs, lamps and trees at given places.
const char* const kStreet =
    ":s1 a :Sign ; geo:asWKT \"POINT(0 0)\"^^geo:wktLiteral . :s2 a :Sign ; geo:asWKT \"POINT(10 0)\"^^geo:wktLiteral "
    ". "
    ":l1 a :Lamp ; :kind 1 ; geo:asWKT \"POINT(1 0)\"^^geo:wktLiteral . "
    ":l2 a :Lamp ; :kind 2 ; geo:asWKT \"POINT(3 0)\"^^geo:wktLiteral . "
    ":l3 a :Lamp ; :kind 1 ; geo:asWKT \"POINT(13 0)\"^^geo:wktLiteral . ";

QueryOptions plain() {
  QueryOptions options;
  options.spatial_plans = false;
  return options;
}

TEST(SpatialJoin, LimitsByAVariableRadiusAndByRadiiOfBothSides) {
  SmallStore store(std::string(kStreet) + ":s1 :reach 2 . :s2 :reach \"far\" . :l1 :reach 1 . :l3 :reach 2 .");
  const std::string pairs = "?s a :Sign ; geo:asWKT ?gs . ?l a :Lamp ; geo:asWKT ?gl . ";
  EXPECT_THAT(store.rows("SELECT ?s ?l { " + pairs + "?s :reach ?r FILTER(geof:distance(?gs, ?gl) < ?r) }"),
              testing::ElementsAre(":s1 :l1"));
  const std::string both = "SELECT ?s ?l { " + pairs + "?l :reach ?r FILTER(geof:distance(?gs, ?gl) < ?r + 2) }";
  EXPECT_THAT(store.rows(both), testing::ElementsAre(":s1 :l1", ":s2 :l3"));
  EXPECT_EQ(store.rows(both), store.rows(both, plain()));
}

TEST(NearestByAbsence, SeesVariablesOfTheOuterPatternWithinIt) {
  SmallStore store(kStreet);
  const std::string pairs = "?s a :Sign ; geo:asWKT ?gs . ?l a :Lamp ; geo:asWKT ?gl ; :kind ?k . ";
  const std::string closer = "FILTER(geof:distance(?gs, ?gm) < geof:distance(?gs, ?gl)) }";
  const std::string same_kind =
      "SELECT ?s ?l { " + pairs + "FILTER NOT EXISTS { ?m :kind ?k ; geo:asWKT ?gm . " + closer + " }";
  EXPECT_THAT(store.rows(same_kind), testing::ElementsAre(":s1 :l1", ":s1 :l2", ":s2 :l2", ":s2 :l3"));
  const std::string by_bind =
      "SELECT ?s ?l { " + pairs + "BIND(2 AS ?b) FILTER NOT EXISTS { ?m :kind ?b ; geo:asWKT ?gm . " + closer + " }";
  EXPECT_EQ(store.rows(by_bind), store.rows(by_bind, plain()));
  EXPECT_THAT(store.rows(by_bind), testing::ElementsAre(":s1 :l1", ":s1 :l2", ":s2 :l2", ":s2 :l3"));
}

TEST(NearestByMinimum, IsNotUsedWhereOtherConditionsRejectPairs) {
  SmallStore store(kStreet);
  const std::string query =
      "SELECT ?s (MIN(geof:distance(?gs, ?gl)) AS ?d) { ?s a :Sign ; geo:asWKT ?gs . ?l a :Lamp ; geo:asWKT ?gl "
      "FILTER(STR(?s) != \"http://example.org/s1\" || STR(?l) != \"http://example.org/l1\") } GROUP BY ?s";
  EXPECT_THAT(store.rows(query), testing::ElementsAre(":s1 \"3.0E0\"^^double", ":s2 \"3.0E0\"^^double"));
}

TEST(NearestByMinimum, IsTheNearestOfThoseThatShareAVariable) {
  std::string turtle;
  for (int i = 0; i < 400; ++i) {
    const std::string kind = std::to_string(i % 2), at = std::to_string(i * 37 % 400);
    turtle += ":p" + std::to_string(i) + " :kind " + kind + " ; :at \"POINT(" + at + " 0)\"^^geo:wktLiteral . ";
    turtle += ":q" + std::to_string(i) + " :sort " + kind + " ; :place \"POINT(" + at + " 1)\"^^geo:wktLiteral . ";
  }
  const SmallStore store(turtle);
  const std::string query =
      "SELECT ?p (MIN(geof:distance(?gp, ?gq)) AS ?d) { ?p :kind ?k ; :at ?gp . ?q :sort ?k ; :place ?gq } GROUP BY ?p";
  EXPECT_EQ(store.rows(query), store.rows(query, plain()));
}

/// The rows of the plan with and without spatial steps, which must agree; and whether the plan stops at enough rows.
bool stopsEarly(const SmallStore& store, const std::string& query) {
  QueryOptions plain;
  plain.spatial_plans = false;
  EXPECT_EQ(store.rows(query), store.rows(query, plain)) << query;
  const QuadReader reader = store.reader();
  return PreparedQuery(reader, kPrefixes + query).explain().find(", the nearest ") != std::string::npos;
}

TEST(NearestByCount, IsUsedOnlyWhereEveryPairOfAGroupIsCounted) {
  SmallStore store;
  std::vector<Quad> quads;
  std::mt19937 random(3);
  const auto iri = [](const std::string& name) { return Term::iri("http://example.org/" + name); };
  for (int i = 0; i < 90; ++i) {
    const Term thing = iri("n" + std::to_string(i));
    quads.push_back({thing, iri("kind"), Term::literal(std::to_string(i % 3)), Term::iri("")});
    for (int j = 0; j <= i % 2; ++j)
      quads.push_back(
          {thing, Term::iri("http://www.opengis.net/ont/geosparql#asWKT"),
           Term::literal("POINT(" + std::to_string(random() % 50) + " " + std::to_string(random() % 50) + ")",
                         kWktDatatype),
           Term::iri("")});
  }
  store.load(quads);
  const std::string pairs = "?a :kind \"0\" ; geo:asWKT ?ga . ?b :kind \"1\" ; geo:asWKT ?gb . ",
                    others =
                        "?c :kind \"1\" ; geo:asWKT ?gc . FILTER(geof:distance(?ga, ?gc) <= geof:distance(?ga, ?gb)) ",
                    all = "SELECT ?a ?b { " + pairs + others + "} GROUP BY ?a ?b ";
  EXPECT_TRUE(stopsEarly(store, all + "HAVING(COUNT(?c) <= 3)"));
  EXPECT_TRUE(stopsEarly(store, all + "HAVING(4 > COUNT(*))"));
  EXPECT_TRUE(stopsEarly(store, all + "HAVING(COUNT(?c) = 2 && MAX(STR(?gc)) != \"\")"));
  EXPECT_TRUE(stopsEarly(store, "SELECT ?a ?b (COUNT(?c) AS ?n) (MAX(geof:distance(?ga, ?gc)) AS ?d) { " + pairs +
                                    others + "} GROUP BY ?a ?b HAVING(COUNT(?c) < 5)"));
  EXPECT_TRUE(stopsEarly(
      store, "SELECT ?a ?b { " + pairs + "OPTIONAL { " + others + "} } GROUP BY ?a ?b HAVING(COUNT(?c) < 3)"));
  EXPECT_FALSE(stopsEarly(store, "SELECT ?a ?b { " + pairs + "OPTIONAL { " + others +
                                     "} FILTER(!BOUND(?c) || ?c != ?b) } GROUP BY ?a ?b HAVING(COUNT(?c) < 3)"))
      << "a filter above an OPTIONAL sees what has no match";
  const std::string some_labels =
      "?c geo:asWKT ?gc . { SELECT ?c ?l { ?c :kind \"1\" OPTIONAL { ?c :kind ?l FILTER(STR(?c) < "
      "\"http://example.org/n5\") } } } FILTER(geof:distance(?ga, ?gc) <= geof:distance(?ga, ?gb)) ";
  stopsEarly(store,
             "SELECT ?a ?b (COUNT(?l) AS ?n) { " + pairs + some_labels + "} GROUP BY ?a ?b HAVING(COUNT(?l) < 3)");
  EXPECT_TRUE(stopsEarly(store, all + "HAVING(COUNT(DISTINCT ?c) <= 3)")) << "the pairs of one thing count once";
  EXPECT_FALSE(stopsEarly(store, all + "HAVING(COUNT(DISTINCT *) <= 3)")) << "rows are not compared there";
  EXPECT_FALSE(stopsEarly(store, all + "HAVING(COUNT(?c) >= 3)"));
  EXPECT_FALSE(stopsEarly(store, all + "HAVING(COUNT(?c) < 3 || MAX(?gc) = MIN(?gc))"));
  EXPECT_FALSE(stopsEarly(store, "SELECT ?a ?c { " + pairs + others + "} GROUP BY ?a ?c HAVING(COUNT(?b) < 9)"));
  EXPECT_FALSE(stopsEarly(
      store, "SELECT ?a { " + pairs + others +
                 "FILTER EXISTS { ?c geo:asWKT ?gd FILTER(?gd != ?gb) } } GROUP BY ?a ?b HAVING(COUNT(*) < 3)"));
}

TEST(OrderWithLimit, ComputesColumnsOfKeptRowsOnlyAndBreaksTiesByThem) {
  std::string turtle;
  for (int i = 0; i < 2000; ++i)
    turtle +=
        ":o" + std::to_string(i) + " :height " + std::to_string(i % 7) + " ; :name \"n" + std::to_string(i) + "\" . ";
  SmallStore store(turtle);
  for (const char* query :
       {"SELECT ?t { ?o :height ?h ; :name ?n BIND(UCASE(?n) AS ?t) } ORDER BY DESC(?h) LIMIT 9 OFFSET 3",
        "SELECT (UCASE(?n) AS ?t) ?h { ?o :height ?h ; :name ?n } ORDER BY ?h LIMIT 400",
        "SELECT (UCASE(?n) AS ?t) { ?o :name ?n } ORDER BY DESC(?t) LIMIT 5",
        "SELECT (UCASE(?n) AS ?t) (STRLEN(?t) AS ?u) { ?o :name ?n } ORDER BY ?u ?t LIMIT 5"})
    EXPECT_EQ(store.ordered(query), store.ordered(query, plain())) << query;
}

}  // namespace
}  // namespace cluxel::test
