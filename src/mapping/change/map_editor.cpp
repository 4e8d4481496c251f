// SPDX-License-Identifier: Apache-2.0
// Opens a map for changes and commits them.
#include "mapping/change/map_editor.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "base/file_bytes.hpp"
#include "base/free_memory.hpp"
#include "base/utc_time.hpp"
#include "cluxel/error.hpp"
#include "mapping/build/batch_size.hpp"
#include "mapping/build/early_commit.hpp"
#include "mapping/build/stage_clock.hpp"
#include "mapping/change/map_things.hpp"
#include "mapping/facts/map_history.hpp"
#include "mapping/facts/told_ways.hpp"
#include "mapping/layers/semantic_state.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/map_state.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/strips/map_strips.hpp"
#include "mapping/window/former_objects.hpp"
#include "rules/decide/local_reach.hpp"

namespace cluxel::mapping {

namespace fs = std::filesystem;

namespace {

/// Tells a file from one that has taken its name; 0 when there is none.
ino_t inodeOf(const fs::path& file) {
  struct stat status {};
  return ::stat(file.c_str(), &status) == 0 ? status.st_ino : 0;
}

/// Tiles that are decided in one commit. LMDB keeps the memory of as many pages as its largest transaction has written:
/// after a large commit the file is opened again.
constexpr std::size_t kLargeCommit = 200;

/// A token in the cache of a commit tells whether the commit is still the newest.
constexpr const char* kPauseToken = "pause of a map editor";

std::shared_ptr<rdf::Environment> openAs(const fs::path& file, rdf::OpenMode mode) {
  if (!mayBeThere(file))
    throw Error(ErrorKind::StoreUnavailable, file.string() + ": there is no such map; build it first");
  return rdf::Environment::open(file, mode);
}
std::shared_ptr<rdf::Environment> openForChange(const fs::path& file) {
  return openAs(file, rdf::OpenMode::ReadWrite);
}

bool worksOnCopy(const fs::path& file, const ChangeParams& params) {
  return params.dry_run && mayBeThere(file) && !mayWriteMap(file);
}

bool reachTiles(const MapInputs& before, const MapInputs& after) {
  MapInputs with_new_tiles = before;
  with_new_tiles.model = after.model;
  with_new_tiles.params = after.params;
  return with_new_tiles.hash() != before.hash();
}

/// Whether only what the stages compute of tiles follows from the difference.
bool endsInTiles(const MapInputs& before, const MapInputs& after) {
  MapInputs with_new_tiles = before;
  with_new_tiles.model = after.model;
  with_new_tiles.params = after.params;
  with_new_tiles.params.relation = before.params.relation;
  return with_new_tiles.hash() == after.hash();
}

ChangedInputs changeOf(const MapInputs& before, const MapInputs& after) {
  MapInputs with_new_rules = before;
  with_new_rules.sparql_rules = after.sparql_rules;
  if (rules::haveSameClasses(classCatalogueOf(before.ontology), classCatalogueOf(after.ontology)))
    with_new_rules.ontology = after.ontology;
  if (with_new_rules.hash() == after.hash()) return ChangedInputs::Inference;
  with_new_rules.rules = after.rules;
  with_new_rules.rule_roots = after.rule_roots;
  return with_new_rules.hash() == after.hash() ? ChangedInputs::Rules : ChangedInputs::Any;
}

}  // namespace

void requireChangeable(const fs::path& file, const ChangeParams& params) {
  const fs::path target = withoutLinks(file);
  const auto environment = openAs(target, rdf::OpenMode::ReadOnly);
  std::optional<BuildLock> lock;  // that a build is running is told before that it is unfinished
  if (!worksOnCopy(target, params)) lock.emplace(target);
  requireFinishedInputs(environment->read(), file);
}

std::string noteOfCopy(const fs::path& file) {
  return file.string() + ": you may not write it or its folder; the dry run works on a copy in " +
         temporaryFolderPath().string();
}

void tellMap(ChangeReport& report, const rdf::ReadTransaction& transaction) {
  const SemanticState state = storedSemanticState(transaction).value_or(SemanticState{});
  report.objects.unchanged = report.object_count = state.objects;
  report.cluxels = state.cluxels, report.primitives = state.primitives;
  report.scans = state.clouds.size();
  report.tiles = storedTiles(transaction).size();
}

void tellObjects(ChangeReport& report, DifferentObjects different) {
  report.before = std::move(different.before), report.after = std::move(different.after);
  report.objects = compareStates(report.before, report.after, report.object_count - report.after.size());
  report.objects.unchanged -= different.redecided.size();
  report.objects.redecided = std::move(different.redecided);
}

MapEditor::MapEditor(const fs::path& file, const ChangeParams& params, ProgressSink& sink)
    : file_(withoutLinks(file)), params_(params), sink_(sink) {
  if (worksOnCopy(file_, params)) {
    requireChangeable(file, params);  // before the map is copied
    sink.note(noteOfCopy(file));
    environment_ = rdf::Environment::temporaryCopyOf(file_);
  } else {
    lock_.emplace(file_);
    environment_ = openForChange(file_);
    inode_ = inodeOf(file_);
  }
  parsed_ = parseInputs(requireFinishedInputs(environment_->read(), file));
  inputs_hash_ = parsed_.inputs.hash().hex();
  tellMap(report_, environment_->read());
}

void MapEditor::setInputs(ParsedInputs inputs) {
  all_tiles_ = all_tiles_ || reachTiles(parsed_.inputs, inputs.inputs);
  // What was given before may need more.
  ends_in_tiles_ = changed_inputs_ == ChangedInputs::Scans && endsInTiles(parsed_.inputs, inputs.inputs);
  if (parsed_.inputs.hash() != inputs.inputs.hash())
    changed_inputs_ =
        std::max(changed_inputs_, inputs.rules.asks_map ? ChangedInputs::Any : changeOf(parsed_.inputs, inputs.inputs));
  stages_.reset();
  parsed_ = std::move(inputs);
}

/// What is in memory belongs to the file that was open.
void MapEditor::reopen() {
  environment_.reset();
  environment_ = openForChange(file_);
  if (inodeOf(file_) != inode_)
    throw Error(ErrorKind::StoreUnavailable,
                file_.string() + ": another program has replaced it meanwhile; run the command again");
}

rdf::WriteTransaction MapEditor::begin() {
  if (std::exchange(reopens_, false)) reopen();
  rdf::WriteTransaction transaction = beginAgain();
  eraseEarlyCommit(transaction);
  if (!std::exchange(has_begun_, true)) tellMap(report_, transaction);  // an update may have come in between
  if (defers_things_ && !std::exchange(has_own_before_, true)) {
    const std::vector<ObjectMembers> own = storedMembers(transaction);
    report_.before.insert(report_.before.begin(), own.begin(), own.end());
  }
  return transaction;
}

rdf::WriteTransaction MapEditor::beginAgain() {
  rdf::WriteTransaction transaction = environment_->write();
  const auto state = storedState(transaction);
  if (!state || !state->is_finished || state->inputs_hash != inputs_hash_)
    throw Error(ErrorKind::StoreUnavailable,
                environment_->file().string() + ": another program has changed it meanwhile; run the command again");
  transaction.useThreads(params_.threads);
  return transaction;
}

void MapEditor::update(rdf::WriteTransaction& transaction, PointChanges changes, ProgressSink& sink) {
  if (!stages_) stages_.emplace(parsed_.model, parsed_.inputs.params, Keep::All, params_.stage_points);
  touched_ = unionOf(std::move(touched_), changes.tiles());
  if (!std::exchange(all_tiles_, false))
    return noteChanged(stages_->update(transaction, std::move(changes), params_.threads, sink));
  for (TileSet& part : partsOfAll(transaction, changes.tiles())) {
    stages_->dropAll();
    noteChanged(stages_->computeAnew(transaction, std::move(part), params_.threads, sink));
  }
}

std::vector<TileSet> MapEditor::partsOfAll(const rdf::ReadTransaction& transaction, const TileSet& more) const {
  std::uint64_t points = 0;
  for (const Cloud& cloud : storedClouds(transaction)) points += cloud.point_count;
  const std::uint64_t part_points = std::max<std::uint64_t>(1, partSize(points, points, params_.stage_points));
  const std::uint64_t count = (points + part_points - 1) / part_points;
  // The bytes of its points tell what a tile costs.
  return stripsOf(unionOf(TileSet(more), storedTiles(transaction)), count, [&](const perception::TileKey& tile) {
    const auto block = transaction.block(tables::kPoints, tables::keyOf(tile));
    return block ? block->size() : 0;
  });
}

SemanticUpdate MapEditor::decide(rdf::WriteTransaction& transaction, PointChanges changes,
                                 const std::vector<Cloud>& scans, ProgressSink& sink) {
  const ChangedInputs inputs = std::exchange(changed_inputs_, ChangedInputs::Scans);
  if (all_tiles_ && ends_in_tiles_ && rules::localReach(parsed_.rules).reach_m) {
    touched_ = unionOf(std::move(touched_), changes.tiles());
    if (std::vector<TileSet> parts = partsOfAll(transaction, changes.tiles()); parts.size() > 1)
      return decideInParts(transaction, std::move(parts), sink);
  }
  const bool commits_early = changes.mayCommitEarly();
  update(transaction, std::move(changes), sink);
  if (commits_early) commitOutputs(idsOf(scans), stages_->changedTiles(), transaction, [&] { return beginAgain(); });
  return updateSemanticLayer(transaction, parsed_, *stages_, inputs, layerParams(), sink);
}

/// After each part the map follows from the outputs that its tiles have then. So only what follows from the part has to
/// be decided. A statement may find no object while its points lie in a later part; it is applied when that part comes.
/// When a part cannot be decided alone, the rest is decided with it as a whole.
SemanticUpdate MapEditor::decideInParts(rdf::WriteTransaction& transaction, std::vector<TileSet> parts,
                                        ProgressSink& sink) {
  all_tiles_ = false;
  stages_.emplace(parsed_.model, parsed_.inputs.params, Keep::All, params_.stage_points);
  ObjectDifference difference;
  SemanticUpdate update;
  bool is_local = true;
  std::size_t decided = 0;
  UpdateParams params = layerParams();
  params.is_first_of_commit = false;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    noteChanged(stages_->computeAnew(transaction, std::move(parts[i]), params_.threads, sink));
    if (!is_local && i + 1 < parts.size()) {
      stages_->dropAll();
      continue;
    }
    update = updateSemanticLayer(transaction, parsed_, *stages_, is_local ? ChangedInputs::Scans : ChangedInputs::Any,
                                 params, sink);
    stages_->dropAll();
    difference.add(std::move(static_cast<DifferentObjects&>(update)));
    is_local = is_local && update.is_local;
    decided += update.tiles_decided;
    addWholeRules(update.whole_rules, report_.rules_evaluated_whole, sink);
  }
  update.is_local = is_local, update.tiles_decided = decided;
  static_cast<DifferentObjects&>(update) = std::move(difference).take();
  return update;
}

