// SPDX-License-Identifier: Apache-2.0
// Names in queries that can match nothing are found; those of the shipped rules and questions are all known.
#include "mapping/facts/query_names.hpp"

#include <gmock/gmock.h>

#include "base/file_bytes.hpp"
#include "base/installation/data_home.hpp"
#include "mapping/facts/map_oracle.hpp"
#include "mapping/map_inputs.hpp"
#include "rules/language/rule_loader.hpp"
#include "test_paths.hpp"

namespace cluxel::mapping {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const rdf::OntologyView& shippedOntology() {
  static const rdf::OntologyView view = [] {
    const auto sources = ontologySources(readMapInputs({}, DataHome::find(test::sourceFolder().string())).ontology);
    return rdf::ontologyViewOf(sources);
  }();
  return view;
}

std::vector<std::string> faultsIn(const std::string& body, const std::vector<std::string>& bound = {}) {
  const rules::RuleLoadOptions options = withCheckedQueries(shippedOntology());
  const auto fault =
      options.check_query("PREFIX clx: <https://w3id.org/cluxel/ontology#>\nASK { " + body + " }", bound);
  return fault ? std::vector<std::string>{fault->message} : std::vector<std::string>{};
}

TEST(QueryNames, OfClassesAndPropertiesAreLookedUpInTheOntology) {
  EXPECT_THAT(faultsIn("?x a clx:Tree ; clx:near ?y"), IsEmpty());
  EXPECT_THAT(faultsIn("?x a clx:Tre"), ElementsAre(HasSubstr("no class clx:Tre; did you mean 'Tree'?")));
  EXPECT_THAT(faultsIn("?x clx:naer ?y"), ElementsAre(HasSubstr("no property clx:naer; did you mean 'near'?")));
  EXPECT_THAT(faultsIn("?x clx:near/clx:hight ?y"), ElementsAre(HasSubstr("no property clx:hight")));
  EXPECT_THAT(faultsIn("?x a <urn:other> ; <urn:unknown> 1"), IsEmpty()) << "only Cluxel's own names";
}

TEST(QueryNames, FindsVariablesThatNothingBindsWhereAFilterLooksAtThem) {
  EXPECT_THAT(faultsIn("?x clx:height ?h FILTER (?h > 2)"), IsEmpty());
  EXPECT_THAT(faultsIn("?x clx:height ?h FILTER (?height > 2)"), ElementsAre(HasSubstr("nothing binds ?height")));
  EXPECT_THAT(faultsIn("?x clx:near ?y FILTER (?pole != ?y)"), ElementsAre(HasSubstr("nothing binds ?pole")));
  EXPECT_THAT(faultsIn("?x clx:near ?y FILTER (?pole != ?y)", {"pole"}), IsEmpty()) << "the rule binds it";
  EXPECT_THAT(faultsIn("?x clx:near ?y FILTER (!BOUND(?z))"), IsEmpty());
  EXPECT_THAT(faultsIn("?x clx:height ?h FILTER EXISTS { ?x clx:near ?y FILTER (?y != ?x && ?h > 1) }"), IsEmpty());
  EXPECT_THAT(faultsIn("?x a clx:Tree { ?y clx:height ?h FILTER (?x != ?y) }"), ElementsAre(HasSubstr("?x")))
      << "an inner group does not see what stands around it";
  EXPECT_THAT(faultsIn("?x a clx:Tree OPTIONAL { ?y clx:height ?h FILTER (?x != ?y) }"), IsEmpty());
  EXPECT_THAT(faultsIn("{ SELECT ?h { ?x clx:height ?h } } FILTER (?h > 1)"), IsEmpty());
  EXPECT_THAT(faultsIn("BIND (2 AS ?two) VALUES ?v { 1 } FILTER (?two > ?v)"), IsEmpty());
}

/// What is said of a rule of facades with this query; trees come after, the ground before.
std::string saidOfAsking(const std::string& body) {
  const std::string text = R"(
apiVersion: cluxel.rules/v1
ruleset: { name: test, version: 1.0.0 }
prefixes: { clx: "https://w3id.org/cluxel/ontology#" }
order: [clx:Barrier, [clx:Building, clx:StreetSign], clx:Tree]
rules:
  - id: building
    class: clx:Building
    seed: { label: vertical_plane }
    tree:
      ask: "ASK { )" + body +
                           R"( ?x clx:hasPrimitive ?p . ?p clx:near ?seed }"
      yes: { accept: { confidence: 0.5 } }
      no: { reject: alone }
)" + [] {
                             std::string others;
                             for (const std::string name : {"Barrier", "StreetSign", "Tree"})
                               others += "  - { id: " + name + ", class: clx:" + name +
                                         ", seed: { label: column }, tree: { accept: { confidence: 0.5 } } }\n";
                             return others;
                           }();
  const std::vector<rules::RuleSource> sources{{"r.yaml", text}};
  return format(loadRuleTexts(sources, 1, rules::catalogueOf(shippedOntology()), withCheckedQueries(shippedOntology()))
                    .diagnostics);
}

TEST(QueryNames, OfClassesThatComeLaterAreWarnedOf) {
  const std::string none_yet = "and no such object exists yet when clx:Building has its turn";
  EXPECT_THAT(saidOfAsking("?x a clx:Tree ."),
              HasSubstr("r.yaml:11:12: warning: the query looks for clx:Tree, " + none_yet));
  EXPECT_THAT(saidOfAsking("?x a clx:Tree ."), HasSubstr("finds only what operators have stated"));
  for (const char* late : {"?x a clx:Building .", "?x a clx:StreetSign .", "FILTER NOT EXISTS { ?x a clx:Tree }",
                           "OPTIONAL { ?x a clx:Tree }"})
    EXPECT_THAT(saidOfAsking(late), HasSubstr(none_yet)) << late;
  for (const char* early : {"?x a clx:Barrier .", "?x a clx:SmallObject .", "?x a clx:Object .", "?x a ?class .",
                            "?x a clx:TreeTrunk .", "?x a <urn:other> ."})
    EXPECT_EQ(saidOfAsking(early), "") << early;
}

TEST(QueryNames, OfTheShippedSparqlRulesAreKnown) {
  for (const NamedText& rule : readMapInputs({}, DataHome::find(test::sourceFolder().string())).sparql_rules)
    EXPECT_THAT(format(checkRuleNames(rule.name, rule.text, shippedOntology())), ::testing::Not(HasSubstr("error")))
        << rule.name;
}

TEST(QueryNames, AreToldWithTheirPlace) {
  const std::string text =
      "PREFIX clx: <https://w3id.org/cluxel/ontology#>\nCONSTRUCT { ?x a clx:Tree }\nWHERE { ?x a clx:Shrubb }\n";
  const auto faults = checkRuleNames("mine.rq", text, shippedOntology());
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].location.line, 3U);
  EXPECT_EQ(faults[0].location.column, 14U);
  EXPECT_EQ(faults[0].source_line, "WHERE { ?x a clx:Shrubb }");
}

}  // namespace
}  // namespace cluxel::mapping
