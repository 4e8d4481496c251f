// SPDX-License-Identifier: Apache-2.0
// Answers as values: rows, columns, numbers, triples, limits and faults.
#include "cluxel/answer.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <iterator>
#include <ranges>
#include <type_traits>

#include "api/facade_campus.hpp"
#include "sparql/query_engine.hpp"

namespace cluxel {
namespace {

using ::testing::HasSubstr;

const Map& campusMap() {
  return FacadeCampus::shared().map;
}

static_assert(std::input_iterator<Answer::Iterator> && std::ranges::input_range<const Answer>);
static_assert(!std::is_constructible_v<Answer, std::shared_ptr<const Answer::Data>>, "no answer is made without data");

const std::string kPrefix = "PREFIX clx: <https://w3id.org/cluxel/ontology#> ";

TEST(Answer, HoldsTheTableOfTheEngine) {
  const std::string text = kPrefix + "SELECT ?o ?height ?none { ?o clx:rule ?rule ; clx:height ?height } ORDER BY ?o";
  const Answer answer = campusMap().query(text);
  const mapping::MapReader reader(campusMap().file());
  const sparql::ResultTable expected = sparql::evaluateQuery(reader.quads(), text).table;
  ASSERT_EQ(answer.kind(), AnswerKind::Solutions);
  EXPECT_EQ(answer.variables(), expected.variables);
  ASSERT_EQ(answer.size(), expected.row_count);
  ASSERT_GT(answer.size(), 3U);
  std::size_t rows = 0;
  for (const Answer::Row row : answer) {
    EXPECT_EQ(row.index(), rows);
    EXPECT_EQ(*row.find("o"), *expected.at(rows, 0));
    EXPECT_EQ(row.text("height"), expected.at(rows, 1)->text);
    EXPECT_DOUBLE_EQ(row.number("height"), std::stod(expected.at(rows, 1)->text));
    EXPECT_EQ(row.find(2), nullptr) << "unbound";
    EXPECT_TRUE(std::isnan(row.number("none")) && row.text("none").empty());
    ++rows;
  }
  EXPECT_EQ(rows, answer.size());
}

TEST(Answer, RefusesUnknownVariablesAndPlacesOutsideTheTable) {
  const Answer answer = campusMap().query(kPrefix + "SELECT ?height { ?o clx:height ?height } LIMIT 2");
  try {
    answer[0].text("hieght");
    FAIL() << "nothing was refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::InvalidArgument);
    EXPECT_THAT(error.what(), HasSubstr("did you mean 'height'"));
  }
  EXPECT_THROW(answer.at(2, 0), Error);
  EXPECT_THROW(answer.at(0, 1), Error);
}

TEST(Answer, IsTrueOrFalseForAsk) {
  EXPECT_TRUE(campusMap().query("ASK { ?s ?p ?o }").boolean());
  const Answer no = campusMap().query("ASK { ?s <http://example.org/none> ?o }");
  EXPECT_EQ(no.kind(), AnswerKind::Boolean);
  EXPECT_FALSE(no.boolean());
  EXPECT_TRUE(no.empty());
}

TEST(Answer, HoldsTriplesOfConstruct) {
  const Answer answer =
      campusMap().query(kPrefix + "CONSTRUCT { ?o clx:rule ?rule } { ?o clx:rule ?rule ; clx:heading ?heading }");
  EXPECT_EQ(answer.kind(), AnswerKind::Triples);
  EXPECT_EQ(answer.triples().size(), campusMap().objects().size());
}

TEST(Answer, TakesBindings) {
  const Object object = campusMap().objects().front();
  QueryOptions options;
  options.bindings["o"] = Term::iri(object.iri);
  const Answer answer = campusMap().query(kPrefix + "SELECT ?rule { ?o clx:rule ?rule }", options);
  ASSERT_EQ(answer.size(), 1U);
  EXPECT_EQ(answer[0].text("rule"), object.rule);
}

TEST(Answer, RefusesBindingsOfVariablesThatTheQueryDoesNotHave) {
  for (const char* name : {"?o", "p", ""}) {
    QueryOptions options;
    options.bindings[name] = Term::integer(1);
    EXPECT_THROW(campusMap().query("SELECT ?o { ?o ?x [] }", options), Error) << name;
  }
}

TEST(Answer, WarnsOfNamesThatTheMapDoesNotKnow) {
  const Answer answer = campusMap().query(kPrefix + "SELECT ?o { ?o a clx:Treee }");
  EXPECT_TRUE(answer.empty());
  ASSERT_EQ(answer.warnings().size(), 1U);
  EXPECT_EQ(answer.warnings().front().severity, Severity::Warning);
}

TEST(Answer, OutlivesItsMap) {
  const rdf::ScratchFolder folder;
  auto map = std::make_unique<Map>(FacadeCampus::shared().copyIn(folder.path()));
  const Answer answer = map->query(kPrefix + "SELECT ?class { ?o a ?class } LIMIT 1");
  map.reset();
  EXPECT_FALSE(answer[0].text("class").empty());
}

TEST(Query, NamesLineAndColumnOfAFault) {
  try {
    QueryOptions options;
    options.source_name = "trees.rq";
    campusMap().query("SELECT ?o\n{ ?o a }", options);
    FAIL() << "nothing was refused";
  } catch (const InputError& error) {
    const SourceLocation& at = error.diagnostics().front().location;
    EXPECT_EQ(error.kind(), ErrorKind::FaultyInput);
    EXPECT_EQ(at.file, "trees.rq");
    EXPECT_EQ(at.line, 2U);
    EXPECT_GT(at.column, 1U);
  }
}

TEST(Query, EndsAtItsLimits) {
  const auto kindWith = [](const QueryOptions& options) {
    try {
      campusMap().query("SELECT * { ?a ?b ?c . ?d ?e ?f }", options);
    } catch (const Error& error) {
      return error.kind();
    }
    return ErrorKind::NotFound;
  };
  QueryOptions options;
  options.max_rows = 10;
  EXPECT_EQ(kindWith(options), ErrorKind::BudgetExceeded);
  options = {};
  options.deadline = std::chrono::milliseconds(5);
  EXPECT_EQ(kindWith(options), ErrorKind::BudgetExceeded);
  options = {};
  options.max_memory_bytes = 1 << 20;
  EXPECT_EQ(kindWith(options), ErrorKind::BudgetExceeded);
  options = {};
  options.deadline = std::chrono::milliseconds(-5);
  EXPECT_EQ(kindWith(options), ErrorKind::InvalidArgument);
}

TEST(Answer, IsGivenUpWhenThePollThrows) {
  struct Stop {};
  const std::string pairs = "SELECT (COUNT(*) AS ?n) { ?a ?p ?b . ?c ?q ?d FILTER(?b = ?c) }";
  QueryOptions options;
  int calls = 0;
  options.poll = [&] {
    if (++calls == 3) throw Stop();
  };
  EXPECT_THROW(campusMap().query(pairs, options), Stop);
  EXPECT_EQ(calls, 3);
}

}  // namespace
}  // namespace cluxel
