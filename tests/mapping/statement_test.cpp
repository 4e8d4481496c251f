// SPDX-License-Identifier: Apache-2.0
// Operator statements are inputs: they follow their points through every change, and a build with them gives the map.
#include "mapping/statements/statement.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "cluxel/error.hpp"
#include "mapping/change/map_change.hpp"
#include "mapping/change/map_merge.hpp"
#include "mapping/change/map_things.hpp"
#include "mapping/change/map_update.hpp"
#include "mapping/change/statement_change.hpp"
#include "mapping/facts/object_geometry.hpp"
#include "mapping/small_campus.hpp"
#include "mapping/stated_builds.hpp"
#include "mapping/statements/statement_facts.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr std::size_t kScans = 4;

std::string clxClass(const std::string& local) {
  return rdf::vocabulary::clx(local);
}

class Statements : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    campus = new SmallCampus({.seed = 5, .stops = kScans, .size_m = 45, .points_per_stop = 2500});
    inputs = new MapInputs(shippedInputs());
    scans = new ScanSet(scansOf(campus->files()));
    for (std::size_t i = 0; i < scans->size(); ++i) ids.push_back(scans->load(i).id);
  }
  static void TearDownTestSuite() {
    delete campus;
    delete inputs;
    delete scans;
    ids.clear();
  }

  using Poses = std::map<std::size_t, int>;  // scan → 0: true pose; n: shifted by n times 0.5 m and turned

  static Eigen::Isometry3d poseOf(std::size_t scan, int number) {
    Eigen::Isometry3d T = scans->file(scan).T_map_sensor;
    if (number == 0) return T;
    T.pretranslate(Eigen::Vector3d(0.5 * number, 0, 0));
    T.rotate(Eigen::AngleAxisd(number * 0.035, Eigen::Vector3d::UnitZ()));
    return T;
  }
  static ScanSet posed(const Poses& poses) {
    std::vector<PosedScan> chosen;
    for (const auto& [scan, number] : poses) chosen.push_back({scan, poseOf(scan, number)});
    return scans->posed(chosen);
  }
  fs::path map(const std::string& name = "map.clx") const { return folder.path() / name; }
  void build(const Poses& poses, const std::string& name = "map.clx") const {
    buildMap(posed(poses), *inputs, map(name), {.force = true}, silence());
  }

  /// The map of the same inputs, built from scratch with the statements that `file` holds.
  std::string fromScratch(const fs::path& file, const Poses& poses) const {
    return builtWithStatementsOf(file, posed(poses), *inputs);
  }

  /// The largest object that is neither ground nor a street sign.
  static rules::SemanticObject thingIn(const MapReader& reader) {
    const rules::SemanticObject* largest = nullptr;
    for (const rules::SemanticObject& object : reader.objects())
      if (object.class_iri != clxClass("Ground") && object.class_iri != clxClass("StreetSign") &&
          (largest == nullptr || object.parts[0].cluxels.size() > largest->parts[0].cluxels.size()))
        largest = &object;
    if (largest == nullptr) throw std::runtime_error("the campus has nothing but ground and signs");
    return *largest;
  }
  static Statement about(const MapReader& reader, const rules::SemanticObject& object, StatementKind kind,
                         const std::string& local = "") {
    const Term value = local.empty() ? Term{} : Term::iri(clxClass(local));
    return {kind, "", value, anchorOf(reader.stagesWithPoints(), object), {}};
  }
  ChangeReport state(const std::vector<Statement>& added, const std::vector<ContentHash>& withdrawn = {}) const {
    return changeStatements(map(), {added, withdrawn, "anna"}, {}, silence());
  }
  static KnownStatement only(const fs::path& file) {
    const auto known = knownStatements(MapReader(file).quads());
    if (known.size() != 1) throw std::runtime_error(std::to_string(known.size()) + " statements, one was expected");
    return known.front();
  }
  static std::string classOf(const fs::path& file, const std::string& object_iri) {
    const MapReader reader(file);
    for (const rules::SemanticObject& object : reader.objects())
      if (rdf::iriOfObject(object.id) == object_iri) return localName(object.class_iri);
    return "none";
  }

  ScratchFolder folder;
  inline static SmallCampus* campus = nullptr;
  inline static MapInputs* inputs = nullptr;
  inline static ScanSet* scans = nullptr;
  inline static std::vector<ScanId> ids;
};

