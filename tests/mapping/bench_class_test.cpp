// SPDX-License-Identifier: Apache-2.0
// A class that the program does not know, from an ontology text and a rule text alone, all the way into a map.
#include <gtest/gtest.h>

#include <random>

#include "cluxel/base/diagnostic.hpp"
#include "cluxel/sparql/query_engine.hpp"
#include "mapping/small_campus.hpp"

namespace cluxel {
namespace {

constexpr const char* kBenchOntology = R"(@prefix clx: <https://w3id.org/cluxel/ontology#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix skos: <http://www.w3.org/2004/02/skos/core#> .
clx:Bench a owl:Class ; rdfs:subClassOf clx:StreetFurniture ;
    skos:prefLabel "bench"@en, "Bank"@de ; rdfs:comment "To sit on."@en ; clx:color "#aa7744" .
)";

/// Size alone decides, so that the test does not hang on the label that a trained model gives.
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

void addPoint(ScanPoints& points, double x, double y, double z) {
  points.x.push_back(static_cast<float>(x));
  points.y.push_back(static_cast<float>(y));
  points.z.push_back(static_cast<float>(z));
}

/// Flat ground with a seat of 1.5 x 0.5 x 0.45 m at (5, 5), and its back of 0.9 m.
Scan parkWithBench() {
  std::mt19937 random(11);
  std::normal_distribution<double> noise(0, 0.005);
  Scan scan;
  const auto isUnderBench = [](double x, double y) { return x > 4.25 && x < 5.75 && y > 4.75 && y < 5.25; };
  for (double x = 0; x < 10; x += 0.08)
    for (double y = 0; y < 10; y += 0.08)
      if (!isUnderBench(x, y)) addPoint(scan.points, x, y, noise(random));
  for (double x = 4.25; x <= 5.75; x += 0.04)
    for (double y = 4.75; y <= 5.25; y += 0.04) addPoint(scan.points, x, y, 0.45 + noise(random));
  for (double x = 4.25; x <= 5.75; x += 0.04)
    for (double z = 0.05; z < 0.45; z += 0.04)
      for (const double y : {4.75, 5.25}) addPoint(scan.points, x, y + noise(random), z);
  for (double x = 4.25; x <= 5.75; x += 0.04)
    for (double z = 0.45; z <= 0.9; z += 0.04) addPoint(scan.points, x, 5.25 + noise(random), z);
  return scan;
}

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
  EXPECT_THROW(buildMap(scansOf({folder.path() / "park.pcd"}), inputs, folder.path() / "map.clx", {}, silence()), InputError);
}

}  // namespace
}  // namespace cluxel
