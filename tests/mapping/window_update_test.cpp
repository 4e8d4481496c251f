// SPDX-License-Identifier: Apache-2.0
// Changes that are computed around what changed lead to the map, and to the stored state, of a build from nothing.
#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <random>

#include "mapping/build/map_update.hpp"
#include "mapping/build/operator_statements.hpp"
#include "mapping/change/map_change.hpp"
#include "mapping/change/statement_change.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/small_campus.hpp"
#include "rdf/map_iris.hpp"
#include "rules/other_number.hpp"
#include "sparql/query_engine.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;

/// Scans along a street: each sees little of what the others see.
class StreetScans {
 public:
  explicit StreetScans(std::uint64_t seed, double size_m = 130)
      : campus_({.seed = seed, .stops = 12, .size_m = size_m, .points_per_stop = 7000, .max_range_m = 16}) {
    for (const fs::path& file : campus_.files()) {
      const ScanSet alone = scansOf({file});
      ids_.push_back(alone.load(0).id);
      poses_.push_back(alone.file(0).T_map_sensor);
    }
  }
  std::size_t size() const { return ids_.size(); }
  const ScanId& idOf(std::size_t scan) const { return ids_[scan]; }
  /// Number 0 is the true pose.
  Eigen::Isometry3d poseOf(std::size_t scan, int number) const {
    Eigen::Isometry3d T = poses_[scan];
    if (number == 1) T.pretranslate(Eigen::Vector3d(0.5, 0.25, 0));
    return T;
  }
  ScanSet at(const std::map<std::size_t, int>& places, const fs::path& folder) const {
    std::ofstream text(folder / "places.yaml");
    text.precision(17);
    text << "scans:\n";
    for (const auto& [scan, number] : places) {
      text << "  - {path: " << campus_.files()[scan].string() << ", time_s: " << 1600000000 + 1000 * scan
           << ", pose: [";
      const Eigen::Matrix4d T = poseOf(scan, number).matrix();
      for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column)
          text << (column > 0 ? ", " : row > 0 ? "], [" : "[") << T(row, column);
      text << "]]}\n";
    }
    text.close();
    return scansOf({folder / "places.yaml"});
  }

 private:
  SmallCampus campus_;
  std::vector<ScanId> ids_;
  std::vector<Eigen::Isometry3d> poses_;
};

/// The blocks of the stages and of the layers above them.
std::map<std::string, std::string> layerBlocks(const fs::path& file) {
  std::map<std::string, std::string> blocks;
  const auto environment = Environment::open(file, OpenMode::ReadOnly);
  const ReadTransaction transaction = environment->read();
  for (const std::string_view table :
       {tables::kPoints, tables::kCluxels, tables::kGround, tables::kFeatures, tables::kLabels, tables::kSummaries,
        tables::kEven, tables::kComponents, tables::kContacts, tables::kTileLayers, tables::kObjects,
        tables::kWideTiles, tables::kPresence, tables::kPassedRays, tables::kOverruled, tables::kStated})
    transaction.forEachBlock(table, "", [&](std::string_view key, std::string_view bytes) {
      blocks[std::string(table) + "/" + std::string(key)] = std::string(bytes);
    });
  blocks["meta/ways"] = transaction.block(tables::kMeta, "ways").value_or("");
  return blocks;
}

/// The tables in which two maps differ, each with the number of its rows that do.
std::map<std::string, int> differingTables(const fs::path& a, const fs::path& b) {
  const auto in_a = layerBlocks(a), in_b = layerBlocks(b);
  std::map<std::string, int> tables;
  const auto count = [&](const auto& from, const auto& to) {
    for (const auto& [key, bytes] : from)
      if (const auto same = to.find(key); same == to.end() || same->second != bytes)
        ++tables[key.substr(0, key.find('/'))];
  };
  count(in_a, in_b);
  count(in_b, in_a);
  return tables;
}

class StreetChanges {
 public:
  StreetChanges(const StreetScans& scans, unsigned seed) : scans_(scans), random_(seed) {
    for (std::size_t i = 0; i < scans.size(); ++i)
      if (i % 3 != 0) there_[i] = 0;
    build(map());
  }

  std::string step() {
    const std::size_t scan = below(scans_.size());
    if (!there_.contains(scan)) {
      there_[scan] = static_cast<int>(below(2));
      note(extendMap(map(), scans_.at({{scan, there_[scan]}}, folder_.path()), params(), silence()));
      return "extend";
    }
    if (below(2) == 0 && there_.size() > 4) {
      there_.erase(scan);
      note(retractScans(map(), {scans_.idOf(scan)}, params(), silence()));
      return "retract";
    }
    there_[scan] = 1 - there_[scan];
    note(moveScans(map(), {{scans_.idOf(scan), scans_.poseOf(scan, there_[scan])}}, params(), silence()));
    return "repose";
  }