void MapEditor::commit(rdf::WriteTransaction& transaction, const std::string& operation, PointChanges changes,
                       const std::vector<Cloud>& scans) {
  const double started_s = secondsNow();
  StageClock clock(sink_);
  SemanticUpdate layers = decide(transaction, std::move(changes), scans, clock);
  has_decided_ = true;
  const bool is_large = layers.tiles_decided > kLargeCommit;
  if (stages_) stages_->dropIfMany();
  returnFreeMemory();
  inputs_hash_ = parsed_.inputs.hash().hex();
  storeInputs(transaction, parsed_.inputs);
  storeState(transaction, MapState{true, inputs_hash_});
  const Activity activity{operation, started_s, secondsNow(), clock.seconds()};
  last_activity_ = addActivity(transaction, activity, scans, parsed_.inputs);
  if (!defers_things_) {
    addLineage(transaction, last_activity_, compareStates(layers.before, layers.after));
    std::vector<ContentHash> made;
    for (const ObjectMembers& object : layers.after) made.push_back(object.id);
    removeEndsOf(transaction, made);
    writeThings(transaction, dateTimeText(activity.ended_s), layers.before, layers.after, keptBy(transaction, layers));
  }
  report(transaction, layers);
  note(std::move(layers));
  if (params_.dry_run) return;
  transaction.commit();
  has_decided_ = false;
  reopens_ = is_large;
  try {
    report_.free_space = rdf::freeSpaceOf(environment_->read());
  } catch (const Error& error) {
    sink_.note(file_.string() + ": the change is written, but its free space is not known: " + error.what());
  }
}

