// SPDX-License-Identifier: Apache-2.0
// Cluxel and oxigraph answer the same random queries with equal multisets. CLUXEL_DIFFERENTIAL sets their number.
#include <gtest/gtest.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <map>

#include "sparql/support/differential_fixture.hpp"
#include "sparql/support/generated_map_fixture.hpp"
#include "sparql/support/query_generator_fixture.hpp"

namespace cluxel::sparql {

using namespace rdf;
namespace {

using test::EngineAnswer;
using test::EngineRequest;
using test::MadeQuery;

constexpr int kObjects = 24;

struct Asked {
  MadeQuery query;
  std::string text;  ///< what is asked now: with or without its LIMIT
  bool union_graph = false;
};

EngineAnswer askCluxel(const QuadReader& reader, const Asked& asked) {
  return test::askCluxel(reader, test::textFor(test::kOurs, asked.text), asked.union_graph);
}

std::vector<Asked> makeRequests(std::uint32_t seed, int count, bool union_graph) {
  test::QueryGenerator generator(seed * 2 + (union_graph ? 1 : 0));
  std::vector<Asked> requests;
  for (int i = 0; i < count; ++i) {
    const MadeQuery query = generator.next();
    requests.push_back({query, query.unlimited.empty() ? query.text : query.unlimited, union_graph});
  }
  return requests;
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
  if (column == table.variables.size()) return true;  // SELECT * did not see it
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
    for (std::size_t i = 0; i < table.variables.size(); ++i)
      key += (table.at(row, i) ? toNTriples(*table.at(row, i)) : "") + '\t';
    ++counts[key];
  }
  return counts;
}

/// The rows with a LIMIT have the expected number, and all are among the rows without it.
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
  if (told) return std::atoi(told);
  return std::getenv("CLUXEL_LONG_TESTS") != nullptr ? 2000 : 1000;
}

struct Tally {
  std::size_t asked = 0, same = 0;
};

void compare(const QuadReader& reader, const Asked& asked, const EngineAnswer& theirs, Tally& tally) {
  const EngineAnswer ours = askCluxel(reader, asked);
  const std::string difference = test::differenceOf(ours, theirs);
  ++tally.asked;
  tally.same += difference.empty() && ours.result ? 1 : 0;
  if (!difference.empty())
    ADD_FAILURE() << difference << (asked.union_graph ? "over the union:\n" : "over the unnamed graph:\n")
                  << test::textFor(test::kOurs, asked.text);
  if (!ours.result || ours.result->kind != QueryResult::Kind::Solutions) return;
  if (!asked.query.ordered_by.empty()) {
    EXPECT_TRUE(isOrdered(ours.result->table, asked.query)) << asked.text;
  }
  if (!asked.query.unlimited.empty()) checkLimited(reader, asked, *ours.result);
}

class Differential : public testing::TestWithParam<std::uint32_t> {};

TEST_P(Differential, RandomQueriesHaveTheAnswersOfASecondEngine) {
  const auto folder = test::secondEngineFolder();
  if (!folder) GTEST_SKIP() << "outside data absent: node and the npm package oxigraph (./run test installs them)";
  const std::vector<Quad> quads = test::madeMap(GetParam(), kObjects);
  const auto environment = test::storeOf(quads);
  const QuadReader reader(environment->read());
  Tally tally;
  for (const bool union_graph : {false, true}) {
    const std::vector<Asked> requests = makeRequests(GetParam(), requestedCount() / 8, union_graph);
    std::vector<EngineRequest> foreign;
    for (const Asked& asked : requests) foreign.push_back({test::textFor(test::kTheirs, asked.text)});
    const auto answers = test::askSecondEngine(*folder, union_graph ? test::withUnionAsDefault(quads) : quads, foreign);
    for (std::size_t i = 0; i < requests.size(); ++i) compare(reader, requests[i], answers[i], tally);
  }
  EXPECT_GT(tally.same, tally.asked * 95 / 100) << "too few queries were answered by both";
}

INSTANTIATE_TEST_SUITE_P(Seeds, Differential, testing::Values(1U, 2U, 3U, 4U));

}  // namespace
}  // namespace cluxel::sparql
