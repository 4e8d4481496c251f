// SPDX-License-Identifier: Apache-2.0
// Fixture for tests of `ask:` in builds, explanations and updates: a park with a bench, and rules that query the map.
#pragma once

#include <random>

#include "mapping/small_campus.hpp"

namespace cluxel::mapping {

using namespace scan;
using namespace perception;
using namespace simulation;
using namespace rdf;
using namespace rules;

inline constexpr const char* kBenchOntology = R"(@prefix clx: <https://w3id.org/cluxel/ontology#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
@prefix skos: <http://www.w3.org/2004/02/skos/core#> .
clx:Bench a owl:Class ; rdfs:subClassOf clx:StreetFurniture ;
    skos:prefLabel "bench"@en, "Bank"@de ; rdfs:comment "To sit on."@en ; clx:color "#aa7744" .
)";

inline void addPoint(ScanPoints& points, double x, double y, double z) {
  points.x.push_back(static_cast<float>(x));
  points.y.push_back(static_cast<float>(y));
  points.z.push_back(static_cast<float>(z));
}

/// Flat ground with a seat of 1.5 x 0.5 x 0.45 m at (5, 5), and its back of 0.9 m.
inline Scan parkWithBench() {
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

/// The raised part is a bench unless the map has a small object or a tree; the floor becomes a small object once there
/// is a bench. The finished map therefore answers the first query differently from the map during the build.
inline constexpr const char* kAskingRules = R"(apiVersion: cluxel.rules/v1
ruleset: { name: asking, version: 1.0.0 }
prefixes: { clx: "https://w3id.org/cluxel/ontology#" }
order: [clx:Bench, clx:SmallObject]
rules:
  - id: bench/asking
    class: clx:Bench
    description: The raised piece, while nobody knows of a small object or of a tree.
    seed: { label_in: [horizontal_plane, vertical_plane, small_structure, scatter, column], as: piece, where: [ { attribute: top, op: between, min: 0.15 m, max: 1.2 m }, { attribute: length, op: "<=", value: 2.2 m } ] }
    group: { near: 0.4 m }
    tree:
      ask: "ASK { ?piece clx:height ?height . { ?thing a clx:SmallObject } UNION { ?thing a clx:Tree } }"
      yes: { reject: there is a small object or a tree }
      no: { accept: { confidence: 0.9 } }
  - id: small/asking
    class: clx:SmallObject
    description: The largest piece, once there is a bench.
    seed: { label_in: [horizontal_plane], as: floor, where: [ { attribute: length, op: ">=", value: 5 m } ] }
    group: { near: 3 m }
    tree:
      ask: "ASK { ?floor clx:height ?height . ?thing a clx:Bench }"
      yes: { accept: { confidence: 0.5 } }
      no: { reject: no bench }
)";

/// Writes the park's scan into the folder and builds `map.clx` beside it.
inline std::filesystem::path buildAskingMap(const std::filesystem::path& folder, const BuildParams& params = {},
                                            const std::string& rules = kAskingRules) {
  writeScanFile(parkWithBench(), folder / "park.pcd");
  MapInputs inputs = shippedInputs();
  inputs.ontology.push_back({"bench.ttl", kBenchOntology});
  inputs.rules = {{"asking.rules.yaml", rules}};
  inputs.rule_roots = 1;
  buildMap(scansOf({folder / "park.pcd"}), inputs, folder / "map.clx", params, silence());
  return folder / "map.clx";
}

}  // namespace cluxel::mapping
