// SPDX-License-Identifier: Apache-2.0
// CONSTRUCT rules: what they derive, whose word each fact is, and which rules are refused.
#include "mapping/sparql_rules.hpp"

#include <gtest/gtest.h>

#include "cluxel/base/diagnostic.hpp"
#include "cluxel/base/file_bytes.hpp"
#include "cluxel/knowledge/quad_store.hpp"
#include "cluxel/knowledge/vocabulary.hpp"
#include "cluxel/sparql/query_engine.hpp"

namespace cluxel {
namespace {

const std::string kPrefixes =
    "PREFIX clx: <https://w3id.org/cluxel/ontology#> PREFIX rdf: <http://www.w3.org/1999/02/22-rdf-syntax-ns#> ";

NamedText shippedRule(const std::string& name) {
  const std::string file = std::string(CLUXEL_SOURCE_DIR) + "/rules/" + name;
  return {file, readFile(file)};
}

std::vector<NamedText> shippedRules() { return {shippedRule("10_tree_rows.rq"), shippedRule("20_avenues.rq")}; }

Term tree(int number) { return Term::iri("https://example.org/tree/" + std::to_string(number)); }

/// A store of trees and what is near what, over which rules run.
class SparqlRules : public testing::Test {
 protected:
  void add(const Term& subject, const std::string& property, const Term& object) {
    QuadWriter writer(transaction);
    writer.add(Quad{subject, Term::iri(property), object, Term::iri(vocabulary::kGraphObserved)});
    writer.flush();
  }
  void addTree(int number) { add(tree(number), vocabulary::rdf("type"), Term::iri(vocabulary::clx("Tree"))); }
  void addNear(const Term& a, const Term& b) {
    add(a, vocabulary::clx("near"), b);
    add(b, vocabulary::clx("near"), a);
  }
  /// Trees first..last, each near the next.
  void addRow(int first, int last) {
    for (int i = first; i <= last; ++i) addTree(i);
    for (int i = first; i < last; ++i) addNear(tree(i), tree(i + 1));
  }
  std::size_t countOf(const std::string& pattern) {
    const QuadReader reader{static_cast<const ReadTransaction&>(transaction)};
    return evaluateQuery(reader, kPrefixes + "SELECT * WHERE { " + pattern + " }").table.row_count;
  }
  bool ask(const std::string& pattern) {
    const QuadReader reader{static_cast<const ReadTransaction&>(transaction)};
    return PreparedQuery(reader, kPrefixes + "ASK { " + pattern + " }").ask();
  }
  std::size_t inferred() {
    const QuadReader reader{static_cast<const ReadTransaction&>(transaction)};
    const auto graph = reader.idOf(Term::iri(vocabulary::kGraphInferred));
    if (!graph) return 0;
    QuadPattern pattern;
    pattern.g = graph;
    return reader.count(pattern);
  }

