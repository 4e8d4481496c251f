// SPDX-License-Identifier: Apache-2.0
// SERVICE: refused, or answered by the store that the caller has named for the endpoint.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cluxel/base/diagnostic.hpp"
#include "sparql/store_fixture.hpp"

namespace cluxel::test {
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
  EXPECT_THAT(ours.rows("SELECT ?x { SERVICE <http://elsewhere/> { ?x :name ?n FILTER(STRSTARTS(?n, \"only\")) } }", options),
              ElementsAre(":new"));
  EXPECT_THAT(ours.rows("SELECT ?s { ?s :p ?o FILTER NOT EXISTS { SERVICE <http://elsewhere/> { ?o :name ?n } } }", options).size(), 1U);
}

TEST_F(Services, KeepTheirBlankNodesToThemselves) {
  EXPECT_TRUE(ours.rows("SELECT ?d { ?x :p ?d SERVICE <http://elsewhere/> { ?x :name \"N\" } }", options).empty());
}

TEST_F(Services, WorkWithinTheBudget) {
  options.budget.max_work_rows = 3;
  EXPECT_THAT(refusal("SELECT * { SERVICE <http://elsewhere/> { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i } }", options), testing::Not("no refusal"));
}

TEST_F(Services, ShareOneBudgetWithEachOtherAndTheQuery) {
  // Four rows each, and four of the rows that join them.
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

TEST_F(Services, CountInEveryRunOfAPreparedQuery) {
  options.budget.max_memory_bytes = 1;
  EXPECT_THAT(refusal("SELECT ?x { SERVICE <http://elsewhere/> { ?x :name ?n } }", options), HasSubstr("memory"));
  options.budget = {};
  options.budget.max_work_rows = 1000;
  const QuadReader mine = ours.reader();
  PreparedQuery query(mine, "PREFIX : <http://example.org/> SELECT ?x { SERVICE <http://elsewhere/> { ?x :name ?n } }", options);
  const std::size_t rows = query.evaluate().table.row_count;
  EXPECT_EQ(rows, 4U);
  EXPECT_EQ(query.evaluate().table.row_count, rows);
}

}  // namespace
}  // namespace cluxel::test