void MapEditor::note(SemanticUpdate update) {
  if (!defers_things_) difference_.add(std::move(static_cast<DifferentObjects&>(update)));
}

ChangeReport MapEditor::takeReport() {
  report_.class_names = namesOf(parsed_.rules.catalogue);
  if (!defers_things_ && report_.has_changes) tellObjects(report_, std::exchange(difference_, {}).take());
  return std::move(report_);
}

void MapEditor::writeDeferredThings(const NamesInMaps& names) {
  rdf::WriteTransaction transaction = begin();
  report_.after = storedMembers(transaction);
  // Several maps may have the same object.
  std::stable_sort(report_.before.begin(), report_.before.end(),
                   [](const auto& a, const auto& b) { return a.id < b.id; });
  report_.before.erase(std::unique(report_.before.begin(), report_.before.end(),
                                   [](const auto& a, const auto& b) { return a.id == b.id; }),
                       report_.before.end());
  report_.objects = compareObjects(report_.before, report_.after);
  noteStatements();
  if (!last_activity_.empty()) addLineage(transaction, last_activity_, report_.objects);
  removeEndsOf(transaction, storedObjectIds(transaction));
  writeThingsOfMerge(transaction, dateTimeText(secondsNow()), report_.before, report_.after, names);
  keepToldWays(transaction);
  if (!params_.dry_run) transaction.commit();
}

