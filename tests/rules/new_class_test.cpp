// SPDX-License-Identifier: Apache-2.0
// A new class is defined by a rule file and an ontology file alone, without a change of the program.
#include <gmock/gmock.h>

#include "base/file_bytes.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rules/box_world.hpp"
#include "test_paths.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
using namespace rdf;
using namespace rules;
namespace {

RdfSource turtle(const std::string& name, const std::string& text) {
  RdfSource source;
  source.name = name;
  source.text = text;
  return source;
}

TEST(NewClass, ComesFromARuleFileAndAnOntologyFileAlone) {
  const std::vector<RdfSource> ontologies{
      turtle("core.ttl", readFile(test::sourceFolder() / "ontology/core.ttl")),
      turtle("outdoor.ttl", readFile(test::sourceFolder() / "ontology/outdoor.ttl")),
      turtle("bench.ttl", R"(@prefix clx: <https://w3id.org/cluxel/ontology#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix owl: <http://www.w3.org/2002/07/owl#> .
clx:Bench a owl:Class ; rdfs:subClassOf clx:StreetFurniture ; clx:mayHavePart clx:BenchSeat .
clx:BenchSeat a owl:Class ; rdfs:subClassOf clx:Part .
)")};
  const std::vector<RuleSource> texts{
      {"bench.rules.yaml", R"(apiVersion: cluxel.rules/v1
include: [ outdoor.rules.yaml ]
order: { insert: [ clx:Bench ], before: clx:SmallObject }
rules:
  - id: bench/seat
    class: clx:Bench
    description: A flat thing at the height of a knee.
    seed: { label: horizontal_plane }
    tree:
      all:
        - { attribute: free_height_below, op: between, min: 0.30 m, max: 0.60 m }
        - { attribute: length, op: between, min: 1 m, max: 3 m }
        - { attribute: width, op: "<=", value: 0.8 m }
      yes: { accept: { part: clx:BenchSeat, confidence: 0.8 } }
      no: { reject: not a seat }
)"},
      {"outdoor.rules.yaml", readFile(test::sourceFolder() / "rules/outdoor.rules.yaml")}};
  const LoadedRules loaded = loadRuleTexts(texts, 1, catalogueOf(ontologyViewOf(ontologies)));
  ASSERT_TRUE(loaded.rules.has_value()) << format(loaded.diagnostics);
  BoxScene park;
  park.boxes = {box("ground", kGroundLabel, {0, 0, 0}, {20, 20, 0.1}),
                box("seat", kGroundLabel, {5, 0, 0.45}, {1.6, 0.4, 0.06})};
  const BuiltBoxScene built = sceneOfBoxes(park);
  EXPECT_THAT(inWords(built, reason(built.scene, *loaded.rules)),
              ::testing::UnorderedElementsAre("Ground{Ground: ground}", "Bench{BenchSeat: seat}"));
}

}  // namespace
}  // namespace cluxel::testing
