// SPDX-License-Identifier: Apache-2.0
// Tests of budgets, refusals, plans, explanations of empty results, and warnings about unknown names.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>

#include "cluxel/error.hpp"
#include "sparql/support/store_fixture.hpp"

namespace cluxel::test {

using namespace rdf;
using namespace sparql;
namespace {

using testing::HasSubstr;

SmallStore chain(int length) {
  SmallStore store;
  std::vector<Quad> quads;
  for (int i = 0; i < length; ++i) {
    quads.push_back({Term::iri("http://example.org/n" + std::to_string(i)), Term::iri("http://example.org/next"),
                     Term::iri("http://example.org/n" + std::to_string(i + 1)), Term::iri("")});
  }
  store.load(quads);
  return store;
}

/// A sink that records whether anything was written to it.
class WatchingSink : public ResultSink {
 public:
  bool touched = false;
  void beginSolutions(std::span<const std::string>, const TermLookup&) override { touched = true; }
  void rows(std::span<const ResultId>, std::size_t) override { touched = true; }
  void boolean(bool) override { touched = true; }
  void beginGraph() override { touched = true; }
  void triple(const TermView&, const TermView&, const TermView&) override { touched = true; }
  void end() override { touched = true; }
};

void expectRefused(const SmallStore& store, const std::string& query, const QueryOptions& options) {
  WatchingSink sink;
  const QuadReader reader = store.reader();
  try {
    runQuery(reader, kPrefixes + query, options, sink);
    FAIL() << "no error for " << query;
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::BudgetExceeded) << error.what();
  }
  EXPECT_FALSE(sink.touched) << "a partial answer was given";
}

TEST(Guard, TellsOfIdsThatADamagedIndexMadeUp) {
  const SmallStore store(":s :p 1 .");
  {
    WriteTransaction transaction = store.environment()->write();
    QuadWriter writer(transaction);
    const TermId s = writer.intern(Term::iri("http://example.org/s")),
                 p = writer.intern(Term::iri("http://example.org/p"));
    writer.add(QuadIds{s, p, 0x9000'0000U, kNoTerm});
    writer.flush();
    transaction.commit();
  }
  for (const char* query :
       {"SELECT ?o { ?s ?p ?o }", "SELECT ?l { ?s ?p ?o BIND(STRLEN(STR(?o)) + 1 AS ?l) FILTER(?l > 1) }",
        "SELECT ?o { ?s ?p ?o } ORDER BY ?o", "CONSTRUCT { ?s ?p ?o } WHERE { ?s ?p ?o }"}) {
    try {
      store.ask(query);
      FAIL() << query;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::StoreUnavailable) << query;
      EXPECT_THAT(error.what(), HasSubstr("damaged")) << query;
    }
  }
}

TEST(Guard, EndsAnExplodingJoinByItsRows) {
  const SmallStore store = chain(300);
  QueryOptions options;
  options.budget.max_work_rows = 100'000;
  expectRefused(store, "SELECT (COUNT(*) AS ?n) { ?a :next ?b . ?c :next ?d . ?e :next ?f . ?g :next ?h }", options);
}

TEST(Guard, EndsByItsDeadline) {
  const SmallStore store = chain(300);
  QueryOptions options;
  options.budget.deadline = std::chrono::milliseconds(30);
  expectRefused(store,
                "SELECT (COUNT(*) AS ?n) { ?a :next ?b . ?c :next ?d . ?e :next ?f . ?g :next ?h . ?i :next ?j }",
                options);
  expectRefused(
      store,
      "SELECT (COUNT(*) AS ?n) { ?a ((:next|^:next)/(:next|^:next))* ?b . ?c (:next|^:next)* ?d . ?e :next* ?f }",
      options);
}

TEST(Guard, EndsByMemoryInJoinsSortsGroupsAndAnswers) {
  const SmallStore store = chain(3000);
  QueryOptions options;
  options.budget.max_memory_bytes = 20'000;
  expectRefused(store, "SELECT * { ?a :next ?b }", options);
  expectRefused(store, "SELECT (COUNT(*) AS ?n) { { SELECT * { ?a :next ?b } ORDER BY ?b LIMIT 100000 } }", options);
  expectRefused(store, "SELECT (COUNT(*) AS ?n) { { SELECT ?a (COUNT(*) AS ?k) { ?a :next ?b } GROUP BY ?a } }",
                options);
  expectRefused(store, "SELECT (COUNT(*) AS ?n) { { SELECT DISTINCT ?a ?b { ?a :next ?b } } }", options);
  expectRefused(store, "CONSTRUCT WHERE { ?a :next ?b }", options);
}

TEST(Guard, CountsTermsThatAreComputedAnywhereAndRowsOfCountDistinct) {
  const SmallStore store = chain(3000);
  QueryOptions options;
  options.budget.max_memory_bytes = 200'000;
  const std::string longer = "CONCAT(STR(?a), \"" + std::string(200, 'x') + "\")";
  expectRefused(store, "SELECT ?a { ?a :next ?b } ORDER BY " + longer + " LIMIT 1", options);
  expectRefused(store, "SELECT (COUNT(*) AS ?n) { ?a :next ?b FILTER(STRDT(" + longer + ", :type) != 1) }", options);
  options.budget.max_memory_bytes = 20'000;
  expectRefused(store, "SELECT (COUNT(DISTINCT *) AS ?n) { ?a :next ?b }", options);
}

/// Each inner SELECT needs little memory and releases it.
TEST(Guard, DoesNotCountWhatIsGivenBack) {
  const SmallStore store = chain(3000);
  QueryOptions options;
  options.budget.max_memory_bytes = 200'000;
  for (const char* inner :
       {"SELECT DISTINCT ?a { ?a :next ?c } LIMIT 1",
        "SELECT ?a (COUNT(DISTINCT ?c) AS ?n) { ?a :next ?c } GROUP BY ?a HAVING(COUNT(*) = 1)",
        "SELECT ?a { ?a :next ?c } ORDER BY ?c LIMIT 1",
        "SELECT ?a { ?a :next ?c OPTIONAL { ?a :none ?d } { ?a :next ?e OPTIONAL { ?e :none ?d } } }"}) {
    EXPECT_EQ(
        store.rows(std::string("SELECT (COUNT(*) AS ?n) { ?a :next ?b FILTER EXISTS { ") + inner + " } }", options)
            .front(),
        "\"3000\"^^integer")
        << inner;
  }
  const QuadReader reader = store.reader();
  PreparedQuery again(reader, kPrefixes + "SELECT (COUNT(*) AS ?n) { { SELECT DISTINCT ?a ?b { ?a :next ?b } } }",
                      options);
  for (int run = 0; run < 5; ++run) EXPECT_EQ(again.evaluate().table.row_count, 1u) << run;
}

TEST(Guard, CountsCandidatesThatDoNotAgree) {
  const SmallStore store = chain(3000);
  QueryOptions options;
  options.budget.max_work_rows = 1'000'000;
  expectRefused(store,
                "SELECT (COUNT(*) AS ?n) { { ?a :next ?b BIND(STR(?a) AS ?k) } { ?c :next ?d BIND(CONCAT(STR(?c), "
                "\"x\") AS ?k) } }",
                options);
}

/// The first pair of a path is returned before all pairs are computed.
TEST(Guard, PathsBetweenVariablesStopEarly) {
  const SmallStore store = chain(1500);
  QueryOptions options;
  options.budget.max_work_rows = 50'000;
  EXPECT_EQ(store.rows("SELECT * { ?a :next+ ?b } LIMIT 5", options).size(), 5u);
  options.budget = {};
  options.budget.max_memory_bytes = 1'000'000;
  EXPECT_EQ(store.rows("SELECT (COUNT(*) AS ?n) { ?a :next+ ?b }", options).front(), "\"1125750\"^^integer");
}

TEST(Guard, EndsByRowsOfTheAnswerAndLetsSmallerOnesPass) {
  const SmallStore store = chain(100);
  QueryOptions options;
  options.budget.max_rows = 50;
  expectRefused(store, "SELECT * { ?a :next ?b }", options);
  EXPECT_EQ(store.rows("SELECT * { ?a :next ?b } LIMIT 50", options).size(), 50u);
}

TEST(Guard, EndsCostlyRegularExpressions) {
  const SmallStore store(":a :p \"aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaab\" .");
  expectRefused(store, "SELECT * { ?s :p ?v FILTER(REGEX(?v, \"^(a+)+$\")) }", {});
}

/// A long text needs much stack, but few steps.
TEST(Guard, LetsPlainRegularExpressionsReadLongTexts) {
  std::string text;
  for (int i = 0; i < 50'000; ++i) text += "ab";
  const SmallStore store(":a :p \"" + text + "\" .");
  EXPECT_EQ(store.rows("SELECT (REGEX(?v, \"^(a|b)*$\") AS ?yes) { ?s :p ?v }").front(), "\"true\"^^boolean");
}

TEST(Guard, EndsNumbersThatGrowWithoutEnd) {
  const SmallStore store;
  std::string product = "10";
  for (int i = 0; i < 12; ++i) product = "(" + product + " * " + product + ")";
  EXPECT_EQ(store.value("STRLEN(STR(" + product + "))"), "-") << "an overflow is a type error";
}

TEST(Guard, RefusesDeepNesting) {
  const SmallStore store;
  std::string deep = "1";
  for (int i = 0; i < 5000; ++i) deep = "(" + deep + ")";
  EXPECT_THROW(store.value(deep), InputError);
  std::string groups = "?s ?p ?o";
  for (int i = 0; i < 5000; ++i) groups = "{" + groups + "}";
  EXPECT_THROW(store.ask("SELECT * {" + groups + "}"), InputError);
}

/// If planning took exponential time, the test would exceed its time limit.
TEST(Guard, RefusesQueriesOfThousandsOfPartsAndPlansThoseBelow) {
  const SmallStore store = chain(10);
  const auto repeated = [](const std::string& part, int count) {
    std::string text;
    for (int i = 0; i < count; ++i) {
      for (const char c : part) text += c == '#' ? std::to_string(i) : std::string(1, c);
    }
    return text;
  };
  for (const char* part :
       {"?s# :next ?s#x . ", "OPTIONAL { ?s :next ?o# } ", "BIND(# AS ?b#) ", "FILTER(?s != #) ", "MINUS { ?s :x # } ",
        "{ ?s :next ?o# } UNION ", "VALUES ?v# { # } ", "{ SELECT ?s { ?s :next ?o } } ", "GRAPH ?g# { } "}) {
    const std::string end = std::string(part).ends_with("UNION ") ? "{ } }" : "}";
    EXPECT_THROW(store.ask("ASK { " + repeated(part, 10'000) + end), InputError) << part;
    QueryOptions options;
    options.budget.deadline = std::chrono::seconds(1);
    try {
      store.ask("ASK { ?s :next ?o . " + repeated(part, 400) + end, options);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::BudgetExceeded) << part << ": " << error.what();
    }
  }
}

TEST(Guard, EndsTextsThatGrowWithoutEnd) {
  const SmallStore store;
  std::string doubled = "BIND(\"abcdefgh\" AS ?t0) ";
  for (int i = 0; i < 60; ++i)
    doubled +=
        "BIND(CONCAT(?t" + std::to_string(i) + ", ?t" + std::to_string(i) + ") AS ?t" + std::to_string(i + 1) + ") ";
  EXPECT_THROW(store.ask("SELECT (STRLEN(?t60) AS ?n) { " + doubled + "}"), Error);
  std::string many(1000, 'a'), replaced = "\"" + many + "\"";
  for (int i = 0; i < 8; ++i) replaced = "REPLACE(" + replaced + ", \"a\", \"" + many + "\")";
  EXPECT_THROW(store.ask("SELECT (STRLEN(" + replaced + ") AS ?n) { }"), Error);
}

TEST(Explain, ShowsEstimatedAndActualRows) {
  const SmallStore store = chain(10);
  const QuadReader reader = store.reader();
  const std::string plan =
      explainQuery(reader, kPrefixes + "SELECT ?a { ?a :next ?b . ?b :next ?c FILTER(?a != ?c) } ORDER BY ?a LIMIT 3");
  EXPECT_THAT(plan, HasSubstr("first 3 by ?a"));
  EXPECT_THAT(plan, HasSubstr("<http://example.org/next>"));
  EXPECT_THAT(plan, HasSubstr("estimated 10, actual 10"));
  EXPECT_THAT(plan, HasSubstr("actual 9"));
}

TEST(WhyEmpty, NamesThePatternThatHasNoMatch) {
  const SmallStore store(":a a :Tree ; :height 3 . :b a :Sign .");
  const QuadReader reader = store.reader();
  const auto why = [&](const std::string& text) { return whyEmpty(reader, kPrefixes + text); };
  EXPECT_EQ(why("SELECT * { ?x a :Tree }"), "");
  EXPECT_THAT(why("SELECT * { ?x a :Tree . ?x :hieght ?h }"), HasSubstr("hieght"));
  EXPECT_THAT(why("SELECT * { ?x a :Sign . ?x :height ?h }"), HasSubstr("none is left when"));
  EXPECT_THAT(why("SELECT * { ?x a :Tree ; :height ?h FILTER(?h > 5) }"), HasSubstr("FILTER  (?h > 5)"));
  EXPECT_THAT(why("SELECT * { ?x a :Tree MINUS { ?x :height ?h } }"), HasSubstr("MINUS"));
}

TEST(WhyEmpty, KnowsTheParameters) {
  const SmallStore store(":a :height 3 . :b :height 4 .");
  const QuadReader reader = store.reader();
  const std::string text = kPrefixes + "SELECT * { ?x :height ?h FILTER(?h > ?limit) }";
  EXPECT_EQ(whyEmpty(reader, text, {}, {{"limit", Term::integer(3)}}), "");
  EXPECT_THAT(whyEmpty(reader, text, {}, {{"limit", Term::integer(9)}}), HasSubstr("FILTER  (?h > ?limit)"));
}

TEST(CheckQuery, NamesWholeIrisWhereTheNamespaceIsWrong) {
  const SmallStore store(":a a :StreetSign ; :height 3 .");
  const QuadReader reader = store.reader();
  const auto hint = [&](const std::string& text) {
    const auto found = checkQuery(reader, kPrefixes + text);
    return found.empty() ? "no warning" : found[0].hint;
  };
  EXPECT_EQ(hint("SELECT * { ?x <http://elsewhere.net/height> ?h }"), "did you mean <http://example.org/height>?");
  EXPECT_EQ(hint("SELECT * { ?x <https://example.org/height> ?h }"), "did you mean <http://example.org/height>?");
  EXPECT_EQ(hint("SELECT * { ?x <urn:nothing:alike> ?h }"), "");
  EXPECT_EQ(hint("SELECT * { ?x :zzzzzz ?h }"), "known: height");
}

TEST(CheckQuery, TellsThatFromReadsGraphsOfTheStoreOnly) {
  SmallStore store(":a :height 3 .");
  store.load(":a :height 4 .", "http://example.org/g");
  const auto found = checkQuery(store.reader(), kPrefixes + "SELECT *\nFROM <http://example.org/gg> { ?s ?p ?o }");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_THAT(found[0].message, HasSubstr("graph <http://example.org/gg>"));
  EXPECT_EQ(found[0].hint, "did you mean 'g'?");
}

TEST(CheckQuery, SuggestsNamesThatTheStoreKnows) {
  const SmallStore store(":a a :StreetSign ; :height 3 .");
  const QuadReader reader = store.reader();
  const auto found = checkQuery(reader, kPrefixes + "SELECT * {\n ?x a :StretSign ;\n :hieght ?h }");
  ASSERT_EQ(found.size(), 2u);
  EXPECT_THAT(found[0].message, HasSubstr("class <http://example.org/StretSign>"));
  EXPECT_THAT(found[0].hint, HasSubstr("StreetSign"));
  EXPECT_THAT(found[1].message, HasSubstr("property"));
  EXPECT_THAT(found[1].hint, HasSubstr("height"));
  EXPECT_EQ(found[1].severity, Severity::Warning);
  for (const auto& [warning, name] : {std::pair(found[0], ":StretSign"), std::pair(found[1], ":hieght")})
    EXPECT_EQ(warning.location.column, warning.source_line.find(name) + 1) << "the caret stands below " << name;
  const auto in_path = checkQuery(reader, kPrefixes + "SELECT * { ?x a/^(:height|:weight)* ?y }");
  ASSERT_EQ(in_path.size(), 1u);
  EXPECT_EQ(in_path[0].location.column, in_path[0].source_line.find(":weight") + 1);
  EXPECT_TRUE(checkQuery(reader, kPrefixes + "SELECT * { ?x a :StreetSign ; :height ?h }").empty());
}

}  // namespace
}  // namespace cluxel::test
