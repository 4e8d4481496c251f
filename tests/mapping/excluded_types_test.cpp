// SPDX-License-Identifier: Apache-2.0
// What an operator states about a class that SPARQL rules derive holds, and the map stays the one that a build makes.
#include "mapping/statements/excluded_types.hpp"

#include <gtest/gtest.h>

#include "mapping/change/map_change.hpp"
#include "mapping/change/map_update.hpp"
#include "mapping/change/statement_change.hpp"
#include "mapping/stated_builds.hpp"
#include "rdf/map_iris.hpp"
#include "sparql/query_engine.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;

const std::string kPrefix =
    "PREFIX clx: <https://w3id.org/cluxel/ontology#> PREFIX rdf: <http://www.w3.org/1999/02/22-rdf-syntax-ns#> ";

const std::string kStoneWall = "http://e.org/StoneWall", kPalisade = "http://e.org/Palisade";

/// A campus on which `35_fences.rq` finds fences, a rule of one's own that reads them and says more, and one that makes
/// a class below fences from barriers.
class StatedOfDerivedClasses : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    MapInputFiles files;
    files.model = "campus";
    inputs = new MapInputs(readMapInputs(files, DataHome(test::sourceFolder())));
    inputs->ontology.push_back(
        {"own.ttl",
         "@prefix owl: <http://www.w3.org/2002/07/owl#> . @prefix rdfs: "
         "<http://www.w3.org/2000/01/rdf-schema#> . <http://e.org/Picket> a owl:Class ; "
         "rdfs:subClassOf <https://w3id.org/cluxel/ontology#Fence> ; rdfs:label \"picket\"@en . "
         "<http://e.org/Palisade> a owl:Class ; rdfs:subClassOf <https://w3id.org/cluxel/ontology#Fence> ; "
         "rdfs:label \"palisade\"@en . <http://e.org/StoneWall> a owl:Class ; "
         "rdfs:subClassOf <https://w3id.org/cluxel/ontology#Wall> ; rdfs:label \"stone wall\"@en ."});
    inputs->sparql_rules.push_back(
        {"own.rq", kPrefix + "CONSTRUCT { ?f a <http://e.org/Picket> } WHERE { ?f a clx:Fence ; clx:height ?h }"});
    inputs->sparql_rules.push_back(
        {"palisades.rq", kPrefix + "CONSTRUCT { ?b a <" + kPalisade +
                             "> } WHERE { ?b a clx:Barrier ; clx:porosity ?p FILTER(?p >= 0.1) }"});
    campus = new SmallCampus({.seed = 3, .stops = 4, .size_m = 60, .points_per_stop = 50'000});
    folder = new ScratchFolder;
    buildMap(scansOf(campus->files()), *inputs, folder->path() / "map.clx", {.threads = 2}, silence());
  }
  static void TearDownTestSuite() {
    delete folder;
    delete campus;
    delete inputs;
  }
  void SetUp() override {
    fs::copy_file(folder->path() / "map.clx", map, fs::copy_options::overwrite_existing);
    before = canonicalText(map);
    const auto fences = objectsThat("?o a clx:Fence");
    ASSERT_GT(fences.size(), 1U);
    fence = fences.front();
    ASSERT_TRUE(asks(fence, "a <http://e.org/Picket>, <" + kPalisade + ">"));
  }

  std::vector<ContentHash> objectsThat(const std::string& pattern) const {
    const MapReader reader(map);
    const sparql::ResultTable table =
        sparql::evaluateQuery(reader.quads(), kPrefix + "SELECT ?o { " + pattern + " } ORDER BY ?o").table;
    std::vector<ContentHash> objects;
    for (std::size_t row = 0; row < table.row_count; ++row) {
      const std::string iri = table.at(row, 0)->text;
      objects.push_back(ContentHash::fromHex(iri.substr(iri.rfind('/') + 1)));
    }
    return objects;
  }
  bool asks(const ContentHash& object, const std::string& is) const {
    const MapReader reader(map);
    return sparql::PreparedQuery(reader.quads(), kPrefix + "ASK { <" + iriOfObject(object) + "> " + is + " }").ask();
  }
  StatementOutcome state(StatementKind kind, const std::string& class_name) const {
    return stateClass(kind, vocabulary::clx(class_name));
  }
  StatementOutcome stateClass(StatementKind kind, const std::string& class_iri) const {
    StatementEdit edit;
    edit.added.push_back({kind, "", Term::iri(class_iri), MapReader(map).anchorOf(fence), {}});
    return changeStatements(map, edit, {}, silence()).statements.at(0);
  }
  void expectThatOfABuild() const {
    EXPECT_TRUE(canonicalText(map) == builtWithStatementsOf(map, scansOf(campus->files()), *inputs));
  }

  static inline MapInputs* inputs = nullptr;
  static inline SmallCampus* campus = nullptr;
  static inline ScratchFolder* folder = nullptr;
  const fs::path map = folder->path() / "copy.clx";
  std::string before;
  ContentHash fence;
};

