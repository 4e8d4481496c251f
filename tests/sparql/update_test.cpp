// SPDX-License-Identifier: Apache-2.0
// Tests of updates: permitted graphs, atomicity and the order of operations.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cluxel/error.hpp"
#include "sparql/support/store_fixture.hpp"
#include "sparql/update_engine.hpp"

namespace cluxel::test {

using namespace rdf;
using namespace sparql;
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class Updates : public testing::Test {
 protected:
  Updates() { store_.load(":a :p 1 . :b :p 2 .", std::string(vocabulary::kGraphObserved)); }

  UpdateReport change(const std::string& text, const UpdateOptions& options = {}) {
    WriteTransaction transaction = store_.environment()->write();
    const UpdateReport report = runUpdate(transaction, kPrefixes + text, options);
    transaction.commit();
    return report;
  }
  std::vector<std::string> in(const std::string_view graph) {
    return store_.rows("SELECT ?s ?p ?o { GRAPH <" + std::string(graph) + "> { ?s ?p ?o } }");
  }
  SmallStore store_;
};

TEST_F(Updates, WriteTheOperatorGraphWhenNoneIsNamed) {
  change("INSERT DATA { :a :note \"checked\" }");
  EXPECT_THAT(in(vocabulary::kGraphOperator), ElementsAre(":a :note \"checked\""));
  change("DELETE DATA { :a :note \"checked\" }");
  EXPECT_THAT(in(vocabulary::kGraphOperator), IsEmpty());
}

/// A relative IRI in a map is written as RDF that no reader takes.
TEST_F(Updates, WriteNoRelativeIris) {
  EXPECT_EQ(change("INSERT { :a :see ?i } WHERE { BIND(IRI(\"rel\") AS ?i) }").inserted, 0U);
  EXPECT_EQ(change("BASE <http://b/c> INSERT { :a :see ?i } WHERE { BIND(IRI(\"rel\") AS ?i) }").inserted, 1U);
  EXPECT_THAT(in(vocabulary::kGraphOperator), ElementsAre(":a :see <http://b/rel>"));
}

TEST_F(Updates, OfOtherGraphsAreRefusedWithTheListOfOpenOnes) {
  try {
    change("INSERT DATA { GRAPH <https://w3id.org/cluxel/graph/observed> { :a :p 7 } }");
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("may not be written"));
    EXPECT_THAT(error.what(), HasSubstr("graph/operator"));
  }
  EXPECT_THROW(change("DELETE WHERE { GRAPH <https://w3id.org/cluxel/graph/observed> { ?s ?p ?o } }"), InputError);
  EXPECT_THROW(change("CLEAR ALL"), InputError);
  EXPECT_EQ(in(vocabulary::kGraphObserved).size(), 2u);
}

TEST_F(Updates, MayOpenMoreGraphs) {
  UpdateOptions options;
  options.writable_graphs = {"http://example.org/g"};
  change("INSERT { ?s :double ?d } WHERE { ?s :p ?v BIND(?v * 2 AS ?d) }", options);
  EXPECT_THAT(in("http://example.org/g"), ElementsAre(":a :double \"2\"^^integer", ":b :double \"4\"^^integer"));
}

TEST_F(Updates, ChangeNothingWhenALaterOperationFails) {
  EXPECT_THROW(change("INSERT DATA { :a :note 1 } ; INSERT DATA { GRAPH :closed { :a :p 7 } }"), InputError);
  EXPECT_THAT(in(vocabulary::kGraphOperator), IsEmpty());
}

TEST_F(Updates, SeeWhatEarlierOperationsWrote) {
  UpdateOptions all;
  all.any_graph_writable = true;
  change(
      "INSERT DATA { GRAPH :g { :x :n 1 } } ; WITH :g DELETE { ?s :n ?v } INSERT { ?s :n ?w } WHERE { ?s :n ?v BIND(?v "
      "+ 1 AS ?w) } ;"
      "INSERT { GRAPH :h { ?s :seen ?v } } WHERE { GRAPH :g { ?s :n ?v } }",
      all);
  EXPECT_THAT(in("http://example.org/g"), ElementsAre(":x :n \"2\"^^integer"));
  EXPECT_THAT(in("http://example.org/h"), ElementsAre(":x :seen \"2\"^^integer"));
  change("MOVE :h TO :g ; COPY :g TO :k ; DROP GRAPH :nothing ; ADD :k TO :g", all);
  EXPECT_THAT(in("http://example.org/g"), ElementsAre(":x :seen \"2\"^^integer"));
  EXPECT_THAT(in("http://example.org/h"), IsEmpty());
  EXPECT_THAT(in("http://example.org/k"), ElementsAre(":x :seen \"2\"^^integer"));
}

