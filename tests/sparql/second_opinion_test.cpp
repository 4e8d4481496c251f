// SPDX-License-Identifier: Apache-2.0
// Compares Cluxel with oxigraph on the shipped questions and on all ways in which an EXISTS can refer to the outer
// solution.
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>

#include "base/file_bytes.hpp"
#include "rdf/vocabulary.hpp"
#include "sparql/support/differential_fixture.hpp"
#include "sparql/support/generated_map_fixture.hpp"
#include "test_paths.hpp"

namespace cluxel::sparql {

using namespace rdf;
namespace {

namespace fs = std::filesystem;
using test::EngineAnswer;
using test::EngineRequest;

/// The outer solution: one variable that is always bound, and one that is sometimes bound.
const std::vector<std::string> kAround = {
    "?a a clx:Tree ; clx:height ?n .",
    "?a clx:near ?b . ?a clx:pointCount ?n .",
    "?a a ?k . OPTIONAL { ?a clx:pointCount ?n }",
    "?a clx:height ?n . OPTIONAL { ?a clx:label ?s } OPTIONAL { ?b clx:near ?a }",
};

const std::vector<std::string> kWithin = {
    "{ SELECT ?a (COUNT(?x) AS ?c) { ?a clx:near ?x } GROUP BY ?a HAVING(COUNT(?x) > 1) }",
    "{ SELECT ?x { ?x clx:near ?a } }",
    "{ SELECT ?x { ?x clx:pointCount ?n } } ?a clx:near ?x",
    "{ SELECT ?a ?n { ?a clx:pointCount ?p FILTER(?p > ?n) } }",
    "{ SELECT ?a ?p { ?a clx:pointCount ?p } ORDER BY DESC(?p) LIMIT 1 } FILTER(?p > 3)",
    "{ SELECT (MAX(?p) AS ?m) ?a { ?a clx:pointCount ?p } GROUP BY ?a } FILTER(?m > ?n)",
    "?a clx:near ?x MINUS { ?x clx:pointCount ?p FILTER(?p > ?n) }",
    "?a clx:near ?x MINUS { ?x a clx:Tree }",
    "?a clx:near ?x MINUS { ?a clx:near ?x FILTER(?n > 2) }",
    "?a clx:near ?x MINUS { { SELECT ?x ?n { ?x clx:pointCount ?p FILTER(?p > ?n) } } }",
    "?a clx:near ?x OPTIONAL { ?x clx:pointCount ?p FILTER(?p < ?n) } FILTER(BOUND(?p))",
    "?a clx:near ?x OPTIONAL { ?x clx:pointCount ?p OPTIONAL { ?p clx:none ?q FILTER(?n > 1) } } FILTER(?p > 1)",
    "{ ?a clx:near ?x FILTER(?n > 2) } ?x a ?z",
    "{ ?a clx:near ?x OPTIONAL { ?x clx:pointCount ?p FILTER(?n > 2) } } ?y clx:pointCount ?p FILTER(?n < 9)",
    "{ ?a clx:near ?x } UNION { ?a clx:hasPart ?x FILTER(?n > 1) }",
    "BIND(?n + 1 AS ?q) ?a clx:pointCount ?p FILTER(?p < ?q)",
    "{ BIND(?n + 1 AS ?q) } ?a clx:pointCount ?p FILTER(?p < ?q)",
    "{ SELECT ?x { ?x clx:pointCount ?p } ORDER BY DESC(?p) ?x LIMIT 3 } ?a clx:near ?x",
    "VALUES ?n { 1 2 3 }",
    "VALUES (?a ?x) { (<https://w3id.org/cluxel/map/object/1> 3) (UNDEF 5) } FILTER(?x > ?n)",
    "?x clx:near ?a FILTER NOT EXISTS { ?x clx:pointCount ?p FILTER(?p > ?n) }",
    "FILTER EXISTS { { SELECT ?a ?x { ?x clx:near ?a } LIMIT 1 } FILTER(?n > 0) }",
    "?a clx:near+ ?x . ?x clx:height ?n",
    "?a clx:near ?x . { ?x clx:height ?h FILTER(?h >= ?n) } UNION { ?x clx:width ?h FILTER(?h >= ?n) }",
};

std::vector<std::string> existsQueries() {
  const std::string prefix = "PREFIX clx: <https://w3id.org/cluxel/ontology#> ";
  std::vector<std::string> queries;
  for (const std::string& around : kAround) {
    for (const std::string& within : kWithin) {
      for (const char* exists : {"EXISTS", "NOT EXISTS"})
        queries.push_back(prefix + "SELECT * { " + around + " FILTER " + exists + " { " + within + " } }");
      queries.push_back(prefix + "SELECT ?a (IF(EXISTS { " + within + " }, 1, 2) AS ?z) { " + around + " }");
    }
  }
  return queries;
}

void compareAll(const std::vector<Quad>& quads, const std::vector<std::string>& ours,
                const std::vector<std::string>& theirs, bool union_graph,
                const std::vector<std::vector<Binding>>& bindings, const fs::path& folder) {
  const auto environment = test::storeOf(quads);
  const QuadReader reader(environment->read());
  std::vector<EngineRequest> foreign;
  for (const std::string& text : theirs) foreign.push_back({text});
  const auto answers = test::askSecondEngine(folder, union_graph ? test::withUnionAsDefault(quads) : quads, foreign);
  for (std::size_t i = 0; i < ours.size(); ++i) {
    const EngineAnswer mine =
        test::askCluxel(reader, ours[i], union_graph, bindings.empty() ? std::vector<Binding>() : bindings[i]);
    EXPECT_TRUE(mine.result) << mine.error << "\n" << ours[i];
    EXPECT_EQ(test::differenceOf(mine, answers[i]), "") << ours[i];
  }
}

class SecondOpinion : public testing::TestWithParam<std::uint32_t> {
 protected:
  void SetUp() override {
    folder_ = test::secondEngineFolder();
    if (!folder_) GTEST_SKIP() << "outside data absent: node and the npm package oxigraph (./run test installs them)";
  }
  std::optional<fs::path> folder_;
};

TEST_P(SecondOpinion, SolutionsAroundAnExistsHoldInAllOfItsParts) {
  const std::vector<std::string> queries = existsQueries();
  compareAll(test::madeMap(GetParam(), 24), queries, queries, false, {}, *folder_);
}

/// Parameters of a shipped question: `#! parameter: name [unit] = default help`.
std::vector<Binding> parametersOf(const std::string& text) {
  static const std::regex line(R"(#! parameter: (\w+) \[[^\]]*\] = (\S+))");
  std::vector<Binding> bindings;
  for (auto match = std::sregex_iterator(text.begin(), text.end(), line); match != std::sregex_iterator(); ++match)
    bindings.emplace_back((*match)[1], Term::literal((*match)[2].str(), vocabulary::xsd("decimal")));
  return bindings;
}

/// For the second engine, parameters are replaced by their values.
std::string filledIn(std::string text, const std::vector<Binding>& bindings) {
  for (const auto& [name, value] : bindings)
    text = std::regex_replace(text, std::regex("\\?" + name + "\\b"), toNTriples(value));
  return text;
}

TEST_P(SecondOpinion, ShippedQuestionsHaveTheSameAnswers) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(test::sourceFolder() / "queries"))
    if (entry.path().extension() == ".rq") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  ASSERT_GE(files.size(), 11U);
  std::vector<std::string> ours, theirs;
  std::vector<std::vector<Binding>> bindings;
  for (const fs::path& file : files) {
    ours.push_back(readFile(file));
    bindings.push_back(parametersOf(ours.back()));
    theirs.push_back(filledIn(ours.back(), bindings.back()));
  }
  const std::vector<Quad> quads = test::surveyedMap(GetParam(), 300);
  compareAll(quads, ours, theirs, true, bindings, *folder_);
  const auto environment = test::storeOf(quads);
  const QuadReader reader(environment->read());
  for (std::size_t i = 0; i < ours.size(); ++i) {
    const EngineAnswer answer = test::askCluxel(reader, ours[i], true, bindings[i]);
    ASSERT_TRUE(answer.result) << answer.error;
    EXPECT_GT(answer.result->table.row_count, 0U) << "nothing is compared: " << files[i];
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, SecondOpinion, testing::Values(1U, 2U, 3U));

}  // namespace
}  // namespace cluxel::sparql