  /// Something is stated about a thing or a region, or withdrawn.
  std::string stateSomething() {
    const std::vector<ContentHash> stated = statements();
    StatementEdit edit;
    if (!stated.empty() && below(3) == 0) {
      edit.withdrawn.push_back(stated[below(stated.size())]);
    } else {
      const MapReader reader(map());
      std::vector<const SemanticObject*> things;
      for (const SemanticObject& object : reader.objects())
        if (!object.is_class_wide) things.push_back(&object);
      edit.added.push_back(statementAbout(reader, *things[below(things.size())]));
    }
    const std::string text = edit.added.empty() ? "withdraw" : "state " + textOf(edit.added.front());
    note(changeStatements(map(), edit, params(), silence()));
    return text;
  }

  /// A number of the shipped rules is changed.
  std::string changeANumber() {
    while (true) {
      const test::OtherNumber other = test::withOtherNumber(inputs_.rules.front().text, random_);
      MapInputs changed = inputs_;
      changed.rules.front().text = other.text;
      try {
        note(applyInputs(
            map(), [&](const MapInputs&) { return changed; }, params(), silence()));
      } catch (const InputError&) {
        continue;  // a number that may not be other
      }
      inputs_ = std::move(changed);
      return other.what;
    }
  }

  void expectBuildFromScratch(const std::string& after) {
    const fs::path fresh = folder_.path() / "fresh.clx";
    fs::remove(fresh);  // a map that is replaced hands on its statements
    build(fresh);
    EXPECT_TRUE(canonicalText(map()) == canonicalText(fresh)) << "after " << after;
    EXPECT_THAT(differingTables(map(), fresh), testing::IsEmpty()) << "after " << after;
  }

  std::size_t localCommits() const { return local_; }

 private:
  fs::path map() const { return folder_.path() / "map.clx"; }
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(random_() % count); }
  ChangeParams params() { return {.threads = 1 + static_cast<unsigned>(below(2)), .max_window_share = 2}; }
  std::vector<ContentHash> statements() const {
    std::vector<ContentHash> ids;
    for (const Statement& statement : storedStatements(MapReader(map()).quads())) ids.push_back(statement.id());
    return ids;
  }
  Statement statementAbout(const MapReader& reader, const SemanticObject& thing) {
    const PointAnchor points = reader.anchorOf(thing.id);
    switch (below(5)) {
      case 0:
        return {StatementKind::Is, "", Term::iri(vocabulary::clx("StreetSign")), points, {}};
      case 1:
        return {StatementKind::IsNot, "", Term::iri(thing.class_iri), points, {}};
      case 2:
        return {StatementKind::Remove, "", {}, points, {}};
      case 3:
        return {StatementKind::Fact, vocabulary::rdfs("label"), Term::literal("it"), points, {}};
      default:
        break;
    }
    const Eigen::Vector2d at = reader.scene().cluxels.center[thing.parts.front().cluxels.front()].head<2>();
    const Eigen::Vector2d right(4, 0), up(0, 4);
    return {StatementKind::IgnoreRegion,
            "",
            {},
            {},
            regionAnchor(reader.clouds(), {at - up, at + right, at + up, at - right})};
  }
  void note(const ChangeReport& report) { local_ += report.local_commits; }
  void build(const fs::path& file) {
    BuildParams params{.force = true};
    if (fs::exists(map())) params.statements = operatorStatements(MapReader(map()).quads());
    buildMap(scans_.at(there_, folder_.path()), inputs_, file, params, silence());
  }

  const StreetScans& scans_;
  std::mt19937 random_;
  MapInputs inputs_ = shippedInputs();
  ScratchFolder folder_;
  std::map<std::size_t, int> there_;  ///< scan → number of its pose
  std::size_t local_ = 0;
};

/// Random sequences of changes, each compared with a build from nothing. At least half must be computed around the
/// change.
void checkSequences(std::uint64_t first_campus, unsigned steps,
                    const std::function<std::string(StreetChanges&, unsigned)>& step) {
  const bool is_long = std::getenv("CLUXEL_LONG_TESTS") != nullptr;
  const unsigned sequences = is_long ? 12 : 2;
  if (is_long) steps = 3 * steps + 2;
  std::size_t local = 0;
  for (unsigned seed = 1; seed <= sequences; ++seed) {
    const StreetScans scans(first_campus + seed);
    StreetChanges changes(scans, seed);
    std::string done;
    for (unsigned i = 0; i < steps; ++i) {
      done += step(changes, i) + ", ";
      changes.expectBuildFromScratch(done + "seed " + std::to_string(seed));
      if (testing::Test::HasFailure()) return;
    }
    local += changes.localCommits();
  }
  EXPECT_GE(local, sequences * steps / 2) << "too few changes were computed around what changed";
}