TEST_F(StatedOfDerivedClasses, TakeTheClassAwayWithWhatFollowsFromIt) {
  const StatementOutcome outcome = state(StatementKind::IsNot, "Fence");
  EXPECT_EQ(outcome.effect, StatementEffect::Applied);
  ASSERT_EQ(outcome.object, fence) << "it is the barrier that it was";
  EXPECT_TRUE(asks(fence, "a clx:Barrier"));
  EXPECT_FALSE(asks(fence, "a clx:Fence"));
  EXPECT_FALSE(asks(fence, "a <http://e.org/Picket>"));
  EXPECT_FALSE(asks(fence, "a <" + kPalisade + ">")) << "which no fact about fences gives it";
  EXPECT_FALSE(asks(fence, "^rdf:subject [ rdf:object clx:Fence ]")) << "nor is its derivation told";
  expectThatOfABuild();
  StatementEdit back;
  back.withdrawn.push_back(outcome.statement.id());
  changeStatements(map, back, {}, silence());
  EXPECT_TRUE(canonicalText(map) == before);
}

TEST_F(StatedOfDerivedClasses, LeaveNoFenceThatIsAWall) {
  const StatementOutcome outcome = state(StatementKind::Is, "Wall");
  ASSERT_TRUE(outcome.object);
  EXPECT_TRUE(asks(*outcome.object, "a clx:Wall"));
  EXPECT_TRUE(objectsThat("?o a clx:Wall, clx:Fence").empty());
  EXPECT_TRUE(objectsThat("?o a clx:Wall, <" + kPalisade + ">").empty()) << "a class below a disjoint one";
  expectThatOfABuild();
}

TEST_F(StatedOfDerivedClasses, LeaveNothingThatIsDisjointWithAClassAbove) {
  const StatementOutcome outcome = stateClass(StatementKind::Is, kStoneWall);
  ASSERT_TRUE(outcome.object);
  EXPECT_TRUE(asks(*outcome.object, "a clx:Wall"));
  EXPECT_FALSE(asks(*outcome.object, "a clx:Fence"));
  EXPECT_FALSE(asks(*outcome.object, "a <" + kPalisade + ">"));
  expectThatOfABuild();
}

/// No object can be stated to be of such a class, but a rule may say so of one.
TEST_F(StatedOfDerivedClasses, TakeAwayAClassThatIsNoneOfObjects) {
  const std::string guarded = "http://e.org/Guarded";
  MapInputs own = *inputs;
  own.ontology.push_back({"guarded.ttl", "<" + guarded +
                                             "> a <http://www.w3.org/2002/07/owl#Class> ; "
                                             "<http://www.w3.org/2000/01/rdf-schema#label> \"guarded\"@en ."});
  own.sparql_rules.push_back({"guarded.rq", kPrefix + "CONSTRUCT { ?f a <" + guarded + "> } WHERE { ?f a clx:Fence }"});
  applyInputs(
      map, [&](const MapInputs&) { return own; }, {}, silence());
  ASSERT_TRUE(asks(fence, "a <" + guarded + ">"));
  EXPECT_EQ(stateClass(StatementKind::IsNot, guarded).effect, StatementEffect::Applied);
  EXPECT_FALSE(asks(fence, "a <" + guarded + ">"));
  EXPECT_TRUE(asks(fence, "a clx:Fence"));
}

TEST_F(StatedOfDerivedClasses, AreNamedByWhatTheyRuleOut) {
  const std::string object = iriOfObject(fence), fence_iri = vocabulary::clx("Fence");
  EXPECT_TRUE(statementsAgainst(MapReader(map).quads(), object, fence_iri).empty());
  const StatementOutcome outcome = state(StatementKind::IsNot, "Fence");
  const MapReader reader(map);
  const std::vector<std::string> named{rdf::iriOfStatement(outcome.statement.id())};
  for (const std::string& class_iri : {fence_iri, kPalisade}) {
    EXPECT_EQ(statementsAgainst(reader.quads(), object, class_iri), named);
    EXPECT_TRUE(rulesOut(reader.quads(), outcome.statement, class_iri));
  }
  const std::string barrier = vocabulary::clx("Barrier");
  EXPECT_TRUE(statementsAgainst(reader.quads(), object, barrier).empty());
  EXPECT_FALSE(rulesOut(reader.quads(), outcome.statement, barrier));
}

TEST_F(StatedOfDerivedClasses, LeaveOtherClassesOfTheObject) {
  const StatementOutcome outcome = state(StatementKind::Is, "Barrier");
  ASSERT_TRUE(outcome.object);
  EXPECT_TRUE(asks(*outcome.object, "a clx:Fence")) << "the ontology does not say that a barrier is no fence";
  expectThatOfABuild();
}

/// An update that says so of the object's name becomes the same statement.
TEST_F(StatedOfDerivedClasses, HoldWhenAnUpdateMakesThem) {
  updateMap(map, kPrefix + "INSERT DATA { <" + iriOfObject(fence) + "> a clx:Wall }", {}, silence());
  EXPECT_FALSE(objectsThat("?o a clx:Wall ; clx:rule \"operator\"").empty());
  EXPECT_TRUE(objectsThat("?o a clx:Wall, clx:Fence").empty());
  expectThatOfABuild();
}

TEST_F(StatedOfDerivedClasses, HoldInAMapThatGrows) {
  const fs::path grown = folder->path() / "grown.clx";
  state(StatementKind::IsNot, "Fence");
  const std::vector<Quad> statements = operatorStatements(MapReader(map).quads());
  std::vector<fs::path> files = campus->files();
  const fs::path last = files.back();
  files.pop_back();
  buildMap(scansOf(files), *inputs, grown, {.force = true, .statements = statements}, silence());
  extendMap(grown, scansOf({last}), {}, silence());
  EXPECT_TRUE(canonicalText(grown) == canonicalText(map));
}

}  // namespace
}  // namespace cluxel::mapping
