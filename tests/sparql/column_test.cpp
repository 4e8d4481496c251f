// SPDX-License-Identifier: Apache-2.0
// Columns of a predicate's objects by subject hold what the index holds, and queries give the same answers with both.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <random>
#include <set>
#include <thread>

#include "cluxel/error.hpp"
#include "rdf/vocabulary.hpp"
#include "sparql/exec/spatial/subject_column.hpp"
#include "sparql/support/store_fixture.hpp"

namespace cluxel::test {

using namespace rdf;
using namespace sparql;
namespace {

using namespace sparql;
using testing::ElementsAreArray;
using testing::HasSubstr;

Term columnIri(const std::string& local) {
  return Term::iri("http://example.org/" + local);
}
Term graph(unsigned number) {
  return Term::iri(number == 0   ? ""
                   : number == 1 ? std::string(vocabulary::kGraphHistory)
                                 : "http://example.org/g" + std::to_string(number));
}

/// `things` subjects after `before` others, with up to `max_values` values each; a few have very many.
SmallStore strewn(std::uint32_t seed, unsigned before, unsigned things, unsigned max_values) {
  std::mt19937 random(seed);
  std::vector<Quad> quads;
  for (unsigned i = 0; i < before; ++i)
    quads.push_back({columnIri("early" + std::to_string(i)), columnIri("is"), columnIri("early"), graph(0)});
  for (unsigned i = 0; i < things; ++i) {
    const Term self = columnIri("thing" + std::to_string(i));
    quads.push_back({self, columnIri("is"), columnIri("thing"), graph(2)});
    const unsigned values = random() % 97 == 0 ? 300 : random() % (max_values + 1);
    for (unsigned k = 0; k < values; ++k)
      quads.push_back(
          {self, columnIri("p"), columnIri("thing" + std::to_string(random() % things)), graph(random() % 4)});
  }
  quads.push_back({columnIri("early0"), columnIri("p"), columnIri("thing0"), graph(0)});  // far from the others
  std::shuffle(quads.begin() + before, quads.end(), random);
  SmallStore store;
  store.load(quads);
  return store;
}

/// Compares the column with all quads of the store, for every existing id and some that do not exist.
void compareWithStore(const SmallStore& store, const std::string& predicate, const std::string& object,
                      bool without_history) {
  const QuadReader reader = store.reader();
  const TermId p = reader.idOf(columnIri(predicate)).value_or(~TermId{0});
  const TermId o = object.empty() ? kNoTerm : reader.idOf(columnIri(object)).value_or(~TermId{0});
  GraphFilter graphs;
  const auto history = reader.idOf(graph(1));
  if (without_history && history) graphs = {GraphFilter::Kind::AllBut, *history, {}, true};
  std::map<TermId, std::set<TermId>> expected;
  QuadCursor cursor = reader.scan({}, QuadOrder::Spog);
  std::size_t triples = 0;
  for (QuadIds quad; cursor.next(quad);) {
    if (quad.p == p && (o == kNoTerm || quad.o == o) && graphs.admits(quad.g))
      triples += expected[quad.s].insert(quad.o).second ? 1 : 0;
  }
  Guard guard;
  guard.start({});
  const SubjectColumn column(reader, {p, o}, graphs, guard);
  EXPECT_EQ(column.rows(), triples);
  EXPECT_LE(column.bytes(), triples * 10 + 64);
  std::vector<TermId> all;
  for (TermId id = 0; id < reader.termCount() + 5; ++id) all.push_back(id);
  all.insert(all.end(), {kFirstComputed, kFirstComputed + 7, ~TermId{0}});
  column.expect(all);
  for (const TermId subject : all) {
    std::vector<TermId> objects;
    for (const auto& row : column.find(subject)) {
      ASSERT_EQ(row.subject, subject);
      objects.push_back(row.object);
    }
    const auto& expected_objects = expected[subject];
    ASSERT_THAT(objects, ElementsAreArray(expected_objects.begin(), expected_objects.end())) << subject;
    for (TermId object = subject % 7; object < all.size(); object += 13) {
      ASSERT_EQ(column.find(subject, object).size(), expected_objects.count(object)) << subject << ' ' << object;
    }
  }
}

TEST(SubjectColumn, HoldsWhatTheStoreHoldsOfAPredicate) {
  for (std::uint32_t seed = 0; seed < 12; ++seed) {
    const SmallStore store = strewn(seed, seed % 3 * 400, 1 + seed * 70, 1 + seed % 5);
    for (const char* predicate : {"p", "is", "nowhere"}) {
      for (const char* object : {"", "thing", "thing0", "early", "nowhere"}) {
        compareWithStore(store, predicate, object, false);
        compareWithStore(store, predicate, object, true);
      }
    }
  }
}

TEST(SubjectColumn, IsMadeWhenLookupsHaveCostAsMuch) {
  const SmallStore store = strewn(3, 100, 9000, 7);  // some 60,000 quads
  const QuadReader reader = store.reader();
  const TermId p = *reader.idOf(columnIri("p"));
  Guard guard;
  guard.start({});
  EXPECT_EQ(keptColumn(reader, {p}, {}), keptColumn(store.reader(), {p}, {})) << "readers of a commit share it";
  const auto kept = keptColumn(reader, {p}, {});
  EXPECT_EQ(kept->after(1000, true, reader, {}, guard), nullptr);
  EXPECT_EQ(kept->after(500, false, reader, {}, guard), nullptr);
  const SubjectColumn* const made = kept->after(1, true, reader, {}, guard);
  ASSERT_NE(made, nullptr);
  EXPECT_EQ(kept->after(1, false, store.reader(), {}, guard), made);
  EXPECT_GE(kept->bytes() * 2, made->bytes());
  const TermId is = *reader.idOf(columnIri("is"));
  const auto unwanted = keptColumn(reader, {is}, {});
  EXPECT_EQ(unwanted->after(1023, false, reader, {}, guard), nullptr);
  EXPECT_NE(unwanted->after(5000, false, reader, {}, guard), nullptr);
  EXPECT_NE(keptColumn(reader, {is, *reader.idOf(columnIri("thing"))}, {}), unwanted)
      << "one object has a column of its own";
}

/// Names the same graphs one by one, so that patterns are looked up in the index.
QueryOptions graphByGraph() {
  QueryOptions options;
  for (const unsigned number : {0u, 2u, 3u}) options.default_graphs.push_back(graph(number).text);
  for (const unsigned number : {1u, 2u, 3u}) options.named_graphs.push_back(graph(number).text);
  return options;
}

void compareWithIndex(const SmallStore& store, const std::string& pattern) {
  const std::string text = "SELECT * { " + pattern + " }";
  const auto expected = store.rows(text, graphByGraph());
  ASSERT_FALSE(expected.empty()) << pattern;
  const auto first = store.ordered(text);
  EXPECT_EQ(first, store.ordered(text)) << pattern << ": made within the run or before, the order is the same";
  EXPECT_EQ(store.rows(text), expected) << pattern;
}

TEST(ByColumn, GivesWhatTheIndexGives) {
  SmallStore store = strewn(8, 0, 2500, 3);
  store.load({{columnIri("thing5"), columnIri("rare"), columnIri("thing6"), graph(0)},
              {columnIri("thing2000"), columnIri("rare"), columnIri("thing6"), graph(0)}});
  for (const char* pattern :
       {"?o :is :thing . ?o :p ?v", "?o :is :thing OPTIONAL { ?o :p ?v }",
        "?o :is :thing OPTIONAL { ?o :p ?v . ?v :p ?o }", "?o :is :thing FILTER EXISTS { ?o :p ?v . ?v :p ?w }",
        "?o :is :thing FILTER NOT EXISTS { ?o :p ?v . ?v :is :thing . ?v :p :thing7 }",
        "?o :is :thing OPTIONAL { ?o :p ?o BIND(1 AS ?itself) }", "?o :is ?c OPTIONAL { ?o :p ?c }",
        "?o :is :thing OPTIONAL { ?o :p ?v } OPTIONAL { ?v :rare ?w }",
        "?o :is :thing OPTIONAL { ?o :p ?v OPTIONAL { ?v :p :nothing . ?v :is ?c } }",
        "?o :is :thing FILTER EXISTS { ?o :p ?v . ?v :is :thing }", "?o :is :thing GRAPH ?g { ?o :p ?v }"}) {
    compareWithIndex(store, pattern);
  }
  const QuadReader reader = store.reader();
  const TermId p = *reader.idOf(columnIri("p")), is = *reader.idOf(columnIri("is")),
               thing = *reader.idOf(columnIri("thing"));
  const GraphFilter graphs{GraphFilter::Kind::AllBut, *reader.idOf(graph(1)), {}, true};
  EXPECT_TRUE(keptColumn(reader, {p}, graphs)->isMade());
  EXPECT_TRUE(keptColumn(reader, {is, thing}, graphs)->isMade());
  EXPECT_FALSE(keptColumn(reader, {is, thing}, {})->isMade()) << "not of these graphs";
}

TEST(ByColumn, IsMadeOnceForReadersInSeveralThreads) {
  const SmallStore store = strewn(9, 0, 3000, 4);
  const std::string text = "SELECT ?o ?v { ?o :is :thing . ?o :p ?v . ?v :is :thing }";
  const auto expected = store.rows(text, graphByGraph());
  std::array<std::vector<std::string>, 4> found;
  std::vector<std::thread> threads;
  for (auto& rows : found)
    threads.emplace_back([&] {
      for (int i = 0; i < 3; ++i) rows = store.rows(text);
    });
  for (std::thread& thread : threads) thread.join();
  for (const auto& rows : found) EXPECT_EQ(rows, expected);
}

TEST(ByColumn, FollowsCommitsAndDatasets) {
  SmallStore store = strewn(5, 0, 3000, 2);
  const std::string text = "SELECT (COUNT(?v) AS ?n) { ?o :is :thing OPTIONAL { ?o :p ?v } }";
  const auto count = [&](const QueryOptions& options) {
    return std::stoul(store.ask(text, options).table.at(0, 0)->text);
  };
  const std::size_t before = count({});
  store.load({{columnIri("thing1"), columnIri("p"), columnIri("new"), graph(0)},
              {columnIri("thing2"), columnIri("p"), columnIri("new"), graph(1)}});
  EXPECT_EQ(count({}), before + 1) << "history is not asked";
  EXPECT_EQ(count({}), before + 1);
  QueryOptions of_two;
  of_two.default_graphs = {"http://example.org/g2", "http://example.org/g3"};
  const std::string explicitly =
      "SELECT (COUNT(?v) AS ?n) { ?o :is :thing OPTIONAL { { SELECT DISTINCT ?o ?v { GRAPH ?g { ?o :p ?v } FILTER(?g "
      "IN (:g2, :g3)) } } } }";
  EXPECT_EQ(count(of_two), std::stoul(store.ask(explicitly).table.at(0, 0)->text));
}

TEST(ByColumn, CountsInTheBudgetsOfMemoryAndTime) {
  const SmallStore store = strewn(6, 0, 4000, 6);
  const std::string text = "SELECT (COUNT(*) AS ?n) { ?o :is :thing FILTER EXISTS { ?o :p ?v } }";
  QueryOptions narrow;
  narrow.budget.max_memory_bytes = 40'000;  // the column takes some 100,000
  EXPECT_EQ(store.ordered(text, narrow), store.ordered(text)) << "without a column where there is no room for it";
  EXPECT_EQ(store.ordered(text, narrow), store.ordered(text));
  const QuadReader reader = store.reader();
  Guard late;
  QueryBudget budget;
  budget.deadline = std::chrono::milliseconds(1);
  late.start(budget);
  while (true) {
    try {
      late.checkTime();
    } catch (const Error&) {
      break;
    }
  }
  EXPECT_THROW(SubjectColumn(reader, {*reader.idOf(columnIri("p"))}, {}, late), Error);
}

}  // namespace
}  // namespace cluxel::test