/// A snapshot of the file that has the name now.
rdf::QuadReader MapEditor::newest() const {
  return rdf::QuadReader(openForChange(file_)->read());
}

void MapEditor::pause() {
  paused_at_ = std::make_shared<int>();
  newest().keep(kPauseToken, paused_at_);
  lock_.reset();
}

bool MapEditor::resume() {
  if (!lock_) lock_.emplace(file_);
  if (!paused_at_ || newest().kept(kPauseToken) != paused_at_) return false;
  report_ = {};
  has_begun_ = false;
  tellMap(report_, environment_->read());
  touched_.clear(), changed_.clear();
  difference_ = {};
  return true;
}

void MapEditor::noteStatements() const {
  if (const std::string note = summaryOf(report_.statements); !note.empty()) sink_.note(note);
}

void MapEditor::report(const rdf::ReadTransaction& transaction, const SemanticUpdate& update) {
  tellMap(report_, transaction);
  report_.has_changes = true;
  report_.tiles_touched = touched_.size();
  report_.tiles_changed = changed_.size();
  report_.statements = update.statements;
  report_.local_commits += update.is_local ? 1 : 0;
  report_.maps_taken_over += update.took_decisions ? 1 : 0;
  report_.tiles_decided += update.tiles_decided;
  addWholeRules(update.whole_rules, report_.rules_evaluated_whole, sink_);
  if (!defers_things_) noteStatements();
}

}  // namespace cluxel::mapping
