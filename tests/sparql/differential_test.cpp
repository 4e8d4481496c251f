// SPDX-License-Identifier: Apache-2.0
// The same random queries to Cluxel and to oxigraph: the same answers, as multisets. CLUXEL_DIFFERENTIAL sets how many.
#include <gtest/gtest.h>

#include <array>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <map>

#include "cluxel/base/diagnostic.hpp"
#include "cluxel/knowledge/rdf_io.hpp"
#include "cluxel/knowledge/vocabulary.hpp"
#include "cluxel/sparql/query_engine.hpp"
#include "cluxel/sparql/result_writer.hpp"
#include "sparql/generated_map_fixture.hpp"
#include "sparql/query_generator_fixture.hpp"
#include "sparql/result_comparison_fixture.hpp"
#include "sparql/second_engine_fixture.hpp"

namespace cluxel {
namespace {

using test::EngineAnswer;
using test::EngineRequest;
using test::MadeQuery;

constexpr int kObjects = 24;

struct Asked {
  MadeQuery query;
  std::string text;         ///< what is asked now: with or without its LIMIT
  bool union_graph = false;
};

/// Numbers to ten digits, so that the order of a sum and the digits of a division do not count.
Term rounded(const Term& term) {
  const bool number = term.datatype == vocabulary::xsd("double") || term.datatype == vocabulary::xsd("decimal") ||
                      term.datatype == vocabulary::xsd("float");
  double value = 0;
  const char* end = term.text.data() + term.text.size();
  if (!number || std::from_chars(term.text.data(), end, value).ptr != end) return term;
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.10g", value == 0 ? 0.0 : value);
  return Term::literal(text.data(), term.datatype);
}

QueryResult rounded(QueryResult result) {
  for (Term& term : result.table.terms) term = rounded(term);
  for (Quad& quad : result.graph) quad.object = rounded(quad.object);
  return result;
}

EngineAnswer askCluxel(const QuadReader& reader, const Asked& asked) {
  QueryOptions options;
  options.default_graph = asked.union_graph ? DefaultGraph::UnionButHistory : DefaultGraph::Unnamed;
  options.budget.deadline = std::chrono::seconds(20);
  try {
    return {evaluateQuery(reader, asked.text, options), {}};
  } catch (const Error& error) {
    return {std::nullopt, error.what()};
  }
}

EngineRequest requestOf(const Asked& asked) {
  EngineRequest request{asked.text};
  for (const std::string& graph : test::madeGraphs()) {
    if (asked.union_graph && graph != vocabulary::kGraphHistory) request.default_graphs.push_back(graph);
    if (asked.union_graph && !graph.empty()) request.named_graphs.push_back(graph);
  }
  return request;
}

std::shared_ptr<Environment> storeOf(const std::vector<Quad>& quads) {
  auto environment = Environment::temporary();
  WriteTransaction transaction = environment->write();
  QuadWriter writer(transaction);
  for (const Quad& quad : quads) writer.add(quad);
  writer.flush();
  transaction.commit();
  return environment;
}

std::vector<Asked> makeRequests(std::uint32_t seed, int count) {
  test::QueryGenerator generator(seed);
  std::vector<Asked> requests;
  for (int i = 0; i < count; ++i) {
    const MadeQuery query = generator.next();
    requests.push_back({query, query.unlimited.empty() ? query.text : query.unlimited, i % 2 == 1});
  }
  return requests;
}

/// The two engines differ here for a reason that is no fault of Cluxel's; empty when there is no such reason.
std::string justifiedDifference(const Asked& asked, const EngineAnswer& ours, const EngineAnswer& theirs) {
  (void)asked;
  (void)ours;
  (void)theirs;
  return {};
}

std::string differenceOf(const EngineAnswer& ours, const EngineAnswer& theirs) {
  if (!ours.result && !theirs.result) return {};
  if (!ours.result) return "Cluxel refused: " + ours.error;
  if (!theirs.result) return "oxigraph refused: " + theirs.error;
  return test::difference(rounded(*ours.result), rounded(*theirs.result));
}

double numberOf(const Term* term) {
  double value = 0;
  if (term) std::from_chars(term->text.data(), term->text.data() + term->text.size(), value);
  return value;
}

/// Unbound first, then by value; numbers only.
bool isOrdered(const ResultTable& table, const MadeQuery& query) {
  const auto column = static_cast<std::size_t>(
      std::find(table.variables.begin(), table.variables.end(), query.ordered_by) - table.variables.begin());
  for (std::size_t row = 1; row < table.row_count; ++row) {
    const Term* before = table.at(query.descending ? row : row - 1, column);
    const Term* after = table.at(query.descending ? row - 1 : row, column);
    if (before && (!after || numberOf(before) > numberOf(after))) return false;
  }
  return true;
}

std::map<std::string, int> rowCounts(const ResultTable& table) {
  std::map<std::string, int> counts;
  for (std::size_t row = 0; row < table.row_count; ++row) {
    std::string key;
    for (std::size_t i = 0; i < table.variables.size(); ++i) key += (table.at(row, i) ? toNTriples(*table.at(row, i)) : "") + '\t';
    ++counts[key];
  }
  return counts;
}

/// The rows under a LIMIT are as many as they may be, and all among the rows without it.
void checkLimited(const QuadReader& reader, const Asked& asked, const QueryResult& unlimited) {
  Asked limited = asked;
  limited.text = asked.query.text;
  const EngineAnswer answer = askCluxel(reader, limited);
  ASSERT_TRUE(answer.result) << answer.error << "\n" << limited.text;
  std::size_t limit = 0, offset = 0;
  std::sscanf(asked.query.text.c_str() + asked.query.unlimited.size(), " LIMIT %zu OFFSET %zu", &limit, &offset);
  const std::size_t all = unlimited.table.row_count;
  EXPECT_EQ(answer.result->table.row_count, std::min(limit, all - std::min(offset, all))) << limited.text;
  std::map<std::string, int> left = rowCounts(unlimited.table);
  for (const auto& [row, count] : rowCounts(answer.result->table)) EXPECT_LE(count, left[row]) << limited.text;
}

int requestedCount() {
  const char* told = std::getenv("CLUXEL_DIFFERENTIAL");
  return told ? std::atoi(told) : 2000;
}

class Differential : public testing::TestWithParam<std::uint32_t> {};

TEST_P(Differential, RandomQueriesHaveTheAnswersOfASecondEngine) {
  const auto folder = test::secondEngineFolder();
  if (!folder) GTEST_SKIP() << "outside data absent: node and the npm package oxigraph (./run test installs them)";
  const std::vector<Quad> quads = test::madeMap(GetParam(), kObjects);
  const auto environment = storeOf(quads);
  const QuadReader reader(environment->read());
  const std::vector<Asked> requests = makeRequests(GetParam(), requestedCount() / 4);
  std::vector<EngineRequest> foreign;
  for (const Asked& asked : requests) foreign.push_back(requestOf(asked));
  const std::vector<EngineAnswer> answers = test::askSecondEngine(*folder, quads, foreign);
  std::map<std::string, int> justified;
  std::size_t same = 0;
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const EngineAnswer ours = askCluxel(reader, requests[i]);
    const std::string difference = differenceOf(ours, answers[i]);
    const std::string reason = difference.empty() ? "" : justifiedDifference(requests[i], ours, answers[i]);
    if (!reason.empty()) ++justified[reason];
    else EXPECT_EQ(difference, "") << "query " << i << (requests[i].union_graph ? " over the union" : "") << ":\n" << requests[i].text;
    same += difference.empty() && ours.result ? 1 : 0;
    if (!ours.result || ours.result->kind != QueryResult::Kind::Solutions) continue;
    if (!requests[i].query.ordered_by.empty()) {
      EXPECT_TRUE(isOrdered(ours.result->table, requests[i].query)) << requests[i].text;
    }
    if (!requests[i].query.unlimited.empty()) checkLimited(reader, requests[i], *ours.result);
  }
  EXPECT_GT(same, requests.size() * 95 / 100) << "too few queries were answered by both";
  for (const auto& [reason, count] : justified) std::printf("%d queries differ: %s\n", count, reason.c_str());
}

INSTANTIATE_TEST_SUITE_P(Seeds, Differential, testing::Values(1U, 2U, 3U, 4U));

}  // namespace
}  // namespace cluxel