TEST_F(Statements, FixTheClassOfAnObjectAndSayThatTheRulesDisagree) {
  build({{0, 0}, {1, 0}});
  const std::string before = canonicalText(map());
  const Statement statement = [&] {
    const MapReader reader(map());
    return about(reader, thingIn(reader), StatementKind::Is, "StreetSign");
  }();
  const ChangeReport report = state({statement});
  ASSERT_EQ(report.statements.size(), 1U);
  EXPECT_EQ(report.statements[0].effect, StatementEffect::Applied);
  EXPECT_TRUE(report.statements[0].contradicts);
  const KnownStatement known = only(map());
  EXPECT_EQ(classOf(map(), known.object), "StreetSign");
  EXPECT_NE(localName(known.rules_class), "StreetSign");
  EXPECT_EQ(known.author, "anna");
  EXPECT_TRUE(canonicalText(map()) == fromScratch(map(), {{0, 0}, {1, 0}}));
  state({}, {statement.id()});
  EXPECT_TRUE(canonicalText(map()) == before) << "a withdrawn statement leaves no trace";
}

TEST_F(Statements, FollowTheirObjectThroughAnySequenceOfChanges) {
  Poses there{{0, 0}, {1, 0}};
  build(there);
  {
    const MapReader reader(map());
    const rules::SemanticObject thing = thingIn(reader);
    Statement label = about(reader, thing, StatementKind::Fact);
    label.property = rdf::vocabulary::rdfs("label");
    label.value = Term::literal("north gate");
    const Statement is = about(reader, thing, StatementKind::Is, "StreetSign");
    const Eigen::Vector3d at = reader.clouds().front().T_map_sensor.translation();
    const std::vector<Eigen::Vector2d> corners{{at.x(), at.y()}, {at.x() + 20, at.y()}, {at.x(), at.y() + 20}};
    const Statement region{StatementKind::IgnoreRegion, "", {}, {}, regionAnchor(reader.clouds(), corners)};
    state({label, is, region});
  }
  const bool is_long = std::getenv("CLUXEL_LONG_TESTS") != nullptr;
  std::mt19937 random(3);
  const auto below = [&random](std::size_t count) { return static_cast<std::size_t>(random() % count); };
  for (int step = 0; step < (is_long ? 50 : 6); ++step) {
    const std::size_t scan = below(kScans);
    const int pose = static_cast<int>(below(3)) - 1;
    if (!there.contains(scan)) {
      extendMap(map(), posed({{scan, pose}}), {}, silence());
      there[scan] = pose;
    } else if (there.size() > 1 && below(2) == 0) {
      retractScans(map(), {ids[scan]}, {}, silence());
      there.erase(scan);
    } else {
      moveScans(map(), {{ids[scan], poseOf(scan, pose)}}, {}, silence());
      there[scan] = pose;
    }
    ASSERT_TRUE(canonicalText(map()) == fromScratch(map(), there)) << "step " << step;
  }
}

TEST_F(Statements, LieDormantWhileTheirScansAreAwayAndWakeUp) {
  build({{0, 0}, {1, 0}, {2, 0}});
  {
    const MapReader reader(map());
    Statement statement = about(reader, thingIn(reader), StatementKind::Remove);
    const auto kept = *statement.points.begin();
    statement.points = {kept};  // of one scan only
    state({statement});
  }
  const KnownStatement stated = only(map());
  EXPECT_EQ(stated.effect, "applied");
  EXPECT_FALSE(stated.lacks_scans);
  const std::string before = canonicalText(map());
  const ScanId scan = stated.statement.points.begin()->first;
  const ChangeReport report = retractScans(map(), {scan}, {.max_window_share = 0}, silence());
  EXPECT_EQ(only(map()).effect, "dormant");
  EXPECT_TRUE(only(map()).lacks_scans);
  for (const auto& outcomes : {report.statements, toldOutcomes(MapReader(map()).quads())})
    EXPECT_EQ(summaryOf(outcomes),
              "operator statements: 0 applied, 1 dormant until the scans that they are about are in the map again");
  const auto number = static_cast<std::size_t>(std::find(ids.begin(), ids.end(), scan) - ids.begin());
  extendMap(map(), posed({{number, 0}}), {}, silence());
  EXPECT_EQ(only(map()).effect, "applied");
  EXPECT_FALSE(only(map()).lacks_scans);
  EXPECT_TRUE(canonicalText(map()) == before);
}

