// SPDX-License-Identifier: Apache-2.0
// Tests of the default graph, named graphs, FROM, and GRAPH with variables.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rdf/io/rdf_io.hpp"
#include "rdf/vocabulary.hpp"
#include "sparql/support/store_fixture.hpp"

namespace cluxel::test {

using namespace rdf;
using namespace sparql;
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class Datasets : public testing::Test {
 protected:
  Datasets() {
    store_.load(":a :p 1 . :b :p 2 .", "http://example.org/g1");
    store_.load(":a :p 1 . :c :p 3 .", "http://example.org/g2");
    store_.load(":h :p 9 .", std::string(vocabulary::kGraphHistory));
    store_.load(":d :p 4 .", "");
  }
  SmallStore store_;
};

TEST_F(Datasets, TheDefaultGraphIsTheUnionOfAllButHistoryWithoutRepetitions) {
  EXPECT_THAT(store_.rows("SELECT ?s { ?s :p ?v }"), ElementsAre(":a", ":b", ":c", ":d"));
  EXPECT_THAT(store_.rows("SELECT ?s { ?s ?p ?v }"), ElementsAre(":a", ":b", ":c", ":d"));
  EXPECT_THAT(store_.rows("SELECT (COUNT(*) AS ?n) { :a :p 1 }"), ElementsAre("\"1\"^^integer"));
  EXPECT_THAT(store_.rows("SELECT ?v { VALUES ?s { :a :b :h } ?s :p ?v }"),
              ElementsAre("\"1\"^^integer", "\"2\"^^integer"));
}

TEST_F(Datasets, AStrictDefaultGraphIsTheUnnamedOne) {
  QueryOptions strict;
  strict.default_graph = DefaultGraph::Unnamed;
  EXPECT_THAT(store_.rows("SELECT ?s { ?s :p ?v }", strict), ElementsAre(":d"));
}

TEST_F(Datasets, GraphRunsOverTheNamedGraphs) {
  EXPECT_THAT(store_.rows("SELECT ?g { GRAPH ?g { :a :p 1 } }"), ElementsAre(":g1", ":g2"));
  EXPECT_THAT(store_.rows("SELECT ?g ?s { ?s :p 1 GRAPH ?g { ?s :p ?v } }"), ElementsAre(":g1 :a", ":g2 :a"));
  EXPECT_THAT(store_.rows("SELECT (COUNT(*) AS ?n) { GRAPH ?g {} }"), ElementsAre("\"3\"^^integer"));
  EXPECT_THAT(store_.rows("SELECT (COUNT(DISTINCT ?g) AS ?n) { ?s :p 1 OPTIONAL { ?s :q ?w } GRAPH ?g {} }"),
              ElementsAre("\"3\"^^integer"));
  EXPECT_THAT(store_.rows("SELECT ?x { GRAPH :g1 { BIND(1 AS ?x) } }"), ElementsAre("\"1\"^^integer"));
  EXPECT_THAT(store_.rows("SELECT ?x { GRAPH :nowhere { BIND(1 AS ?x) } }"), IsEmpty());
}

TEST_F(Datasets, PatternsWithinAGraphStayInThatGraph) {
  EXPECT_THAT(store_.rows("SELECT ?g ?s ?t { GRAPH ?g { ?s :p 1 . ?t :p ?v FILTER(?v > 1) } }"),
              ElementsAre(":g1 :a :b", ":g2 :a :c"));
  EXPECT_THAT(
      store_.rows("SELECT ?g ?n { GRAPH ?g { { SELECT (COUNT(*) AS ?n) { ?s :p ?v } } } FILTER(?g IN (:g1, :g2)) }"),
      ElementsAre(":g1 \"2\"^^integer", ":g2 \"2\"^^integer"));
  EXPECT_THAT(store_.rows("SELECT ?g ?s { GRAPH ?g { ?s :p ?v FILTER NOT EXISTS { ?t :p 2 } } "
                          "FILTER(STRSTARTS(STR(?g), \"http://example\")) }"),
              ElementsAre(":g2 :a", ":g2 :c"));
}

TEST_F(Datasets, FromBuildsTheDatasetFromTheStore) {
  EXPECT_THAT(store_.rows("SELECT ?s FROM :g1 FROM :g2 { ?s :p ?v }"), ElementsAre(":a", ":b", ":c"));
  EXPECT_THAT(store_.rows("SELECT ?s FROM NAMED :g2 { ?s :p ?v }"), IsEmpty());
  EXPECT_THAT(store_.rows("SELECT ?g ?s FROM :g1 FROM NAMED :g2 { GRAPH ?g { ?s :p 3 } ?t :p 2 }"),
              ElementsAre(":g2 :c"));
  EXPECT_THAT(store_.rows("SELECT ?s FROM <http://elsewhere/x.ttl> { ?s :p ?v }"), IsEmpty()) << "nothing is fetched";
}

TEST_F(Datasets, TheProtocolsGraphsReplaceFrom) {
  QueryOptions options;
  options.default_graphs = {"http://example.org/g2"};
  EXPECT_THAT(store_.rows("SELECT ?s FROM :g1 { ?s :p ?v }", options), ElementsAre(":a", ":c"));
}

TEST(Iris, ThatAQueryShowsCanBeAskedFor) {
  for (const RdfFormat format : {RdfFormat::NTriples, RdfFormat::NQuads, RdfFormat::Turtle, RdfFormat::TriG}) {
    const std::string iris[] = {"http://x/a/../b", "http://x/./c", "http://x/d/..", "urn:x:../e", "http://x//f/."};
    std::string text;
    for (const std::string& iri : iris) text += "<" + iri + "> <http://x/p> <" + iri + "> .\n";
    std::vector<Quad> quads;
    parseRdf({text, "dots", format, "http://base/", Term::iri("")}, [&](const Quad& quad) { quads.push_back(quad); });
    SmallStore store;
    store.load(quads);
    const QueryResult shown = store.ask("SELECT ?s { ?s ?p ?o }");
    ASSERT_EQ(shown.table.row_count, std::size(iris));
    for (std::size_t row = 0; row < shown.table.row_count; ++row) {
      const std::string iri = toNTriples(*shown.table.at(row, 0));
      EXPECT_EQ(store.rows("SELECT ?o { " + iri + " ?p ?o }").size(), 1U) << iri;
      EXPECT_EQ(store.rows("SELECT ?s { ?s ?p ?o FILTER(?o = " + iri + ") }").size(), 1U) << iri;
    }
  }
}

}  // namespace
}  // namespace cluxel::test
