// SPDX-License-Identifier: Apache-2.0
// Opens a map for changes and commits them.
#include "mapping/change/map_editor.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "base/file_bytes.hpp"
#include "base/utc_time.hpp"
#include "cluxel/error.hpp"
#include "mapping/build/stage_clock.hpp"
#include "mapping/change/map_things.hpp"
#include "mapping/facts/map_history.hpp"
#include "mapping/map_state.hpp"
#include "mapping/object_store.hpp"

namespace cluxel::mapping {

namespace fs = std::filesystem;

namespace {

/// A token in the cache of a commit tells whether the commit is still the newest.
constexpr const char* kRestToken = "rest of a map editor";

double secondsNow() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

std::shared_ptr<rdf::Environment> openForChange(const fs::path& file) {
  if (!fs::exists(file))
    throw Error(ErrorKind::StoreUnavailable, file.string() + ": there is no such map; build it first");
  return rdf::Environment::open(file, rdf::OpenMode::ReadWrite);
}

bool reachTiles(const MapInputs& before, const MapInputs& after) {
  MapInputs with_new_tiles = before;
  with_new_tiles.model = after.model;
  with_new_tiles.params = after.params;
  return with_new_tiles.hash() != before.hash();
}

}  // namespace

MapEditor::MapEditor(const fs::path& file, const ChangeParams& params, ProgressSink& sink)
    : file_(withoutLinks(file)), lock_(file_), environment_(openForChange(file_)), params_(params), sink_(sink) {
  parsed_ = parseInputs(requireFinishedInputs(environment_->read(), file));
  inputs_hash_ = parsed_.inputs.hash().hex();
  readBefore(environment_->read());
}

/// Another process may change objects by an update until the first write transaction begins; the stages it leaves.
void MapEditor::readBefore(const rdf::ReadTransaction& transaction) {
  if (!stages_) {
    stages_.emplace(parsed_.model, parsed_.inputs.params);
    stages_->load(transaction);
  }
  const perception::SceneSeeds seeds = stages_->seeds();
  report_.before = report_.after = membersOf(storedObjects(transaction), seeds);
  report_.objects.unchanged = report_.after.size();
  own_before_ = report_.before.size();
  report_.scans = storedClouds(transaction).size();
  report_.tiles = stages_->summaries().size();
  report_.cluxels = seeds.seed.size();
  report_.primitives = storedDigests(transaction).size();  // there is one for each primitive
}

void MapEditor::setInputs(ParsedInputs inputs) {
  all_tiles_ = all_tiles_ || reachTiles(parsed_.inputs, inputs.inputs);
  stages_.reset();
  parsed_ = std::move(inputs);
}

rdf::WriteTransaction MapEditor::begin() {
  rdf::WriteTransaction transaction = environment_->write();
  const auto state = storedState(transaction);
  if (!state || !state->is_finished || state->inputs_hash != inputs_hash_)
    throw Error(ErrorKind::StoreUnavailable,
                environment_->file().string() + ": another program has changed it meanwhile; run the command again");
  if (!present_) {
    const std::vector<rules::SemanticObject> objects = storedObjects(transaction);
    const bool is_same = std::equal(objects.begin(), objects.end(), report_.before.begin(), report_.before.end(),
                                    [](const auto& now, const auto& before) { return now.id == before.id; });
    if (!is_same) readBefore(transaction);  // an update came in between
    present_ = report_.before;
  }
  return transaction;
}

void MapEditor::update(rdf::WriteTransaction& transaction, PointChanges changes, ProgressSink& sink) {
  if (!stages_) stages_.emplace(parsed_.model, parsed_.inputs.params);
  touched_ = unionOf(std::move(touched_), changes.tiles());
  const TileSet changed = all_tiles_ ? stages_->updateAll(transaction, std::move(changes), params_.threads, sink)
                                     : stages_->update(transaction, std::move(changes), params_.threads, sink);
  changed_.insert(changed.begin(), changed.end());
  all_tiles_ = false;
}

void MapEditor::commit(rdf::WriteTransaction& transaction, const std::string& operation, PointChanges changes,
                       const std::vector<Cloud>& scans) {
  const double started_s = secondsNow();
  StageClock clock(sink_);
  update(transaction, std::move(changes), clock);
  stages_->load(transaction);
  const SemanticLayer layer = writeSemanticLayer(transaction, parsed_, *stages_, params_.threads, clock);
  inputs_hash_ = parsed_.inputs.hash().hex();
  storeInputs(transaction, parsed_.inputs);
  storeState(transaction, MapState{true, inputs_hash_});
  report(transaction, layer);
  const Activity activity{operation, started_s, secondsNow(), clock.seconds()};
  const ObjectChanges lineage = compareStates(*present_, report_.after);
  const bool is_all = !has_committed_ && report_.before.size() == own_before_;
  report_.objects = is_all ? lineage : compareObjects(report_.before, report_.after);
  has_committed_ = true;
  addLineage(transaction, addActivity(transaction, activity, scans, parsed_.inputs), lineage);
  if (!names_at_end_) writeThings(transaction, dateTimeText(activity.ended_s), *present_, report_.after);
  present_ = report_.after;
  if (!params_.dry_run) transaction.commit();
}

void MapEditor::handOnNames() {
  rdf::WriteTransaction transaction = begin();
  writeThings(transaction, dateTimeText(secondsNow()), report_.before, report_.after, ObjectsOf::SeveralMaps);
  if (!params_.dry_run) transaction.commit();
}

/// A snapshot of the file that has the name now.
rdf::QuadReader MapEditor::newest() const {
  return rdf::QuadReader(openForChange(file_)->read());
}

void MapEditor::rest() {
  rested_at_ = std::make_shared<int>();
  newest().keep(kRestToken, rested_at_);
  lock_.reset();
}

bool MapEditor::resume() {
  if (!lock_) lock_.emplace(file_);
  if (!rested_at_ || !present_ || newest().kept(kRestToken) != rested_at_) return false;
  ChangeReport next;
  next.scans = report_.scans, next.tiles = report_.tiles;
  next.cluxels = report_.cluxels, next.primitives = report_.primitives;
  next.objects.unchanged = own_before_ = present_->size();
  next.before = next.after = *std::exchange(present_, std::nullopt);  // begin() sees whether an update came in between
  touched_.clear(), changed_.clear();
  has_committed_ = false;
  report_ = std::move(next);
  return true;
}

void MapEditor::report(const rdf::ReadTransaction& transaction, const SemanticLayer& layer) {
  report_.has_changes = true;
  report_.tiles_touched = touched_.size();
  report_.tiles_changed = changed_.size();
  report_.scans = storedClouds(transaction).size();
  report_.tiles = stages_->summaries().size();
  report_.cluxels = layer.scene.cluxels.size();
  report_.primitives = layer.scene.primitives.size();
  report_.after = membersOf(layer.objects, layer.scene.cluxels);
  report_.statements = layer.statements;
  if (const std::string note = summaryOf(layer.statements); !note.empty()) sink_.note(note);
}

}  // namespace cluxel::mapping