TEST_F(Statements, OfSeveralThatContradictEachOtherOneCounts) {
  build({{0, 0}, {1, 0}});
  {
    const MapReader reader(map());
    const rules::SemanticObject thing = thingIn(reader);
    state({about(reader, thing, StatementKind::Is, "StreetSign"), about(reader, thing, StatementKind::Is, "StreetLamp"),
           about(reader, thing, StatementKind::IsNot, "TrafficLight")});
  }
  std::multiset<std::string> effects;
  for (const KnownStatement& known : knownStatements(MapReader(map()).quads())) effects.insert(known.effect);
  EXPECT_EQ(effects, (std::multiset<std::string>{"applied", "applied", "overruled"}))
      << "'is not' a third class contradicts neither";
}

TEST_F(Statements, ThatAThingIsNotOneClassAndNotAnotherHoldTogether) {
  build({{0, 0}, {1, 0}});
  std::string rules_class;
  std::vector<Statement> statements;
  {
    const MapReader reader(map());
    const rules::SemanticObject thing = thingIn(reader);
    rules_class = localName(thing.class_iri);
    for (const char* local : {"TrafficLight", "StreetSign", "Person", "UtilityPole", "Wire"})
      statements.push_back(about(reader, thing, StatementKind::IsNot, local));
    statements.push_back(about(reader, thing, StatementKind::IsNot, rules_class));
  }
  const ChangeReport report = state(statements);
  EXPECT_EQ(report.objects.gone.size(), 1U) << "it is not what the rules say, whatever else it is not";
  for (const StatementOutcome& outcome : report.statements) {
    EXPECT_EQ(outcome.effect, StatementEffect::Applied);
    EXPECT_EQ(outcome.contradicts, localName(outcome.statement.value.text) == rules_class);
  }
  EXPECT_TRUE(canonicalText(map()) == fromScratch(map(), {{0, 0}, {1, 0}}));
}

/// The terms of our namespace in all graphs of a map.
std::set<std::string> termsUsedIn(const fs::path& file) {
  std::set<std::string> terms;
  const MapReader reader(file);
  rdf::QuadCursor cursor = reader.quads().scan({});
  for (rdf::QuadIds quad; cursor.next(quad);)
    for (const rdf::TermId id : {quad.p, quad.o}) {
      const Term term = reader.quads().termOf(id);
      if (term.kind == TermKind::Iri && term.text.starts_with(rdf::vocabulary::kClx)) terms.insert(term.text);
    }
  return terms;
}

TEST_F(Statements, UseTermsThatTheOntologyDeclares) {
  build({{0, 0}, {1, 0}});
  std::vector<Statement> statements;
  {
    const MapReader reader(map());
    const rules::SemanticObject thing = thingIn(reader);
    statements = {about(reader, thing, StatementKind::Is, "StreetSign"),
                  about(reader, thing, StatementKind::IsNot, "Person"),
                  {StatementKind::Fact,
                   rdf::vocabulary::rdfs("label"),
                   Term::literal("gate"),
                   anchorOf(reader.stagesWithPoints(), thing),
                   {}},
                  {StatementKind::IgnoreRegion, "", {}, {}, regionAnchor(reader.clouds(), {{0, 0}, {1, 0}, {1, 1}})}};
  }
  state(statements);
  state({}, {statements[1].id()});
  const MapReader reader(map());
  const rdf::QuadReader& quads = reader.quads();
  const auto ontology = quads.idOf(Term::iri(rdf::vocabulary::kGraphOntology));
  std::size_t declared = 0;
  for (const std::string& term : termsUsedIn(map())) {
    rdf::QuadCursor cursor = quads.scan({.s = quads.idOf(Term::iri(term)), .p = {}, .o = {}, .g = ontology});
    rdf::QuadIds quad;
    EXPECT_TRUE(cursor.next(quad)) << term;
    ++declared;
  }
  EXPECT_GT(declared, 60U);
}