TEST_F(Updates, MakeFreshBlankNodesPerSolutionAndPerRequest) {
  change("INSERT { ?s :has [ :of ?v ] } WHERE { ?s :p ?v }");
  EXPECT_THAT(store_.rows("SELECT (COUNT(DISTINCT ?b) AS ?n) { ?s :has ?b }"), ElementsAre("\"2\"^^integer"));
  change("INSERT DATA { _:x :same 1 } ; INSERT DATA { _:y :same 2 }");
  change("INSERT DATA { _:x :same 3 }");
  EXPECT_THAT(store_.rows("SELECT (COUNT(DISTINCT ?b) AS ?n) { ?b :same ?v }"), ElementsAre("\"3\"^^integer"));
}

TEST_F(Updates, MakeFreshBlankNodesInEveryOperationOfARequest) {
  const std::string request =
      "INSERT { ?s :a ?b } WHERE { ?s :p 1 BIND(BNODE() AS ?b) } ; INSERT { ?s :c ?b } WHERE { ?s :p 1 BIND(bnode() AS "
      "?b) }";
  change(request);
  EXPECT_THAT(store_.rows("SELECT ?b { :a :a ?b ; :c ?b }"), IsEmpty());
  change(request);
  EXPECT_THAT(store_.rows("SELECT (COUNT(DISTINCT ?b) AS ?n) { ?s :a|:c ?b }"), ElementsAre("\"4\"^^integer"));
}

TEST_F(Updates, InTheSameOrderMakeTheSameStatements) {
  const std::vector<std::string> requests{"INSERT DATA { :a :has [ :of 1 ] }", "INSERT DATA { :a :has [ :of 1 ] }",
                                          "DELETE WHERE { ?s :of ?v }",
                                          "INSERT { ?s :is ?b } WHERE { ?s :p ?v BIND(BNODE() AS ?b) }"};
  std::vector<std::vector<std::string>> outcomes;
  for (int run = 0; run < 2; ++run) {
    if (run == 1) change("INSERT DATA { :z :has [] } ; DELETE WHERE { :z :has ?b }");  // leaves terms, but no statement
    for (const std::string& request : requests) change(request);
    outcomes.push_back(in(vocabulary::kGraphOperator));
    change("CLEAR GRAPH <" + std::string(vocabulary::kGraphOperator) + ">");
  }
  EXPECT_EQ(outcomes[0].size(), 4U);
  EXPECT_EQ(outcomes[0], outcomes[1]);
}

TEST_F(Updates, DeleteBeforeTheyInsert) {
  UpdateOptions all;
  all.any_graph_writable = true;
  change("INSERT DATA { :x :v 1 }", all);
  change("DELETE { :x :v ?v } INSERT { :x :v ?v } WHERE { :x :v ?v }", all);
  EXPECT_THAT(store_.rows("SELECT ?v { :x :v ?v }"), ElementsAre("\"1\"^^integer"));
}

TEST_F(Updates, CountWhatReallyChanged) {
  const auto counts = [this](const std::string& text) {
    const UpdateReport report = change(text);
    return std::pair(report.inserted, report.deleted);
  };
  using Counts = std::pair<std::uint64_t, std::uint64_t>;
  EXPECT_EQ(counts("INSERT DATA { :a :note 1, 2 . :a :note 1 }"), Counts(2, 0));
  EXPECT_EQ(counts("INSERT DATA { :a :note 1, 3 }"), Counts(1, 0));
  EXPECT_EQ(counts("DELETE DATA { :a :note 3, 4 }"), Counts(0, 1));
  EXPECT_EQ(counts("DELETE { ?s :note ?v } INSERT { ?s :note ?v } WHERE { ?s :note ?v }"), Counts(0, 0));
  EXPECT_EQ(counts("DELETE { ?s :note 1, 2 } INSERT { ?s :note 2, 5 } WHERE { ?s :note ?v }"), Counts(1, 1));
  EXPECT_EQ(counts("INSERT DATA { :a :note 6 } ; DELETE DATA { :a :note 6 }"), Counts(1, 1));
  EXPECT_EQ(counts("CLEAR DEFAULT"), Counts(0, 2));
}

