// SPDX-License-Identifier: Apache-2.0
// Tests that budgets cover what happens before, between and after the batches of a query, and updates.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "cluxel/error.hpp"
#include "sparql/exec/spatial/box_tree.hpp"
#include "sparql/support/store_fixture.hpp"
#include "sparql/update_engine.hpp"

namespace cluxel::test {

using namespace rdf;
using namespace sparql;
namespace {

SmallStore numberedChain(int length) {
  SmallStore store;
  std::vector<Quad> quads;
  for (int i = 0; i < length; ++i)
    quads.push_back({Term::iri("http://example.org/n" + std::to_string(i)), Term::iri("http://example.org/next"),
                     Term::iri("http://example.org/n" + std::to_string(i + 1)), Term::iri("")});
  store.load(quads);
  return store;
}

void expectOverBudget(const SmallStore& store, const std::string& query, const QueryOptions& options) {
  try {
    store.ask(query, options);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::BudgetExceeded) << error.what();
  }
}

std::string longList(int length) {
  std::string list;
  for (int i = 0; i < length; ++i) list += (i > 0 ? ", \"text " : "\"text ") + std::to_string(i) + "\"";
  return list;
}

TEST(Budgets, CoverParsingAndPlanning) {
  const SmallStore store = numberedChain(3);
  const std::string query = "SELECT * { ?a :next ?b FILTER(STR(?b) IN (" + longList(200'000) + ")) }";
  QueryOptions options;
  options.budget.deadline = std::chrono::milliseconds(2);
  expectOverBudget(store, query, options);
  options.budget.deadline.reset();
  options.budget.max_memory_bytes = 20 << 20;
  expectOverBudget(store, query, options);
  options.budget.max_memory_bytes = 2048ULL << 20;
  EXPECT_TRUE(store.rows(query, options).empty());
}

TEST(Budgets, CoverLongTextsWithinABatch) {
  const SmallStore store = numberedChain(2000);
  const std::string long_text = "CONCAT(\"" + std::string(2'000'000, 'x') + "\", STR(?a))";
  QueryOptions options;
  options.budget.max_memory_bytes = 60 << 20;
  expectOverBudget(store, "SELECT ?a (" + long_text + " AS ?t) { ?a :next ?b }", options);
  options.budget.max_memory_bytes = 0;
  options.budget.deadline = std::chrono::milliseconds(100);
  const auto start = std::chrono::steady_clock::now();
  expectOverBudget(store, "SELECT (SUM(STRLEN(UCASE(" + long_text + "))) AS ?n) { ?a :next ?b }", options);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2)) << "all rows take some 30 s";
}

TEST(Budgets, CoverLongListsOfValues) {
  const SmallStore store = numberedChain(3);
  std::string rows;
  for (int i = 0; i < 200'000; ++i) rows += "(\"v" + std::to_string(i) + "\" " + std::to_string(i) + ") ";
  // Called while the query is parsed, and again while its values become terms.
  int calls = 0;
  QueryOptions options;
  options.budget.poll = [&calls] { ++calls; };
  const QuadReader reader = store.reader();
  const PreparedQuery small(reader, kPrefixes + "SELECT * { ?a :next ?v VALUES (?v ?i) { (1 2) } }", options);
  calls = 0;
  const PreparedQuery large(reader, kPrefixes + "SELECT * { ?a :next ?v VALUES (?v ?i) { " + rows + "} }", options);
  const int tokens = 4 * 200'000 / 4096;
  EXPECT_GT(calls, tokens + 20);
}

TEST(Budgets, HoldAComputedTextOnceAsATerm) {
  const SmallStore store = numberedChain(40);
  const std::string text = "CONCAT(\"" + std::string(1'000'000, 'x') + "\", STR(?a))";
  const std::string query = "SELECT ?a (" + text + " AS ?t) { ?a :next ?b }";
  QueryOptions options;
  options.budget.max_memory_bytes = 52'000'000;
  EXPECT_EQ(store.rows(query, options).size(), 40U) << "40 texts of 1 MB, and some copies of the last";
  options.budget.max_memory_bytes = 35'000'000;
  expectOverBudget(store, query, options);
}

TEST(Budgets, CoverThePackingOfTrees) {
  const Guard unlimited;
  Guard small;
  small.start({.max_memory_bytes = 1'000'000});
  Guard polled;
  int calls = 0;
  polled.start({.poll = [&calls] { ++calls; }});
  calls = 0;
  BoxTree tree;
  for (std::uint32_t i = 0; i < 100'000; ++i) {
    const double x = i * 7919U % 100'000U;
    tree.add({Interval{x, x + 1}, Interval{0, x}}, i);
  }
  EXPECT_THROW(tree.pack(small), Error);
  tree.pack(polled);
  EXPECT_GT(calls, 20);
  std::size_t found = 0;
  BoxTree::Box all;
  tree.search(all, [&found](std::uint32_t) { ++found; });
  EXPECT_EQ(found, 100'000U);
}

TEST(Budgets, CoverSorting) {
  const SmallStore store = numberedChain(600);
  QueryOptions options;
  options.budget.max_memory_bytes = 5'000'000;
  expectOverBudget(store, "SELECT ?a ?c { ?a :next ?b . ?c :next ?d } ORDER BY ?d ?b", options);
}

TEST(Budgets, CoverTheCallsOfTheSink) {
  class SlowSink : public ResultSink {
   public:
    void beginSolutions(std::span<const std::string>, const TermLookup&) override {}
    void boolean(bool) override {}
    void beginGraph() override {}
    void triple(const TermView&, const TermView&, const TermView&) override {}
    void end() override {}
    void rows(std::span<const ResultId>, std::size_t) override {
      std::this_thread::sleep_for(std::chrono::milliseconds(60));
      ++calls;
    }
    int calls = 0;
  };
  const SmallStore store = numberedChain(3000);
  const QuadReader reader = store.reader();
  QueryOptions options;
  options.budget.deadline = std::chrono::milliseconds(1500);
  SlowSink sink;
  EXPECT_THROW(runQuery(reader, kPrefixes + "SELECT * { ?a :next ?b . ?c :next ?d . FILTER(?a != ?c) } LIMIT 100000",
                        options, sink),
               Error);
  EXPECT_GT(sink.calls, 0);
}

TEST(Budgets, CoverUpdates) {
  const SmallStore store = numberedChain(600);
  const std::string request = kPrefixes + "INSERT { ?a :with ?c } WHERE { ?a :next ?b . ?c :next ?d }";
  for (const bool by_time : {false, true}) {
    UpdateOptions options;
    options.any_graph_writable = true;
    options.query.default_graph = DefaultGraph::Unnamed;
    if (by_time)
      options.query.budget.deadline = std::chrono::milliseconds(5);
    else
      options.query.budget.max_memory_bytes = 10 << 20;
    WriteTransaction transaction = store.environment()->write();
    try {
      runUpdate(transaction, request, options);
      FAIL() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::BudgetExceeded) << error.what();
      EXPECT_TRUE(std::string(error.what()).starts_with("update: ")) << error.what();
      EXPECT_NE(std::string(error.what()).find("nothing was changed"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace cluxel::test