TEST_F(Statements, ThatARegionHoldsNothingSayWhereTheRulesDisagree) {
  build({{0, 0}, {1, 0}});
  std::vector<Eigen::Vector2d> corners;
  std::vector<Cloud> clouds;
  {
    const MapReader reader(map());
    const UprightBox box = geometryOf(reader.scene().cluxels, cluxelsOf(thingIn(reader))).box;
    const double half = 0.5 * box.size.head<2>().norm() + 0.5;
    for (const auto& [x, y] : {std::pair(-half, -half), {half, -half}, {half, half}, {-half, half}})
      corners.emplace_back(box.center.x() + x, box.center.y() + y);
    clouds = reader.clouds();
  }
  const ChangeReport report = state({{StatementKind::IgnoreRegion, "", {}, {}, regionAnchor(clouds, corners)}});
  ASSERT_EQ(report.statements.size(), 1U);
  EXPECT_EQ(report.statements[0].effect, StatementEffect::Applied);
  EXPECT_TRUE(report.statements[0].contradicts);
  EXPECT_GE(report.objects.gone.size(), 1U);
}

TEST_F(Statements, AreNotMadeAndWithdrawnAtOnce) {
  build({{0, 0}, {1, 0}});
  const Statement statement = [&] {
    const MapReader reader(map());
    return about(reader, thingIn(reader), StatementKind::Is, "StreetSign");
  }();
  state({statement});
  EXPECT_THROW(state({statement}, {statement.id()}), Error);
  EXPECT_EQ(knownStatements(MapReader(map()).quads()).size(), 1U);
}

TEST_F(Statements, AboutAnObjectInAnUpdateAreAnchored) {
  build({{0, 0}, {1, 0}});
  const std::string object = [&] {
    const MapReader reader(map());
    return rdf::iriOfObject(thingIn(reader).id);
  }();
  updateMap(map(), "INSERT DATA { <" + object + "> a <" + clxClass("StreetSign") + "> }", {}, silence());
  const KnownStatement known = only(map());
  EXPECT_EQ(textOf(known.statement), "is clx:StreetSign");
  EXPECT_EQ(classOf(map(), known.object), "StreetSign");
  EXPECT_EQ(classOf(map(), object), "none");
  EXPECT_TRUE(canonicalText(map()) == fromScratch(map(), {{0, 0}, {1, 0}}));
  const std::string before = canonicalText(map());
  EXPECT_THROW(updateMap(map(), "INSERT DATA { <" + known.object + "> <" + clxClass("height") + "> 3 }", {}, silence()),
               Error);
  EXPECT_THROW(
      updateMap(map(),
                "DELETE { ?s <" + clxClass("statedClass") + "> ?c } WHERE { ?s <" + clxClass("statedClass") + "> ?c }",
                {}, silence()),
      Error)
      << "half a statement";
  EXPECT_TRUE(canonicalText(map()) == before);
}

TEST_F(Statements, AreKeptByAMerge) {
  build({{0, 0}, {1, 0}}, "a.clx");
  build({{2, 0}, {3, 0}}, "b.clx");
  for (const std::string name : {"a.clx", "b.clx"}) {
    const MapReader reader(map(name));
    const Statement statement = about(reader, thingIn(reader), StatementKind::Is, "StreetSign");
    changeStatements(map(name), {{statement}, {}, ""}, {}, silence());
  }
  mergeMaps({{map("a.clx")}, {map("b.clx")}}, map(), {}, silence());
  EXPECT_EQ(knownStatements(MapReader(map()).quads()).size(), 2U);
  EXPECT_TRUE(canonicalText(map()) == fromScratch(map(), {{0, 0}, {1, 0}, {2, 0}, {3, 0}}));
}

}  // namespace
}  // namespace cluxel::mapping
