// SPDX-License-Identifier: Apache-2.0
// Random changes of a map of a street, each compared with a build from nothing.
#pragma once

#include <gmock/gmock.h>

#include <fstream>
#include <map>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "mapping/build/operator_statements.hpp"
#include "mapping/change/map_change.hpp"
#include "mapping/change/statement_change.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/small_campus.hpp"
#include "rules/other_number.hpp"

namespace cluxel::mapping {

/// Scans along a street: each sees little of what the others see.
class StreetScans {
 public:
  explicit StreetScans(std::uint64_t seed, double size_m = 130)
      : campus_({.seed = seed, .stops = 12, .size_m = size_m, .points_per_stop = 7000, .max_range_m = 16}) {
    for (const std::filesystem::path& file : campus_.files()) {
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
  ScanSet at(const std::map<std::size_t, int>& places, const std::filesystem::path& folder) const {
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
inline std::map<std::string, std::string> storedBlocks(const std::filesystem::path& file) {
  std::map<std::string, std::string> blocks;
  const auto environment = Environment::open(file, OpenMode::ReadOnly);
  const ReadTransaction transaction = environment->read();
  for (const std::string_view table :
       {tables::kPoints, tables::kCluxels, tables::kGround, tables::kFeatures, tables::kLabels, tables::kSummaries,
        tables::kEven, tables::kComponents, tables::kContacts, tables::kTileLayers, tables::kObjects,
        tables::kWideTiles, tables::kPresence, tables::kPassedRays, tables::kOverruled, tables::kStated,
        tables::kScanPoints, tables::kScansToCome})
    transaction.forEachBlock(table, "", [&](std::string_view key, std::string_view bytes) {
      blocks[std::string(table) + "/" + std::string(key)] = std::string(bytes);
    });
  for (const std::string key : {"rule structure", "rule numbers"})
    blocks["meta/" + key] = transaction.block(tables::kMeta, key).value_or("");
  blocks["meta/ways"] = transaction.block(tables::kMeta, "ways").value_or("");
  return blocks;
}

/// The tables in which two maps differ, each with the number of its rows that do.
inline std::map<std::string, int> differingTables(const std::filesystem::path& a, const std::filesystem::path& b) {
  const auto in_a = storedBlocks(a), in_b = storedBlocks(b);
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

/// How many objects a change reports, by kind.
inline std::map<std::string, std::size_t> countsOf(const ObjectChanges& changes) {
  return {{"unchanged", changes.unchanged},       {"added", changes.added.size()}, {"gone", changes.gone.size()},
          {"changed", changes.changed.size()},    {"split", changes.split.size()}, {"joined", changes.joined.size()},
          {"redecided", changes.redecided.size()}};
}

/// How changes are computed.
enum class How : std::uint8_t {
  Around,    ///< in a window, however large
  InStrips,  ///< everything anew, strip by strip
  Growing,   ///< what is new strip by strip
};

class StreetChanges {
 public:
  StreetChanges(const StreetScans& scans, unsigned seed, How how) : scans_(scans), random_(seed), how_(how) {
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

  /// Most scans go, and many come at once: in bands of tiles, and decided strip by strip.
  std::string grow() {
    std::vector<ScanId> gone;
    while (there_.size() > 3) {
      const auto scan = std::next(there_.begin(), static_cast<std::ptrdiff_t>(below(there_.size())));
      gone.push_back(scans_.idOf(scan->first));
      there_.erase(scan);
    }
    if (!gone.empty()) retractScans(map(), gone, inParts(), silence());
    std::map<std::size_t, int> fresh;
    for (std::size_t scan = 0; scan < scans_.size(); ++scan)
      if (!there_.contains(scan) && below(6) != 0) fresh[scan] = static_cast<int>(below(2));
    ChangeParams params = inParts();
    if (below(3) != 0) params.max_window_share = 2;  // else what changes most of the map is decided as a whole
    const std::filesystem::path copy = folder_.path() / "copy.clx";
    std::filesystem::copy_file(map(), copy, std::filesystem::copy_options::overwrite_existing);
    const ChangeReport report = extendMap(map(), scans_.at(fresh, folder_.path()), params, silence());
    const ChangeReport at_once = extendMap(copy, scans_.at(fresh, folder_.path()), {.max_window_share = 2}, silence());
    EXPECT_EQ(countsOf(report.objects), countsOf(at_once.objects)) << "the report follows the strips";
    if (report.tiles_decided > report.tiles) ++computed_;  // beside strips twice
    there_.merge(fresh);
    return "grow in bands of " + std::to_string(params.stage_points) + " points";
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

  /// Something is exchanged that is no number of a rule, or back again: what small patches of ground are, what a sign's
  /// face may be, whether rays count that pass bushes.
  std::string changeMore() {
    const auto exchange = [](std::string& text, std::pair<std::string, std::string> parts) {
      if (text.find(parts.first) == std::string::npos) std::swap(parts.first, parts.second);
      const std::size_t at = text.find(parts.first);
      if (at == std::string::npos) throw std::logic_error("the shipped rules lack '" + parts.first + "'");
      text.replace(at, parts.first.size(), parts.second);
      return parts.second;
    };
    const std::string barrier = "\nclx:Bush rdfs:subClassOf clx:Barrier .\n";
    std::string done;
    switch (below(3)) {
      case 0:
        done = exchange(inputs_.rules.front().text, {"no: { accept: { merge_into: class, confidence: 0.80 } }",
                                                     "no: { reject: \"a small patch\" }"});
        break;
      case 1:
        done = exchange(inputs_.rules.front().text, {"sign_fittings: { from: { label_in: [column, ",
                                                     "sign_fittings: { from: { label_in: [scatter, column, "});
        break;
      default:
        std::string& text = inputs_.ontology.back().text;
        done = barrier;
        if (text.find(barrier) == std::string::npos)
          text += barrier;
        else
          text.erase(text.find(barrier), barrier.size());
    }
    note(applyInputs(
        map(), [&](const MapInputs&) { return inputs_; }, params(), silence()));
    return done;
  }

  /// The ontology gets another class, which no rule makes.
  std::string addAClass() {
    const std::string name = "Hut" + std::to_string(random_());
    inputs_.ontology.back().text += "\nclx:" + name + " a owl:Class ; rdfs:subClassOf clx:Building .\n";
    note(applyInputs(
        map(), [&](const MapInputs&) { return inputs_; }, params(), silence()));
    return "add " + name;
  }

  void expectBuildFromScratch(const std::string& after) {
    const std::filesystem::path fresh = folder_.path() / "fresh.clx";
    std::filesystem::remove(fresh);  // a map that is replaced hands on its statements
    build(fresh);
    EXPECT_TRUE(canonicalText(map()) == canonicalText(fresh)) << "after " << after;
    EXPECT_THAT(differingTables(map(), fresh), testing::IsEmpty()) << "after " << after;
  }

  /// Changes that were computed the way that was asked for.
  std::size_t computed() const { return computed_; }

 private:
  std::filesystem::path map() const { return folder_.path() / "map.clx"; }
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(random_() % count); }
  ChangeParams params() {
    const unsigned threads = 1 + static_cast<unsigned>(below(2));
    const std::uint64_t stage_points = below(2) == 0 ? 1 : kStagePoints;
    if (how_ == How::Around) return {.threads = threads, .stage_points = stage_points, .max_window_share = 2};
    return {
        .threads = threads, .stage_points = stage_points, .max_window_share = 0, .whole_cluxels = 100U << 2 * below(3)};
  }
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
  /// In bands and strips.
  ChangeParams inParts() {
    ChangeParams params{.threads = 1 + static_cast<unsigned>(below(2)), .whole_cluxels = 50U << below(5)};
    params.stage_points = below(2) == 0 ? 1 : 30'000;
    return params;
  }
  void note(const ChangeReport& report) {
    const bool is_in_strips = report.local_commits == 0 && report.tiles_decided > report.tiles;  // beside strips twice
    computed_ += how_ == How::InStrips ? (is_in_strips ? 1 : 0) : report.local_commits;
  }
  void build(const std::filesystem::path& file) {
    BuildParams params{.force = true};
    if (std::filesystem::exists(map())) params.statements = operatorStatements(MapReader(map()).quads());
    buildMap(scans_.at(there_, folder_.path()), inputs_, file, params, silence());
  }

  const StreetScans& scans_;
  std::mt19937 random_;
  MapInputs inputs_ = shippedInputs();
  ScratchFolder folder_;
  std::map<std::size_t, int> there_;  ///< scan → number of its pose
  How how_;
  std::size_t computed_ = 0;
};

}  // namespace cluxel::mapping
