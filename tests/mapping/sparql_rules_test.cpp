// SPDX-License-Identifier: Apache-2.0
// CONSTRUCT rules: the derived facts, their derivations, and the rules that are refused.
#include "mapping/inference/sparql_rules.hpp"

#include <gtest/gtest.h>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "mapping/asking_rules.hpp"
#include "mapping/facts/map_oracle.hpp"
#include "rdf/store/quad_store.hpp"
#include "rdf/vocabulary.hpp"
#include "sparql/query_engine.hpp"
#include "test_paths.hpp"

namespace cluxel::mapping {

using namespace scan;
using namespace perception;
using namespace simulation;
using namespace rdf;
using namespace sparql;
using namespace rules;
namespace {

const std::string kQueryPrefixes =
    "PREFIX clx: <https://w3id.org/cluxel/ontology#> PREFIX rdf: <http://www.w3.org/1999/02/22-rdf-syntax-ns#> ";

NamedText shippedRule(const std::string& name) {
  const std::string file = (test::sourceFolder() / "rules" / name).string();
  return {file, readFile(file)};
}

std::vector<NamedText> shippedRules() {
  return {shippedRule("10_tree_rows.rq"), shippedRule("20_avenues.rq")};
}

Term tree(int number) {
  return Term::iri("https://example.org/tree/" + std::to_string(number));
}

/// A store of trees with `near` relations, as input of rules.
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
    return evaluateQuery(reader, kQueryPrefixes + "SELECT * WHERE { " + pattern + " }").table.row_count;
  }
  bool ask(const std::string& pattern) {
    const QuadReader reader{static_cast<const ReadTransaction&>(transaction)};
    return PreparedQuery(reader, kQueryPrefixes + "ASK { " + pattern + " }").ask();
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
  runSparqlRules(transaction,
                 {{"reach.rq", kQueryPrefixes + "CONSTRUCT { ?a clx:reaches ?c } WHERE { { ?a clx:near ?c } UNION "
                                                "{ ?a clx:reaches ?b . ?b clx:near ?c } FILTER(?a != ?c) }"}});
  EXPECT_EQ(countOf("?a clx:reaches ?b"), 72U);
}

void expectRefusal(const std::string& text, const std::string& word) {
  try {
    checkSparqlRules({{"my-rule.rq", kQueryPrefixes + text}});
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

TEST(SparqlRulesCheck, RefusesCutsThatFollowFromTheOrderOfStorage) {
  expectRefusal("CONSTRUCT { ?t clx:first true } WHERE { ?t a clx:Tree } LIMIT 1", "LIMIT");
  expectRefusal("CONSTRUCT { ?t clx:first true } WHERE { ?t a clx:Tree } ORDER BY ?t OFFSET 1", "LIMIT");
  expectRefusal("CONSTRUCT { ?t clx:first true } WHERE { { SELECT ?t { ?t a clx:Tree } LIMIT 1 } }", "my-rule.rq:1:");
  expectRefusal(
      "CONSTRUCT { ?t clx:n true } WHERE { ?t a clx:Tree FILTER EXISTS { SELECT ?u { ?u clx:near ?t } OFFSET 2 } }",
      "ORDER BY");
  EXPECT_NO_THROW(checkSparqlRules(
      {{"sorted.rq", kQueryPrefixes + "CONSTRUCT { ?t clx:first true } WHERE { { SELECT ?t { ?t a clx:Tree ; "
                                      "clx:top ?top } ORDER BY DESC(?top) LIMIT 1 } }"}}));
}

TEST(SparqlRulesCheck, RefusesTheSameInQueriesOfRuleTrees) {
  std::string rules = kAskingRules;
  const std::string asked = "{ ?thing a clx:SmallObject }";
  rules.replace(rules.find(asked), asked.size(), "{ SELECT ?thing { ?thing a clx:SmallObject } LIMIT 1 }");
  const std::vector<RuleSource> texts{{"asking.rules.yaml", rules}};
  const std::vector<NamedText> ontology{
      {"bench.ttl", kBenchOntology},
      {"rest.ttl",
       "@prefix clx: <https://w3id.org/cluxel/ontology#> . @prefix owl: <http://www.w3.org/2002/07/owl#> . "
       "clx:SmallObject a owl:Class . clx:StreetFurniture a owl:Class ."}};
  const auto faults = loadRuleTexts(texts, 1, classCatalogueOf(ontology), withCheckedQueries()).diagnostics;
  const auto isCut = [](const Diagnostic& fault) { return fault.message.find("LIMIT") != std::string::npos; };
  const auto found = std::find_if(faults.begin(), faults.end(), isCut);
  ASSERT_NE(found, faults.end()) << format(faults);
  EXPECT_EQ(found->location.file, "asking.rules.yaml");
  EXPECT_GT(found->location.line, 1U);
  const std::vector<RuleSource> sound{{"asking.rules.yaml", kAskingRules}};
  const auto none = loadRuleTexts(sound, 1, classCatalogueOf(ontology), withCheckedQueries()).diagnostics;
  EXPECT_FALSE(hasErrors(none)) << format(none);
}

TEST_F(SparqlRules, SeeNothingOfTheHistoryOfBuilds) {
  addTree(1);
  QuadWriter writer(transaction);
  writer.add(Quad{tree(1), Term::iri(vocabulary::clx("sourceFile")), Term::literal("a.pcd"),
                  Term::iri(vocabulary::kGraphHistory)});
  writer.add(Quad{tree(1), Term::iri(vocabulary::clx("seen")), tree(1), Term::iri(vocabulary::kGraphHistory)});
  writer.flush();
  const std::string history = "<" + std::string(vocabulary::kGraphHistory) + ">";
  const std::string from = "CONSTRUCT { ?t clx:leak ?f } FROM " + history +
                           " FROM <https://w3id.org/cluxel/graph/observed> FROM NAMED " + history;
  runSparqlRules(
      transaction,
      {{"1.rq",
        kQueryPrefixes + "CONSTRUCT { ?t clx:leak ?f } WHERE { GRAPH " + history + " { ?t clx:sourceFile ?f } }"},
       {"2.rq", kQueryPrefixes + "CONSTRUCT { ?t clx:leak ?f } WHERE { GRAPH ?g { ?t clx:sourceFile ?f } }"},
       {"3.rq", kQueryPrefixes +
                    "CONSTRUCT { ?t clx:leak ?g } WHERE { ?t a clx:Tree . GRAPH ?g { } FILTER(?g = " + history + ") }"},
       {"4.rq", kQueryPrefixes + from + " WHERE { ?t clx:sourceFile ?f }"},
       {"5.rq", kQueryPrefixes + from + " WHERE { GRAPH ?g { ?t clx:sourceFile+ ?f } }"},
       {"6.rq", kQueryPrefixes + "CONSTRUCT { ?t clx:seen ?t } WHERE { ?t a clx:Tree }"}});
  EXPECT_FALSE(ask("?t clx:leak ?f"));
  EXPECT_TRUE(ask("?d a clx:Derivation ; rdf:predicate clx:seen")) << "what the history says is not known to the map";
  EXPECT_TRUE(ask("GRAPH " + history + " { ?t clx:sourceFile ?f }")) << "others may ask it";
}

TEST_F(SparqlRules, DoNotSeeDerivationsWhereTheyAskOutsideOfTheirPatterns) {
  addTree(1);
  runSparqlRules(
      transaction,
      {{"named.rq", kQueryPrefixes + "CONSTRUCT { ?t clx:isNamed ?e } WHERE { { SELECT ?t "
                                     "(EXISTS { ?d ?p ?t } AS ?e) { ?t a clx:Tree } } }"},
       {"lone.rq", kQueryPrefixes + "CONSTRUCT { ?t clx:isLone false } WHERE { { SELECT ?t { ?t a clx:Tree } "
                                    "GROUP BY ?t HAVING(EXISTS { ?d ?p ?t }) } }"}});
  EXPECT_TRUE(ask("?t clx:isNamed false"));
  EXPECT_TRUE(ask("?d rdf:subject ?t . ?t a clx:Tree"));
  EXPECT_FALSE(ask("?t clx:isNamed true")) << "by a derivation of the rule itself";
  EXPECT_FALSE(ask("?t clx:isLone false"));
}

TEST(SparqlRulesCheck, RefusesPathsWithoutAStepBetweenUnboundVariables) {
  const auto check = [](const std::string& where) {
    checkNewSparqlRules(
        {{"path.rq",
          "PREFIX clx: <https://w3id.org/cluxel/ontology#> CONSTRUCT { ?a clx:near ?b } WHERE { " + where + " }"}});
  };
  for (const char* where :
       {"?a clx:on* ?b", "?a clx:on? ?b", "?a clx:on* ?b . ?b clx:on* ?c", "{ ?a clx:on* ?b } MINUS { ?a a clx:Tree }",
        "?a a clx:Tree . { SELECT ?b (COUNT(?c) AS ?n) { ?b clx:on* ?c } GROUP BY ?b }",
        "?b a clx:Tree FILTER EXISTS { ?a clx:on* ?c }", "{ ?a clx:on* ?b } UNION { ?a a clx:Tree . ?a clx:on* ?b }",
        "VALUES ?a { UNDEF clx:x } ?a clx:on* ?b", "VALUES (?a ?c) { (UNDEF 1) } ?a clx:on* ?b",
        "BIND(1 / 0 AS ?a) ?a clx:on* ?b", "BIND(?c AS ?a) ?a clx:on* ?b",
        "{ SELECT ?a { OPTIONAL { ?a a clx:Tree } } } ?a clx:on* ?b",
        "{ SELECT (1 / 0 AS ?a) { ?c a clx:Tree } } ?a clx:on* ?b"})
    EXPECT_THROW(check(where), InputError) << where;
  for (const char* where :
       {"?a clx:on+ ?b", "?a a clx:Tree . ?a clx:on* ?b", "?b a clx:Tree . ?a clx:on* ?b", "?a clx:on*/clx:near ?b",
        "?a a clx:Tree . ?a clx:on* ?b . ?b clx:on? ?c", "?a a clx:Tree OPTIONAL { ?a clx:on* ?b }",
        "{ ?a a clx:Tree } UNION { ?a a clx:Bush } ?a clx:on* ?b", "VALUES ?a { clx:x } ?a clx:on* ?b",
        "VALUES (?a ?c) { (clx:x UNDEF) } ?a clx:on* ?b", "BIND(clx:x AS ?a) ?a clx:on* ?b",
        "?c a clx:Tree BIND(?c AS ?a) ?a clx:on* ?b", "{ SELECT ?a { ?a a clx:Tree } } ?a clx:on* ?b",
        "?a clx:near ?b FILTER NOT EXISTS { ?a clx:on* ?c }", "?a (clx:on?/clx:near)+ ?b",
        "?a (clx:near|(clx:on?/clx:hasPart)) ?b"})
    EXPECT_NO_THROW(check(where)) << where;
}

TEST(SparqlRulesCheck, RefusesBlankNodesInTheTemplate) {
  expectRefusal("CONSTRUCT { ?t a clx:Tree .\n  ?t clx:partOf _:row } WHERE { ?t a clx:Tree }", ":2:17: ");
  expectRefusal("CONSTRUCT { [] a clx:Avenue ; clx:hasMember ?t } WHERE { ?t a clx:Tree }", "blank node");
  expectRefusal("CONSTRUCT { ?t clx:partOf _:row } WHERE { ?t a clx:Tree }", "blank node");
}

void expectHistoryRefused(const std::string& text, const std::string& place) {
  try {
    checkNewSparqlRules({{"my-rule.rq", "PREFIX clx: <https://w3id.org/cluxel/ontology#>\n" + text}});
    FAIL() << "accepted: " << text;
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(place), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("rules see no history"), std::string::npos) << error.what();
  }
}

TEST(SparqlRulesCheck, RefusesToNameTheHistory) {
  const std::string history = "<https://w3id.org/cluxel/graph/history>";
  expectHistoryRefused("CONSTRUCT { ?t clx:near ?t } WHERE {\n GRAPH " + history + " { ?t a clx:Tree } }",
                       "my-rule.rq:3:8");
  expectHistoryRefused("CONSTRUCT { ?t clx:near ?t }\nFROM " + history + " WHERE { ?t a clx:Tree }", "my-rule.rq:3:");
  expectHistoryRefused("CONSTRUCT { ?t clx:near ?t } FROM NAMED " + history + " WHERE { GRAPH ?g { ?t a clx:Tree } }",
                       "my-rule.rq:2:");
  expectHistoryRefused("CONSTRUCT { ?t clx:near ?t } WHERE { ?t a clx:Tree FILTER NOT EXISTS { GRAPH " + history +
                           " { ?t a clx:Tree } } }",
                       "my-rule.rq:2:");
  const std::vector<NamedText> any_graph{
      {"any.rq", kQueryPrefixes + "CONSTRUCT { ?t clx:near ?t } WHERE { GRAPH ?g { ?t a clx:Tree } }"}};
  EXPECT_NO_THROW(checkNewSparqlRules(any_graph)) << "it goes through the other graphs";
  EXPECT_NO_THROW(checkSparqlRules(
      {{"old.rq", kQueryPrefixes + "CONSTRUCT { ?t clx:near ?t } WHERE { GRAPH " + history + " { ?t a clx:Tree } }"}}))
      << "a map of an earlier program may have it";
}

TEST(SparqlRulesCheck, RefusesWhatIsNoConstruct) {
  expectRefusal("SELECT ?s WHERE { ?s ?p ?o }", "CONSTRUCT");
  expectRefusal("ASK { ?s ?p ?o }", "CONSTRUCT");
}

TEST(SparqlRulesCheck, AFaultyRuleIsNamedWithItsLine) {
  expectRefusal("\nCONSTRUCT { ?s ?p }\nWHERE { }", "my-rule.rq:2");
}

TEST(SparqlRulesCheck, TheShippedRulesPass) {
  EXPECT_NO_THROW(checkSparqlRules(shippedRules()));
}

TEST_F(SparqlRules, KeepTheBudgetOfMemoryOfTheUpdateThatTheyFollow) {
  for (int i = 1; i <= 30; ++i) addTree(i);
  const NamedText rule{"texts.rq",
                       kQueryPrefixes +
                           "CONSTRUCT { ?a clx:near ?a } WHERE { { SELECT ?a (COUNT(DISTINCT ?t) AS ?n) { "
                           "?a a clx:Tree . ?b a clx:Tree . ?c a clx:Tree "
                           "BIND(CONCAT(STR(?a), STR(?b), STR(?c)) AS ?t) } GROUP BY ?a } FILTER(?n < 0) }"};
  const auto run = [&](std::uint64_t max_memory_bytes) {
    runSparqlRules(transaction, {rule}, {.held = [](std::size_t) {}, .max_memory_bytes = max_memory_bytes});
  };
  EXPECT_NO_THROW(run(64'000'000));
  EXPECT_NO_THROW(run(0)) << "no limit";
  try {
    run(1'000'000);
    FAIL() << "27,000 texts of 70 bytes do not fit";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::BudgetExceeded) << error.what();
  }
}

TEST_F(SparqlRules, ARuleWithoutEndIsAnError) {
  addTree(1);
  try {
    runSparqlRules(
        transaction,
        {{"endless.rq", kQueryPrefixes + "CONSTRUCT { ?next a clx:Sprout . ?t clx:grows ?next } WHERE { ?t a ?c "
                                         "FILTER(?c IN (clx:Tree, clx:Sprout)) FILTER NOT EXISTS { ?t clx:grows ?x } "
                                         "BIND(clx:newObject(clx:Sprout, ?t) AS ?next) }"}});
    FAIL() << "the rule came to an end";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("endless.rq"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("without end"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace cluxel::mapping