TEST_F(Updates, CountTheNetChangeOfATransfer) {
  UpdateOptions all;
  all.any_graph_writable = true;
  change("INSERT DATA { GRAPH :g { :x :n 1, 2 } GRAPH :h { :x :n 2, 3 } }", all);
  const UpdateReport copied = change("COPY :g TO :h", all);
  EXPECT_EQ(copied.inserted, 1U);
  EXPECT_EQ(copied.deleted, 1U);
  const UpdateReport moved = change("MOVE :g TO :h", all);
  EXPECT_EQ(moved.inserted, 0U);
  EXPECT_EQ(moved.deleted, 2U);
  EXPECT_THAT(in("http://example.org/h"), ElementsAre(":x :n \"1\"^^integer", ":x :n \"2\"^^integer"));
}

TEST_F(Updates, HeedTheirBudgetWhileTheyTellOfRemovals) {
  std::string quads;
  for (int i = 0; i < 10'000; ++i) quads += ":a :p " + std::to_string(i) + " . ";
  std::size_t calls = 0, told = 0, at_first = 0, at_last = 0;
  UpdateOptions options;
  options.query.budget.poll = [&calls] { ++calls; };
  options.on_removal = [&](const Quad&) {
    if (++told == 1) at_first = calls;
    at_last = calls;
  };
  const std::string graph(vocabulary::kGraphOperator);
  change("DELETE DATA { GRAPH <" + graph + "> { " + quads + " } }", options);
  EXPECT_EQ(told, 10'000U);
  EXPECT_GT(at_last, at_first);
}

TEST_F(Updates, RefuseToDeleteWhatOnlyABuildWrites) {
  store_.load(":a :kind :Plant .", std::string(vocabulary::kGraphInferred));
  change("INSERT DATA { :a :note 1 }");
  for (const char* request :
       {"DELETE WHERE { ?s :p ?v }", "DELETE DATA { :a :p 1 }", "DELETE WHERE { :a ?p ?o }",
        "DELETE DATA { :a :kind :Plant }", "DELETE { ?s :p ?v } INSERT { ?s :p 7 } WHERE { ?s :p ?v }",
        "INSERT DATA { :a :note 9 } ; DELETE { ?s :p ?v } WHERE { ?s :p ?v ; :note ?n }"}) {
    try {
      change(request);
      FAIL() << request;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("may not write")) << request;
      EXPECT_THAT(error.what(), HasSubstr("http://example.org/a> <http://example.org/")) << request;
      EXPECT_THAT(error.what(), HasSubstr("insert what holds instead")) << request;
    }
  }
  EXPECT_THAT(in(vocabulary::kGraphOperator), ElementsAre(":a :note \"1\"^^integer")) << "nothing was changed";
  change("INSERT { ?s :p 7 } WHERE { ?s :p 1 }");
  EXPECT_EQ(change("WITH <https://w3id.org/cluxel/graph/operator> DELETE { :a ?p ?o } WHERE { :a ?p ?o }").deleted, 2U);
  EXPECT_EQ(change("DELETE WHERE { GRAPH <https://w3id.org/cluxel/graph/operator> { :a ?p ?o } }").deleted, 0U);
  EXPECT_EQ(in(vocabulary::kGraphObserved).size(), 2U);
}

TEST_F(Updates, LoadOnlyThroughTheCallersDoor) {
  EXPECT_THROW(change("LOAD <file:///etc/passwd>"), InputError);
  const std::vector<Diagnostic> warnings = change("LOAD SILENT <http://elsewhere/>").warnings;
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_THAT(warnings.front().message, HasSubstr("LOAD SILENT <http://elsewhere/> loads nothing: no file is named"));
  UpdateOptions options;
  options.load = [](const std::string&) -> std::vector<Quad> {
    throw Error(ErrorKind::FaultyInput, "x.ttl: no such file");
  };
  EXPECT_THROW(change("LOAD <http://elsewhere/>", options), Error);
  EXPECT_THAT(change("LOAD SILENT <http://elsewhere/>", options).warnings.front().message,
              HasSubstr("loads nothing: x.ttl: no such file"));
  options.load = [](const std::string& iri) {
    return std::vector<Quad>{{Term::iri(iri), Term::iri("http://example.org/p"), Term::integer(1), {}}};
  };
  change("LOAD <http://example.org/doc>", options);
  EXPECT_THAT(in(vocabulary::kGraphOperator), ElementsAre(":doc :p \"1\"^^integer"));
}

}  // namespace
}  // namespace cluxel::test
