// SPDX-License-Identifier: Apache-2.0
// The largest map is copied, and the scans of the others are added to the copy.
#include "mapping/change/map_merge.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "mapping/build/operator_statements.hpp"
#include "mapping/change/map_change.hpp"
#include "mapping/change/map_compaction.hpp"
#include "mapping/change/map_things.hpp"
#include "mapping/change/place_order.hpp"
#include "mapping/change/scan_additions.hpp"
#include "mapping/clouds/merged_scans.hpp"
#include "mapping/facts/map_history.hpp"
#include "mapping/map_reader.hpp"
#include "mapping/map_state.hpp"
#include "mapping/merged_replacement.hpp"
#include "mapping/statements/statement_history.hpp"
#include "mapping/window/former_objects.hpp"
#include "mapping/window/lent_decisions.hpp"
#include "rdf/file/file_guards.hpp"
#include "rdf/file/map_replacement.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {

namespace fs = std::filesystem;

namespace {

/// File names differ between machines, and mean nothing: except those of SPARQL rules, which stand in the facts.
std::vector<std::string> textsOf(const std::vector<NamedText>& named, bool with_names = false) {
  std::vector<std::string> texts;
  for (const NamedText& text : named) texts.push_back((with_names ? ruleFileName(text) + "\n" : "") + text.text);
  return texts;
}

std::vector<std::string> differencesBetween(const MapInputs& a, const MapInputs& b) {
  std::vector<std::string> differences;
  if (textsOf(a.ontology) != textsOf(b.ontology)) differences.emplace_back("ontology");
  if (textsOf(a.rules) != textsOf(b.rules) || a.rule_roots != b.rule_roots ||
      textsOf(a.sparql_rules, true) != textsOf(b.sparql_rules, true))
    differences.emplace_back("rules");
  if (a.model.text != b.model.text) differences.emplace_back("model");
  if (perception::hashOf(a.params) != perception::hashOf(b.params)) differences.emplace_back("settings");
  return differences;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

class Merge {
 public:
  Merge(const std::vector<MapToMerge>& maps, const fs::path& target, const MergeParams& params, ProgressSink& sink)
      : maps_(maps),
        target_(withoutLinks(target)),
        beside_(target_.string() + ".merging"),
        params_(params),
        sink_(sink) {
    if (!params.change.dry_run || mayWriteMap(target_)) {
      lock_.emplace(target_);
      return;
    }
    temporary_.emplace();
    beside_ = temporary_->path() / beside_.filename();
  }

  Merge(const Merge&) = delete;
  Merge& operator=(const Merge&) = delete;
  ~Merge() { removeBeside(); }

  ChangeReport run() {
    if (maps_.size() < 2) throw Error(ErrorKind::InvalidArgument, "a merge needs at least two maps");
    requireDifferentFiles();
    for (const MapToMerge& map : maps_) readers_.emplace_back(map.file);
    requireEqualInputs();
    base_ = largest();
    requireMapOrNothing(target_);
    if (fs::exists(target_) && !params_.force) return reportOfMerged();
    if (!params_.drop_statements) requireStatementsKept(target_, quadsOfMaps());
    requireScansToFit();
    removeBeside();
    if (temporary_) sink_.note(noteOfCopy(target_));
    ChangeReport report = mergeBeside();
    if (!params_.change.dry_run) replaceByMerged(beside_, target_, params_.drop_statements, sink_);
    return report;
  }

 private:
  void requireDifferentFiles() const {
    std::error_code error;
    for (std::size_t i = 0; i < maps_.size(); ++i) {
      if (!fs::exists(maps_[i].file, error)) continue;  // opening it tells
      if (fs::exists(target_) && fs::equivalent(maps_[i].file, target_))
        throw Error(ErrorKind::InvalidArgument,
                    target_.string() + ": is one of the maps; name another file, or extend that map");
      for (std::size_t j = 0; j < i; ++j)
        if (fs::equivalent(maps_[i].file, maps_[j].file, error))
          throw Error(ErrorKind::InvalidArgument, maps_[i].file.string() + ": is named twice");
    }
  }

  void requireEqualInputs() const {
    const MapInputs first = readers_.front().inputs();
    for (std::size_t i = 0; i < readers_.size(); ++i) {
      const auto environment = rdf::Environment::open(maps_[i].file, rdf::OpenMode::ReadOnly);
      const MapInputs mine = requireFinishedInputs(environment->read(), maps_[i].file);
      const bool moved = maps_[i].has_transform || !maps_[i].T_first_map.matrix().isIdentity(0);
      if (!moved) requireSameFrame(maps_[i].file, mine, maps_[0].file, first);
      const auto differences = differencesBetween(first, mine);
      if (!differences.empty() && !params_.use)
        throw Error(ErrorKind::InvalidArgument,
                    maps_[i].file.string() + ": differs from " + maps_[0].file.string() +
                        " in: " + joined(differences) + "; choose the map whose ontology, rules and model are used",
                    Remedy::ChooseInputs);
    }
  }

  void requireScansToFit() const {
    ScansOfMaps scans;
    for (std::size_t i = 0; i < maps_.size(); ++i)
      scans.add(maps_[i].file.string(), readers_[i].clouds(), maps_[i].T_first_map,
                maps_[i].has_transform || !maps_[i].T_first_map.matrix().isIdentity(0));
  }

  /// A command that was killed after it had replaced the target may be repeated.
  ChangeReport reportOfMerged() {
    if (!isMerged()) throw Error(ErrorKind::InvalidArgument, target_.string() + ": exists already", Remedy::ReplaceMap);
    sink_.note(target_.string() + ": is the merge of these maps already");
    ChangeReport report;
    const MapReader merged(target_);
    report.scans = report.scans_already_there = merged.clouds().size();
    report.tiles = storedTiles(merged.transaction()).size();
    report.objects.unchanged = report.object_count = merged.objectIds().size();
    return report;
  }

  /// A map is a function of its inputs: the target is the result when it has those of the result. What the maps did
  /// before, which things have which names among it, must have gone into it, too.
  bool isMerged() const {
    try {
      const auto environment = rdf::Environment::open(target_, rdf::OpenMode::ReadOnly);
      if (requireFinishedInputs(environment->read(), target_).hash() != inputsOfResult().hash()) return false;
      const MapReader target(target_);
      const std::set<std::string> activities = activitiesIn(target.quads());
      std::map<scan::ScanId, ScanInputs> scans;
      for (std::size_t i = 0; i < maps_.size(); ++i) {
        const std::set<std::string> own = activitiesIn(readers_[i].quads());
        if (!std::includes(activities.begin(), activities.end(), own.begin(), own.end())) return false;
        if (!addScanInputs(readers_[i].clouds(), maps_[i].T_first_map, scans)) return false;
      }
      std::map<scan::ScanId, ScanInputs> merged;
      addScanInputs(target.clouds(), Eigen::Isometry3d::Identity(), merged);
      return merged == scans && canonicalTextsOf(operatorStatements(target.quads())) == textsOfResult();
    } catch (const Error&) {
      return false;  // no map, or one of another version
    }
  }

  /// The canonical texts of graph `operator` of the result.
  std::set<std::string> textsOfResult() const {
    std::set<std::string> withdrawn, texts;
    for (const ContentHash& id : withdrawnAmong(quadsOfMaps())) withdrawn.insert(rdf::iriOfStatement(id));
    for (const MapReader& reader : readers_) {
      std::vector<Quad> quads = operatorStatements(reader.quads());
      std::erase_if(quads, [&](const Quad& quad) { return withdrawn.contains(quad.subject.text); });
      texts.merge(canonicalTextsOf(quads));
    }
    return texts;
  }

  /// Whether the tiles of a map lie as those of the result, so that they can be taken.
  bool hasTilesOfResult(std::size_t i) const {
    return maps_[i].T_first_map.matrix().isIdentity(0) &&
           readers_[i].inputs().tileGrid() == inputsOfResult().tileGrid();
  }

  /// Of the maps in the frame of the result, the one with most points: its scans need no new stages.
  std::size_t largest() const {
    std::size_t best = 0;
    for (std::size_t i = 1; i < maps_.size(); ++i)
      if (hasTilesOfResult(i) && readers_[i].summary().points > readers_[best].summary().points) best = i;
    return best;
  }

  ChangeReport mergeBeside() {
    try {
      rdf::Environment::open(maps_[base_].file, rdf::OpenMode::ReadOnly)
          ->compactTo(beside_, rdf::CopiedPages::AsTheyAre);
      return addOthers();
    } catch (const rdf::NoSpaceLeft& error) {
      throw Error(ErrorKind::StoreUnavailable, error.fault() + "; " + target_.string() +
                                                   " is not written, and the maps that were to be merged are as they "
                                                   "were: free some space and run again");
    }
  }

  ChangeReport addOthers() {
    ChangeParams change = params_.change;
    change.dry_run = false;  // the copy may be written: it becomes the target only at the end
    MapEditor editor(beside_, change, sink_);
    if (editor.inputs().inputs.hash() != readers_[base_].inputs().hash())
      throw Error(ErrorKind::StoreUnavailable,
                  maps_[base_].file.string() + ": another program has changed it meanwhile; run the command again");
    editor.setInputs(parseInputs(inputsOfResult()));
    ScanAdditions additions(editor, "merge", kStagePoints);
    editor.deferThings();
    for (std::size_t i = 0; i < maps_.size(); ++i)
      if (i != base_) copyOperatorStatements(readers_[i].quads(), additions.transaction(), blankSuffixOf(i));
    const std::vector<NamesOfMap> names = namesOfMaps();
    copyHistories(names, quadsOfMaps(), base_, additions.transaction());
    leaveOutWithdrawn(additions);
    removeDuplicatesOfBlankNodes(additions.transaction());
    std::vector<std::size_t> others;
    for (std::size_t i = 0; i < maps_.size(); ++i) {
      if (i == base_) continue;
      const std::vector<ObjectMembers> other =
          storedMembers(readers_[i].transaction(), motionsBy(maps_[i].T_first_map, readers_[i].clouds()));
      editor.result().before.insert(editor.result().before.end(), other.begin(), other.end());
      if (isLender(i, additions))
        additions.copy(readers_[i].transaction(), true);
      else
        others.push_back(i);
    }
    for (const std::size_t i : others) addMap(i, additions);
    additions.finish();
    editor.writeDeferredThings(namesIn(names));
    return editor.takeReport();
  }

  std::vector<NamesOfMap> namesOfMaps() const {
    std::vector<NamesOfMap> names;
    for (const MapReader& reader : readers_) names.push_back(namesOfMap(reader.quads(), reader.objectIds()));
    return names;
  }

  /// An older copy of a map does not bring back what was withdrawn since.
  void leaveOutWithdrawn(ScanAdditions& additions) {
    const std::vector<ContentHash> withdrawn = withdrawnAmong(quadsOfMaps());
    std::vector<std::string> ids;
    eraseStatements(additions.transaction(), withdrawn);
    for (const ContentHash& id : withdrawn) ids.push_back(id.hex());
    if (ids.empty()) return;
    sink_.note(std::to_string(ids.size()) +
               " operator statements are left out, because one of the maps has withdrawn " + "them: " + joined(ids) +
               "; state them again to have them");
  }

  std::vector<const rdf::QuadReader*> quadsOfMaps() const {
    std::vector<const rdf::QuadReader*> maps;
    for (const MapReader& reader : readers_) maps.push_back(&reader.quads());
    return maps;
  }

  /// Keeps the blank nodes of the maps apart: names a map by its scans, in digits. Those of the largest map stay.
  std::string blankSuffixOf(std::size_t number) const {
    if (number == base_) return "";
    ContentHasher hasher;
    for (const Cloud& cloud : readers_[number].clouds()) hasher.add(cloud.id);
    return "of" + std::to_string(number) + hasher.finish().hex().substr(0, 8);
  }

  MapInputs inputsOfResult() const {
    MapInputs inputs = readers_.at(params_.use.value_or(0)).inputs();
    inputs.map_origin = readers_.front().inputs().map_origin;
    inputs.crs = readers_.front().inputs().crs;
    return inputs;
  }

  /// Whether a map lends its tiles: it has the frame, model and settings of the result.
  bool isAlike(std::size_t number) const {
    const MapInputs own = inputsOfResult(), inputs = readers_[number].inputs();
    return hasTilesOfResult(number) && own.model.text == inputs.model.text &&
           perception::hashOf(own.params) == perception::hashOf(inputs.params);
  }

  /// Whether what a map decided is taken, too. That is a commit, which small maps are not worth.
  bool isLender(std::size_t number, ScanAdditions& additions) const {
    const MapInputs own = inputsOfResult(), inputs = readers_[number].inputs();
    const std::uint64_t points = readers_[number].summary().points;
    const bool is_large =
        points > params_.change.batch_points.value_or(kStagePoints) || points > readers_[base_].summary().points / 8;
    return is_large && isAlike(number) && own.map_origin == inputs.map_origin && own.crs == inputs.crs &&
           differencesBetween(own, inputs).empty() &&
           canLendDecisions(additions.transaction(), readers_[number].transaction(), params_.change.max_window_share,
                            params_.max_border_tiles);
  }

  /// Copies the scans and tiles of a map that fits into one batch. Of others the scans are added one by one.
  void addMap(std::size_t number, ScanAdditions& additions) {
    if (!isAlike(number) || readers_[number].summary().points > params_.change.batch_points.value_or(kStagePoints))
      return addScans(number, additions);
    additions.copy(readers_[number].transaction(), false);
  }

  void addScans(std::size_t number, ScanAdditions& additions) {
    std::vector<Cloud> clouds = readers_[number].clouds();
    const auto place_of = [&](const Cloud& cloud) -> Eigen::Vector2d {
      return (maps_[number].T_first_map * Eigen::Vector3d((cloud.min + cloud.max) / 2)).head<2>();
    };
    sortAlongLongerSide(clouds, place_of, [](const Cloud& cloud) { return cloud.id; });
    for (std::size_t i = 0; i < clouds.size(); ++i) {
      scan::Scan scan = readers_[number].scanOf(clouds[i].id);
      scan.T_map_sensor = maps_[number].T_first_map * scan.T_map_sensor;
      additions.add(scan, clouds.size() - i - 1);
      sink_.progress("scans", i + 1, clouds.size());
    }
  }

  void removeBeside() const {
    std::error_code ignored;
    for (const char* end : {"", "-lock"}) fs::remove(beside_.string() + end, ignored);
  }

  const std::vector<MapToMerge>& maps_;
  fs::path target_, beside_;
  std::optional<BuildLock> lock_;
  std::optional<rdf::TemporaryFolder> temporary_;  ///< of a dry run that may not write beside the target
  const MergeParams& params_;
  ProgressSink& sink_;
  std::vector<MapReader> readers_;
  std::size_t base_ = 0;  ///< the map that is copied
};

}  // namespace

ChangeReport mergeMaps(const std::vector<MapToMerge>& maps, const fs::path& target, const MergeParams& params,
                       ProgressSink& sink) {
  ChangeReport report = Merge(maps, target, params, sink).run();
  if (!params.change.dry_run) compactIfSparse(target, sink);
  return report;
}

}  // namespace cluxel::mapping