  std::shared_ptr<Environment> environment = Environment::temporary();
  WriteTransaction transaction = environment->write();
};

TEST_F(SparqlRules, FiveTreesInARowAreOneAvenueOfFive) {
  addRow(1, 5);
  runSparqlRules(transaction, shippedRules());
  EXPECT_EQ(countOf("?a clx:neighbourTree ?b"), 8U);
  EXPECT_EQ(countOf("?avenue a clx:Avenue"), 1U);
  EXPECT_EQ(countOf("?avenue a clx:Avenue ; clx:hasMember ?tree . ?tree a clx:Tree"), 5U);
}

TEST_F(SparqlRules, ThreeTreesAreNoAvenue) {
  addRow(1, 3);
  runSparqlRules(transaction, shippedRules());
  EXPECT_EQ(countOf("?a clx:neighbourTree ?b"), 4U);
  EXPECT_EQ(countOf("?avenue a clx:Avenue"), 0U);
}

TEST_F(SparqlRules, TwoRowsAreTwoAvenuesAndALampBetweenThemJoinsNothing) {
  addRow(1, 4);
  addRow(11, 16);
  const Term lamp = Term::iri("https://example.org/lamp");
  add(lamp, vocabulary::rdf("type"), Term::iri(vocabulary::clx("StreetLamp")));
  addNear(tree(4), lamp);
  addNear(tree(11), lamp);
  runSparqlRules(transaction, shippedRules());
  EXPECT_EQ(countOf("?avenue a clx:Avenue"), 2U);
  EXPECT_EQ(countOf("?avenue clx:hasMember ?tree"), 10U);
  EXPECT_FALSE(ask("<https://example.org/lamp> clx:neighbourTree ?x"));
  EXPECT_FALSE(ask("?a clx:hasMember <https://example.org/tree/4>, <https://example.org/tree/11>"));
}

TEST_F(SparqlRules, EveryDerivedFactHasADerivationThatNamesItsRule) {
  addRow(1, 4);
  runSparqlRules(transaction, shippedRules());
  const std::string says = "?d a clx:Derivation ; rdf:subject ?s ; rdf:predicate ?p ; rdf:object ?o ; clx:rule ";
  const std::string holds = " ?s ?p ?o";
  EXPECT_EQ(countOf(says + "\"10_tree_rows.rq\" ." + holds + " FILTER(?p = clx:neighbourTree)"), 6U);
  EXPECT_EQ(countOf(says + "\"20_avenues.rq\" ." + holds), 5U);
  EXPECT_EQ(countOf("?d a clx:Derivation"), 11U);
  EXPECT_EQ(inferred(), 11U + 11U * 5U) << "each fact stands beside the five statements of its derivation";
}

TEST_F(SparqlRules, RunningAgainDerivesNothingNew) {
  addRow(1, 5);
  runSparqlRules(transaction, shippedRules());
  const std::size_t once = inferred();
  runSparqlRules(transaction, shippedRules());
  EXPECT_EQ(inferred(), once);
}

TEST_F(SparqlRules, AKnownFactIsNotDerivedAgain) {
  addRow(1, 2);
  add(tree(1), vocabulary::clx("neighbourTree"), tree(2));
  runSparqlRules(transaction, {shippedRule("10_tree_rows.rq")});
  EXPECT_EQ(countOf("?d a clx:Derivation"), 1U);
}

TEST_F(SparqlRules, ARecursiveRuleRunsToItsFixpoint) {
  addRow(1, 9);
  runSparqlRules(transaction, {{"reach.rq", kPrefixes + "CONSTRUCT { ?a clx:reaches ?c } WHERE { { ?a clx:near ?c } UNION "
                                                        "{ ?a clx:reaches ?b . ?b clx:near ?c } FILTER(?a != ?c) }"}});
  EXPECT_EQ(countOf("?a clx:reaches ?b"), 72U);
}

void expectRefusal(const std::string& text, const std::string& word) {
  try {
    checkSparqlRules({{"my-rule.rq", kPrefixes + text}});
    FAIL() << "accepted: " << text;
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("my-rule.rq"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
  }
}

TEST(SparqlRulesCheck, RefusesWhatDiffersFromRunToRun) {
  expectRefusal("CONSTRUCT { ?t clx:confidence ?r } WHERE { ?t a clx:Tree BIND(RAND() AS ?r) }", "RAND");
  expectRefusal("CONSTRUCT { ?n a clx:Avenue } WHERE { ?t a clx:Tree BIND(BNODE() AS ?n) }", "BNODE");
  expectRefusal("CONSTRUCT { ?t clx:seen ?n } WHERE { ?t a clx:Tree BIND(NOW() AS ?n) }", "NOW");
  expectRefusal("CONSTRUCT { ?n a clx:Avenue } WHERE { ?t a clx:Tree BIND(UUID() AS ?n) }", "UUID");
}

TEST(SparqlRulesCheck, RefusesBlankNodesInTheTemplate) {
  expectRefusal("CONSTRUCT { [] a clx:Avenue ; clx:hasMember ?t } WHERE { ?t a clx:Tree }", "blank node");
  expectRefusal("CONSTRUCT { ?t clx:partOf _:row } WHERE { ?t a clx:Tree }", "blank node");
}

TEST(SparqlRulesCheck, RefusesWhatIsNoConstruct) {
  expectRefusal("SELECT ?s WHERE { ?s ?p ?o }", "CONSTRUCT");
  expectRefusal("ASK { ?s ?p ?o }", "CONSTRUCT");
}

TEST(SparqlRulesCheck, AFaultyRuleIsNamedWithItsLine) {
  expectRefusal("\nCONSTRUCT { ?s ?p }\nWHERE { }", "my-rule.rq:2");
}

TEST(SparqlRulesCheck, TheShippedRulesPass) { EXPECT_NO_THROW(checkSparqlRules(shippedRules())); }

TEST_F(SparqlRules, ARuleWithoutEndIsAnError) {
  addTree(1);
  try {
    runSparqlRules(transaction, {{"endless.rq", kPrefixes + "CONSTRUCT { ?next a clx:Sprout . ?t clx:grows ?next } WHERE { ?t a ?c "
                                                            "FILTER(?c IN (clx:Tree, clx:Sprout)) FILTER NOT EXISTS { ?t clx:grows ?x } "
                                                            "BIND(clx:newObject(clx:Sprout, ?t) AS ?next) }"}});
    FAIL() << "the rule came to an end";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("endless.rq"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("without end"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace cluxel
