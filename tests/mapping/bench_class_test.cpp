// SPDX-License-Identifier: Apache-2.0
// A class that the program does not know, defined by an ontology text and a rule text, in a built map.
#include <gtest/gtest.h>

#include "cluxel/error.hpp"
#include "mapping/asking_rules.hpp"
#include "mapping/facts/semantic_layer.hpp"
#include "sparql/query_engine.hpp"

namespace cluxel::mapping {

using namespace scan;
using namespace perception;
using namespace simulation;
using namespace rdf;
using namespace sparql;
using namespace rules;
namespace {

/// Only the size is tested, so that the test does not depend on the labels of a trained model.
constexpr const char* kBenchRules = R"(apiVersion: cluxel.rules/v1
ruleset: { name: benches, version: 1.0.0 }
prefixes: { clx: "https://w3id.org/cluxel/ontology#" }
order: [clx:Bench]
rules:
  - id: bench/by-size
    class: clx:Bench
    description: Pieces that touch and together have the size of a bench.
    seed:
      label_in: [horizontal_plane, vertical_plane, small_structure, scatter, column]
      where:
        - { attribute: length, op: "<=", value: 2.0 m }
        - { attribute: top, op: between, min: 0.15 m, max: 1.00 m }
    group: { near: 0.4 m, limits: [ { attribute: length, op: "<=", value: 2.2 m } ] }
    tree:
      all:
        - { attribute: length, op: between, min: 1.1 m, max: 2.2 m }
        - { attribute: width, op: "<=", value: 0.9 m }
        - { attribute: top, op: between, min: 0.35 m, max: 1.00 m }
      yes: { accept: { confidence: 0.9 } }
      no: { reject: not of a bench's size }
)";

TEST(BenchClass, AppearsInAMapFromAnOntologyAndARuleTextAlone) {
  const ScratchFolder folder;
  writeScanFile(parkWithBench(), folder.path() / "park.pcd");
  MapInputs inputs = shippedInputs();
  inputs.ontology.push_back({"bench.ttl", kBenchOntology});
  inputs.rules = {{"bench.rules.yaml", kBenchRules}};
  inputs.rule_roots = 1;
  buildMap(scansOf({folder.path() / "park.pcd"}), inputs, folder.path() / "map.clx", {}, silence());
  const MapReader map(folder.path() / "map.clx");
  const MapSummary summary = map.summary();
  ASSERT_EQ(summary.objects_by_class.count("Bench"), 1U) << canonicalText(map).size();
  EXPECT_EQ(summary.objects_by_class.at("Bench"), 1U);
  const QueryResult answer = evaluateQuery(map.quads(), R"(PREFIX clx: <https://w3id.org/cluxel/ontology#>
    SELECT ?x ?y ?length WHERE { ?bench a clx:Bench, clx:StreetFurniture ; clx:x ?x ; clx:y ?y ; clx:length ?length })");
  ASSERT_EQ(answer.table.row_count, 1U) << "the new class has its place among the known ones";
  EXPECT_NEAR(std::stod(answer.table.at(0, 0)->text), 5.0, 0.1);
  EXPECT_NEAR(std::stod(answer.table.at(0, 1)->text), 5.0, 0.1);
  EXPECT_NEAR(std::stod(answer.table.at(0, 2)->text), 1.5, 0.2);
}

TEST(BenchClass, IsUnknownToAMapWithoutItsOntology) {
  const ScratchFolder folder;
  writeScanFile(parkWithBench(), folder.path() / "park.pcd");
  MapInputs inputs = shippedInputs();
  inputs.rules = {{"bench.rules.yaml", kBenchRules}};
  inputs.rule_roots = 1;
  EXPECT_THROW(buildMap(scansOf({folder.path() / "park.pcd"}), inputs, folder.path() / "map.clx", {}, silence()),
               InputError);
}

TEST(BenchClass, IsRefusedForNewRulesWhenNoQuestionWouldFindIt) {
  MapInputs inputs = shippedInputs();
  inputs.ontology.push_back({"bench.ttl",
                             "@prefix clx: <https://w3id.org/cluxel/ontology#> .\n"
                             "clx:Bench a <http://www.w3.org/2002/07/owl#Class> .\n"});
  inputs.rules = {{"bench.rules.yaml", kBenchRules}};
  inputs.rule_roots = 1;
  try {
    parseNewInputs(inputs, ontologyOf(inputs.ontology));
    FAIL() << "the class is not below clx:Object";
  } catch (const InputError& fault) {
    const std::string text = format(fault.diagnostics());
    EXPECT_NE(text.find("bench.rules.yaml:6:"), std::string::npos) << text;
    EXPECT_NE(text.find("clx:Bench of rule 'bench/by-size' is not below clx:Object"), std::string::npos) << text;
  }
  EXPECT_EQ(parseInputs(inputs).rules.rules.size(), 1U) << "a map of an earlier program can have such rules";
}

}  // namespace
}  // namespace cluxel::mapping
