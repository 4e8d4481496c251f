// SPDX-License-Identifier: Apache-2.0
// Operator's statements are inputs of a map: inference follows them in the same commit, and a build keeps them.
#include <gtest/gtest.h>

#include <algorithm>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "mapping/asking_rules.hpp"
#include "mapping/build/operator_statements.hpp"
#include "mapping/change/map_change.hpp"
#include "mapping/change/map_update.hpp"
#include "mapping/change/rdf_loading.hpp"
#include "mapping/change/statement_change.hpp"
#include "rdf/file/map_replacement.hpp"
#include "rdf/map_iris.hpp"
#include "sparql/query_engine.hpp"

namespace cluxel::mapping {

using namespace scan;
using namespace perception;
using namespace simulation;
using namespace rdf;
using namespace sparql;
using namespace rules;
namespace {

namespace fs = std::filesystem;

const std::string kPrefixes = "PREFIX clx: <https://w3id.org/cluxel/ontology#> PREFIX ex: <https://example.org/> ";
const std::string kState = kPrefixes + "INSERT DATA { ex:oak a clx:Tree }";
const std::string kTakeBack =
    kPrefixes + "DELETE DATA { GRAPH <https://w3id.org/cluxel/graph/operator> { ex:oak a clx:Tree } }";

bool holds(const std::filesystem::path& map, const std::string& pattern) {
  const MapReader reader(map);
  return PreparedQuery(reader.quads(), kPrefixes + "ASK { " + pattern + " }").ask();
}

/// A map built with the bench rules only, which have no `ask:`.
std::filesystem::path buildPark(const std::filesystem::path& folder, const BuildParams& params = {}) {
  writeScanFile(parkWithBench(), folder / "park.pcd");
  buildMap(scansOf({folder / "park.pcd"}), shippedInputs(), folder / "map.clx", params, silence());
  return folder / "map.clx";
}

TEST(OperatorStatements, AreInferredFromAtOnceAndTakenBackWithoutATrace) {
  const ScratchFolder folder;
  const auto map = buildPark(folder.path());
  const std::string before = canonicalText(map);
  EXPECT_EQ(updateMap(map, kState, {}, silence()).inserted, 1U);
  EXPECT_TRUE(holds(map, "GRAPH <https://w3id.org/cluxel/graph/inferred> { ex:oak a clx:Plant }") ||
              holds(map, "GRAPH <https://w3id.org/cluxel/graph/inferred> { ex:oak a ?ancestor }"));
  updateMap(map, kTakeBack, {}, silence());
  EXPECT_EQ(canonicalText(map), before);
}

TEST(OperatorStatements, StayWhenAMapIsBuiltAnewUnlessTheyAreDropped) {
  const ScratchFolder folder;
  const auto map = buildPark(folder.path());
  const std::string without = canonicalText(map);
  updateMap(map, kState, {}, silence());
  const std::string with = canonicalText(map);
  EXPECT_NE(with, without);
  buildPark(folder.path(), {.force = true});
  EXPECT_EQ(canonicalText(map), with) << "the same scans, rules and statements make the same map";
  buildPark(folder.path(), {.force = true, .drop_statements = true});
  EXPECT_EQ(canonicalText(map), without);
}

TEST(OperatorStatements, OfAClassThatTheOntologyLacksAreKeptAsDormant) {
  const ScratchFolder folder;
  const auto map = buildPark(folder.path());
  StatementEdit edit;
  {
    const MapReader reader(map);
    const rules::SemanticObject& object = reader.objects().front();
    edit.added.push_back({StatementKind::Is,
                          "",
                          Term::iri(vocabulary::clx("Unicorn")),
                          anchorOf(reader.stagesWithPoints(), object),
                          {}});
  }
  const std::vector<Quad> statements = quadsOf(edit.added.front());
  EXPECT_THROW(changeStatements(map, edit, {}, silence()), Error) << "who states something anew may have mistyped it";
  buildPark(folder.path(), {.force = true, .statements = statements});
  EXPECT_EQ(storedStatements(MapReader(map).quads()).size(), 1U);
  const std::string built = canonicalText(map);
  const fs::path file = folder.path() / "statements.nq";
  std::string text;
  for (const Quad& quad : statements) text += toNQuads(quad);
  writeFile(file, text);
  buildPark(folder.path(), {.force = true, .drop_statements = true});
  loadRdfFiles(map, {file}, {}, silence());
  EXPECT_TRUE(canonicalText(map) == built);
}

/// The shipped inputs and two classes of one's own, of which one is a class of objects.
MapInputs withOwnClasses(const std::string& of_objects, const std::string& other) {
  MapInputs inputs = shippedInputs();
  inputs.ontology.push_back({"own.ttl",
                             "@prefix ex: <https://example.org/> . @prefix owl: <http://www.w3.org/2002/07/owl#> . "
                             "@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> . ex:" +
                                 of_objects + " a owl:Class ; rdfs:subClassOf <" + vocabulary::clx("Vehicle") +
                                 "> . ex:" + other + " a owl:Class ."});
  return inputs;
}

TEST(OperatorStatements, GiveTheSameMapInABuildWhenTheOntologyHasChanged) {
  const ScratchFolder folder;
  const fs::path map = folder.path() / "map.clx", again = folder.path() / "again.clx";
  writeScanFile(parkWithBench(), folder.path() / "park.pcd");
  const scan::ScanSet scans = scansOf({folder.path() / "park.pcd"});
  buildMap(scans, withOwnClasses("Car", "Late"), map, {}, silence());
  StatementEdit edit;
  std::vector<Quad> of_earlier_program;
  {
    const MapReader reader(map);
    const std::vector<rules::SemanticObject> objects = reader.objects();
    const auto bench = std::find_if(objects.begin(), objects.end(), [](const auto& o) { return !o.is_class_wide; });
    ASSERT_NE(bench, objects.end());
    const PointAnchor points = anchorOf(reader.stagesWithPoints(), *bench);
    edit.added.push_back({StatementKind::Is, "", Term::iri("https://example.org/Car"), points, {}});
    of_earlier_program = quadsOf({StatementKind::Fact, vocabulary::clx("porosity"), Term::literal("1"), points, {}});
  }
  changeStatements(map, edit, {}, silence());
  const std::string object = rdf::mapIri("object", std::string(31, '0') + "1");
  updateMap(map, kPrefixes + "INSERT DATA { <" + object + "> a ex:Late }", {}, silence());
  {
    rdf::WriteTransaction transaction = rdf::writeMap(map);
    addOperatorStatements(transaction, of_earlier_program);
    transaction.commit();
  }
  const MapInputs changed = withOwnClasses("Late", "Car");
  applyInputs(
      map, [&](const MapInputs&) { return changed; }, {}, silence());
  const std::vector<Quad> exported = operatorStatements(MapReader(map).quads());
  buildMap(scans, changed, again, {.statements = exported}, silence());
  EXPECT_TRUE(canonicalText(map) == canonicalText(again));
  EXPECT_EQ(operatorStatements(MapReader(again).quads()).size(), exported.size());
}

TEST(OperatorStatements, ChangeObjectsWhereRulesAskForThem) {
  const ScratchFolder folder;
  const auto map = buildAskingMap(folder.path());
  ASSERT_EQ(MapReader(map).summary().objects_by_class.count("Bench"), 1U);
  const std::string before = canonicalText(map);
  updateMap(map, kState, {}, silence());
  const MapSummary stated = MapReader(map).summary();
  EXPECT_EQ(stated.objects_by_class.count("Bench"), 0U) << "its rule turns benches down where there is a tree";
  EXPECT_EQ(stated.objects_by_class.count("SmallObject"), 0U) << "which waits for a bench";
  updateMap(map, kTakeBack, {}, silence());
  EXPECT_EQ(canonicalText(map), before);
}

TEST(AskingRules, SeeByHowManyCloudsAnObjectWasSeenAndItsObservations) {
  const ScratchFolder folder;
  std::string rules = kAskingRules;
  const std::string asked = "?thing a clx:Bench }";
  rules.replace(rules.find(asked), asked.size(),
                "?thing a clx:Bench ; clx:viewCount 1 . ?seen <http://www.w3.org/ns/sosa/hasFeatureOfInterest> ?thing "
                "; clx:pointCount ?n }");
  const auto map = buildAskingMap(folder.path(), {}, rules);
  EXPECT_EQ(MapReader(map).summary().objects_by_class.count("SmallObject"), 1U);
}

TEST(OperatorStatements, AreRefusedWhereTheirInferenceExceedsTheBudget) {
  const ScratchFolder folder;
  const auto map = buildPark(folder.path());
  const std::string before = canonicalText(map);
  std::string chain =
      kPrefixes + "PREFIX owl: <http://www.w3.org/2002/07/owl#> INSERT DATA { ex:next a owl:TransitiveProperty . ";
  for (int i = 0; i < 400; ++i) chain += "ex:n" + std::to_string(i) + " ex:next ex:n" + std::to_string(i + 1) + " . ";
  chain += "}";
  for (const bool by_time : {false, true}) {
    UpdateOptions options;
    if (by_time) {
      // Time passes with the calls: the update itself makes a few, the inference many.
      options.query.budget.poll = [calls = 0]() mutable {
        if (++calls > 20) throw Error(ErrorKind::BudgetExceeded, "inferred for too long");
      };
    } else {
      options.query.budget.max_memory_bytes = 10'000'000;
    }
    try {
      updateMap(map, chain, options, silence());
      FAIL() << "no error: 80,000 facts follow";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::BudgetExceeded);
      EXPECT_NE(std::string(error.what()).find("inferred"), std::string::npos) << error.what();
    }
    EXPECT_EQ(canonicalText(map), before);
  }
  EXPECT_EQ(updateMap(map, chain, {}, silence()).inserted, 401U);
}

TEST(OperatorStatements, OfAFaultyUpdateLeaveTheMapAsItWas) {
  const ScratchFolder folder;
  const auto map = buildPark(folder.path());
  const std::string before = canonicalText(map);
  EXPECT_THROW(updateMap(map, "INSERT { ", {}, silence()), InputError);
  EXPECT_EQ(canonicalText(map), before);
}

}  // namespace
}  // namespace cluxel::mapping
