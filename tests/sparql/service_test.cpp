// SPDX-License-Identifier: Apache-2.0
// Tests of SERVICE: it is refused, or answered by the store that the caller named for the endpoint.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

#include "cluxel/error.hpp"
#include "sparql/support/store_fixture.hpp"

namespace cluxel::test {

using namespace rdf;
using namespace sparql;
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class Services : public testing::Test {
 protected:
  Services() { options.services["http://elsewhere/"] = &reader; }
  std::string refusal(const std::string& query, const QueryOptions& with) const {
    try {
      ours.ask(query, with);
    } catch (const Error& error) {
      return error.what();
    }
    return "no refusal";
  }
  const SmallStore ours{":a :p :b . :b :p :c . _:n :p :d ."};
  const SmallStore theirs{":b :name \"B\" . :c :name \"C\" . _:n :name \"N\" . :new :name \"only there\" ."};
  const QuadReader reader = theirs.reader();
  QueryOptions options;
};

TEST_F(Services, AreRefusedUnlessNamed) {
  const std::string query = "SELECT * { SERVICE <http://elsewhere/> { ?s ?p ?o } }";
  EXPECT_THAT(refusal(query, {}), HasSubstr("SERVICE <http://elsewhere/> is refused"));
  EXPECT_THAT(refusal("SELECT * { SERVICE SILENT <http://elsewhere/> { ?s ?p ?o } }", {}), HasSubstr("refused"));
  EXPECT_THAT(refusal("SELECT * { SERVICE <http://other/> { ?s ?p ?o } }", options), HasSubstr("refused"));
  EXPECT_THAT(refusal("SELECT * { ?s ?p ?e SERVICE ?e { ?s ?p ?o } }", options), HasSubstr("variable"));
}

TEST_F(Services, JoinWhatTheNamedStoreAnswers) {
  EXPECT_THAT(ours.rows("SELECT ?s ?n { ?s :p ?o SERVICE <http://elsewhere/> { ?o :name ?n } }", options),
              ElementsAre(":a \"B\"", ":b \"C\""));
  EXPECT_THAT(
      ours.rows("SELECT ?x { SERVICE <http://elsewhere/> { ?x :name ?n FILTER(STRSTARTS(?n, \"only\")) } }", options),
      ElementsAre(":new"));
  EXPECT_THAT(
      ours.rows("SELECT ?s { ?s :p ?o FILTER NOT EXISTS { SERVICE <http://elsewhere/> { ?o :name ?n } } }", options)
          .size(),
      1U);
}

/// A service is evaluated when the query is prepared. A parameter would be unbound within it and the answer wrong, so
/// it is refused.
TEST_F(Services, RefuseParametersWithin) {
  const auto prepare = [&](const std::string& service) {
    PreparedQuery(ours.reader(), kPrefixes + "SELECT ?s { ?s :p ?o SERVICE <http://elsewhere/> { " + service + " } }",
                  options, {"n"});
  };
  for (const char* service :
       {"?o :name ?n", "?o :name ?m FILTER(?m = ?n)", "?o :name ?m BIND(?n AS ?k)",
        "{ SELECT (MAX(CONCAT(?m, ?n)) AS ?k) { ?o :name ?m } }", "?o :name ?m FILTER EXISTS { ?x :name ?n }"}) {
    EXPECT_THROW(prepare(service), InputError) << service;
  }
  const QuadReader reader_of_ours = ours.reader();
  PreparedQuery outside(
      reader_of_ours, kPrefixes + "SELECT ?s { ?s :p ?o SERVICE <http://elsewhere/> { ?o :name ?m } FILTER(?m = ?n) }",
      options, {"n"});
  EXPECT_EQ(outside.evaluate({{"n", Term::literal("C")}}).table.row_count, 1u);
}

TEST_F(Services, KeepTheirBlankNodesToThemselves) {
  EXPECT_TRUE(ours.rows("SELECT ?d { ?x :p ?d SERVICE <http://elsewhere/> { ?x :name \"N\" } }", options).empty());
}

TEST_F(Services, WorkWithinTheBudget) {
  options.budget.max_work_rows = 3;
  EXPECT_THAT(refusal("SELECT * { SERVICE <http://elsewhere/> { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i } }", options),
              testing::Not("no refusal"));
}

TEST_F(Services, ShareOneBudgetWithEachOtherAndTheQuery) {
  // Four rows of each side, and four joined rows.
  const std::string one = "{ SERVICE <http://elsewhere/> { ?x :name ?n } }";
  const auto worked = [&](const std::string& query, std::uint64_t rows) {
    options.budget.max_work_rows = rows;
    return refusal(query, options) == "no refusal";
  };
  std::uint64_t least = 1;
  while (!worked("SELECT ?x " + one, least)) ++least;
  ASSERT_GT(least, 4U);
  EXPECT_FALSE(worked("SELECT ?x { " + one + " UNION " + one + " }", least));
  EXPECT_TRUE(worked("SELECT ?x { " + one + " UNION " + one + " }", 4 * least));
}

/// The minimum budget for which `works` returns true.
template <typename Works>
std::uint64_t leastBudget(const Works& works) {
  std::uint64_t enough = 1, too_little = 0;
  while (!works(enough)) too_little = std::exchange(enough, enough * 2);
  while (enough - too_little > 1) {
    const std::uint64_t middle = too_little + (enough - too_little) / 2;
    (works(middle) ? enough : too_little) = middle;
  }
  return enough;
}

TEST_F(Services, CountInEveryRunOfAPreparedQuery) {
  const std::string text = "PREFIX : <http://example.org/> SELECT ?x { SERVICE <http://elsewhere/> { ?x :name ?n } }";
  const QuadReader mine = ours.reader();
  for (std::uint64_t QueryBudget::*what : {&QueryBudget::max_work_rows, &QueryBudget::max_memory_bytes}) {
    const auto with = [&](std::uint64_t amount) {
      QueryOptions limited = options;
      limited.budget.*what = amount;
      return limited;
    };
    const std::uint64_t least = leastBudget([&](std::uint64_t amount) {
      try {
        return PreparedQuery(mine, text, with(amount)).evaluate().table.row_count == 4;
      } catch (const Error&) {
        return false;
      }
    });
    ASSERT_GT(least, 4U);
    PreparedQuery enough(mine, text, with(least));
    for (int run = 0; run < 3; ++run) EXPECT_EQ(enough.evaluate().table.row_count, 4U) << run;
    try {
      PreparedQuery too_little(mine, text, with(least - 1));
      for (int run = 0; run < 3; ++run) EXPECT_THROW(too_little.evaluate(), Error) << run;
    } catch (const Error&) {
      // The service may need more memory for its own run than the query for the rows.
      EXPECT_EQ(what, &QueryBudget::max_memory_bytes) << "preparing succeeds";
    }
  }
}

TEST_F(Services, HoldNoMoreThanTheirRowsOnceTheyAreAnswered) {
  SmallStore large;
  std::vector<Quad> quads;
  for (int i = 0; i < 3000; ++i) {
    const auto iri = [&](const std::string& local) { return Term::iri("http://example.org/" + local); };
    quads.push_back({iri("thing" + std::to_string(i)), iri("size"), Term::integer(i * 7 % 1000), Term::iri("")});
  }
  large.load(quads);
  const QuadReader many = large.reader();
  options.services["http://large/"] = &many;
  const auto works = [&](const std::string& query) {
    return [&, query](std::uint64_t bytes) {
      options.budget.max_memory_bytes = bytes;
      return refusal(query, options) == "no refusal";
    };
  };
  const std::string sorts = "{ SERVICE <http://large/> { SELECT ?x { ?x :size ?w } ORDER BY ?w ?x OFFSET 2995 } }";
  const std::string groups =
      "{ SERVICE <http://large/> { SELECT (COUNT(*) AS ?x) { { SELECT DISTINCT ?y ?w { ?y :size ?w } } } } }";
  for (const std::string& one : {sorts, groups}) {
    const std::uint64_t least = leastBudget(works("SELECT ?x " + one));
    ASSERT_GT(least, 20'000U) << one;
    const std::uint64_t both = leastBudget(works("SELECT ?x { " + one + " UNION " + one + " UNION " + one + " }"));
    EXPECT_LT(both, least + 2'000) << one;
    EXPECT_GE(both, least) << one;
    // The memory of the service's plan is released before the run.
    const std::uint64_t with_own =
        leastBudget(works("SELECT ?x { " + one + " { SELECT ?s { ?s :p ?o } ORDER BY ?o } }"));
    EXPECT_LT(with_own, least + 2'000) << one;
  }
}

}  // namespace
}  // namespace cluxel::test