TEST(WindowUpdate, GivesTheMapAndTheStoredStateOfABuild) {
  checkSequences(20, 5, [](StreetChanges& changes, unsigned) { return changes.step(); });
}

TEST(WindowUpdate, AppliesStatementsAsABuildDoes) {
  checkSequences(
      40, 7, [](StreetChanges& changes, unsigned i) { return i % 3 == 2 ? changes.step() : changes.stateSomething(); });
}

TEST(WindowUpdate, AppliesOtherNumbersOfRulesAsABuildDoes) {
  checkSequences(
      60, 8, [](StreetChanges& changes, unsigned i) { return i % 4 == 3 ? changes.step() : changes.changeANumber(); });
}

/// How many primitives were decided.
class SceneSize : public ProgressSink {
 public:
  void progress(std::string_view stage, std::size_t, std::size_t total) override {
    if (stage == "scene") primitives = total;
  }
  std::size_t primitives = 0;
};

/// The IRI of the westernmost tree.
std::string treeAtTheEnd(const MapReader& reader) {
  std::string tree;
  double west = std::numeric_limits<double>::infinity();
  for (const SemanticObject& object : reader.objects()) {
    if (object.class_iri != vocabulary::clx("Tree")) continue;
    const double x = reader.scene().cluxels.center[object.parts.front().cluxels.front()].x();
    if (x < west) west = x, tree = rdf::iriOfObject(object.id);
  }
  return tree;
}

TEST(WindowUpdate, FollowsStatementsOfASparqlUpdate) {
  const StreetScans scans(33, 300);
  const ScratchFolder folder;
  const fs::path map = folder.path() / "map.clx", stated = folder.path() / "stated.clx";
  std::map<std::size_t, int> all;
  for (std::size_t i = 0; i < scans.size(); ++i) all[i] = 0;
  buildMap(scans.at(all, folder.path()), shippedInputs(), map, {}, silence());
  fs::copy_file(map, stated);
  const std::string tree = treeAtTheEnd(MapReader(map));
  ASSERT_NE(tree, "");
  SceneSize decided;
  updateMap(map, "INSERT DATA { <" + tree + "> a <" + vocabulary::clx("UtilityPole") + "> }", {}, decided,
            {.author = "anna", .layers = {.max_window_share = 2}});
  EXPECT_GT(decided.primitives, 0U);
  EXPECT_LT(decided.primitives, MapReader(map).scene().primitives.size()) << "the whole map was decided";
  EXPECT_EQ(knownStatements(MapReader(map).quads()).front().author, "anna");
  StatementEdit edit;
  edit.added = storedStatements(MapReader(map).quads());
  ASSERT_EQ(edit.added.size(), 1U);
  changeStatements(stated, edit, {.max_window_share = 0}, silence());
  EXPECT_TRUE(canonicalText(map) == canonicalText(stated));
  EXPECT_THAT(differingTables(map, stated), testing::IsEmpty());
  const std::string derived =
      "PREFIX prov: <http://www.w3.org/ns/prov#> ASK { GRAPH <https://w3id.org/cluxel/graph/history> { ?new "
      "prov:wasDerivedFrom <" +
      tree + "> ; prov:wasGeneratedBy ?run } }";
  EXPECT_TRUE(sparql::evaluateQuery(MapReader(map).quads(), derived).boolean) << "by the run of the update";
}

TEST(WindowUpdate, TakesTheGroundOfAnAreaThatLosesItsOnlyScan) {
  const StreetScans scans(31);
  const ScratchFolder folder;
  const fs::path map = folder.path() / "map.clx", fresh = folder.path() / "fresh.clx";
  const std::size_t alone = scans.size() - 1;  // some 110 m from the others
  buildMap(scans.at({{0, 0}, {1, 0}, {2, 0}, {alone, 0}}, folder.path()), shippedInputs(), map, {}, silence());
  retractScans(map, {scans.idOf(alone)}, {.max_window_share = 2}, silence());
  buildMap(scans.at({{0, 0}, {1, 0}, {2, 0}}, folder.path()), shippedInputs(), fresh, {}, silence());
  EXPECT_TRUE(canonicalText(map) == canonicalText(fresh));
  EXPECT_THAT(differingTables(map, fresh), testing::IsEmpty());
}

}  // namespace
}  // namespace cluxel::mapping
