// SPDX-License-Identifier: Apache-2.0
// Adds scans to a map file in batches; each becomes part of the map in one transaction, from points to facts.
#include "mapping/build/map_builder.hpp"
#include "mapping/build/batch_size.hpp"
#include "mapping/stored_grid.hpp"

#include <algorithm>
#include <future>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "base/free_memory.hpp"
#include "base/utc_time.hpp"
#include "cluxel/error.hpp"
#include "mapping/build/build_poses.hpp"
#include "mapping/build/early_commit.hpp"
#include "mapping/build/operator_statements.hpp"
#include "mapping/build/stage_clock.hpp"
#include "mapping/build/work_file.hpp"
#include "mapping/change/map_compaction.hpp"
#include "mapping/change/map_things.hpp"
#include "mapping/clouds/scan_reader.hpp"
#include "mapping/clouds/scan_store.hpp"
#include "mapping/facts/map_history.hpp"
#include "mapping/facts/semantic_layer.hpp"
#include "mapping/inference/infer_facts.hpp"
#include "mapping/inference/sparql_rules.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/map_state.hpp"
#include "mapping/statements/named_resources.hpp"
#include "mapping/statements/stated_values.hpp"
#include "mapping/window/semantic_update.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::mapping {

namespace fs = std::filesystem;

namespace {

/// All clouds of an unfinished build must be among the given scans, otherwise the map would hold scans that were not
/// given. Loads scans until every cloud is found; when the same command is repeated, these are the first ones.
void requireScansOf(const WorkFile& work, const scan::ScanSet& scans, const std::vector<Cloud>& clouds) {
  std::set<scan::ScanId> given;
  std::size_t loaded = 0;
  for (const Cloud& cloud : clouds) {
    while (!given.contains(cloud.id) && loaded < scans.size()) given.insert(scans.load(loaded++).id);
    if (!given.contains(cloud.id))
      throw Error(ErrorKind::InvalidArgument,
                  work.path().string() + ": holds an unfinished build of other scans ('" + cloud.source +
                      "' is not among those given); repeat that command to finish it, or remove the file");
  }
}

/// Objects without members: nothing was there before, so that they are compared with nothing.
std::vector<ObjectMembers> namesOfObjects(const rdf::ReadTransaction& transaction) {
  std::vector<ObjectMembers> names;
  forEachRecord(transaction, [&](const ContentHash& id, const ObjectRecord& record) {
    names.push_back({id, record.class_iri, {}});
  });
  return names;
}

/// The scans that a build is given, to tell those that are given more than once.
class GivenScans {
 public:
  void add(const Cloud& cloud) {
    const auto [first, is_new] = first_.emplace(cloud.id, Given{cloud.source, cloud.time_s});
    if (is_new) return;
    if (repeated_++ == 0) example_ = cloud.source + " is the same scan as " + first->second.source;
    if (cloud.time_s != first->second.time_s) ++other_times_;
  }

  /// Empty when each is given once.
  std::string note() const {
    if (repeated_ == 0) return {};
    const std::string note = std::to_string(repeated_) + " of " + std::to_string(first_.size() + repeated_) +
                             " scans were given before and are not added again (" + example_ +
                             (repeated_ > 1 ? ", ...)" : ")");
    if (other_times_ == 0) return note;
    return note + "; " + std::to_string(other_times_) + " of them have other times, of which the latest is kept";
  }

 private:
  struct Given {
    std::string source;
    std::optional<double> time_s;
  };
  std::map<scan::ScanId, Given> first_;
  std::size_t repeated_ = 0, other_times_ = 0;
  std::string example_;
};

class MapBuild {
 public:
  MapBuild(const scan::ScanSet& scans, ScanReader& reader, const ParsedInputs& parsed, WorkFile& work,
           const BuildParams& params, ProgressSink& sink)
      : scans_(scans),
        reader_(reader),
        parsed_(parsed),
        work_(work),
        params_(params),
        sink_(sink),
        state_(work.found()),
        stages_(parsed.model, parsed.inputs.params, Keep::Summaries, params.stage_points) {}

  BuildReport run() {
    goOn();
    for (std::size_t next = 0; next < scans_.size();) {
      if (next > 0) work_.reopen(), returnFreeMemory();
      try {
        next = addBatch(next);
      } catch (...) {
        dropEarlyCommit([&] { return work_.environment().write(); }, sink_);
        throw;
      }
    }
    for (const std::string& note : reading_notes_.totals()) sink_.note(note);
    if (const std::string note = given_.note(); !note.empty()) sink_.note(note);
    return report_;
  }

 private:
  /// Checks that stored scans belong to this build.
  void goOn() {
    const std::vector<Cloud> there = storedClouds(work_.environment().read());
    if (there.empty()) return;
    requireScansOf(work_, scans_, there);
    sink_.note("continues the build of " + work_.path().string() + ": " + std::to_string(there.size()) + " of " +
               std::to_string(scans_.size()) + " scans are stored");
  }

  /// Detects another writer between two commits, in case it did not use the lock.
  void requireOwn(const rdf::ReadTransaction& transaction) const {
    if (storedState(transaction) != state_)
      throw Error(
          ErrorKind::StoreUnavailable,
          work_.path().string() + ": another build has written to it meanwhile; wait until it has ended and run again");
  }

  /// The scans since the last commit.
  struct OpenBatch {
    rdf::WriteTransaction transaction;
    PointChanges changes = {};
    std::vector<scan::ScanId> added = {};
    std::uint64_t points = 0, points_to_commit = 0;  ///< of `added`; of those whose points are not committed yet
    bool has_later_times = false;                    ///< of known scans
  };

  rdf::WriteTransaction beginBatch() {
    rdf::WriteTransaction begun = work_.environment().write();
    begun.useThreads(params_.threads);
    requireOwn(begun);
    storeGrid(begun, parsed_.inputs.tileGrid());
    return begun;
  }

  /// Adds scans from `first` on until the batch is full, and commits; returns the first scan of the next batch.
  std::size_t addBatch(std::size_t first) {
    const double started_s = secondsNow();
    StageClock clock(sink_);
    OpenBatch batch{beginBatch()};
    eraseEarlyCommit(batch.transaction);
    std::size_t next = first;
    for (;
         next < scans_.size() && !isFull(batch.points, batch.added.size(), scans_.size() - next, params_.batch_points);
         ++next) {
      store(reader_.take(next), batch);
      commitMany(batch);
      clock.progress("scans", next + 1, scans_.size());
    }
    if (batch.points > 0 || next == scans_.size()) commitBatch(batch, next == scans_.size(), started_s, clock);
    return next;
  }

  void store(ReadScan given, OpenBatch& batch) {
    for (const std::string& note : reading_notes_.add(given.reading)) sink_.note(note);
    given_.add(given.scan.cloud);
    const std::uint64_t points = given.scan.cloud.point_count;
    const scan::ScanId id = given.scan.cloud.id;
    report_.given.push_back(id);
    const std::optional<double> time_s = given.scan.cloud.time_s;
    const std::optional<Cloud> known = storedCloud(batch.transaction, id);
    auto segments = storeScan(batch.transaction, std::move(given.scan));
    if (segments.empty()) {
      ++report_.scans_already_there;
      batch.has_later_times = batch.has_later_times || (known && time_s > known->time_s);
    } else {
      batch.added.push_back(id);
      batch.points += points, batch.points_to_commit += points;
    }
    batch.changes.add(std::move(segments), params_.stage_points);
    batch.changes.is_alone = !batch.has_later_times;
  }

  /// Points of many scans are committed early.
  void commitMany(OpenBatch& batch) {
    if (!batch.changes.mayCommitEarly() || batch.points_to_commit < params_.stage_points) return;
    commitPoints(batch.added, batch.transaction, [this] { return beginBatch(); });
    batch.points_to_commit = 0;
  }

  void commitBatch(OpenBatch& batch, bool is_last, double started_s, StageClock& clock) {
    rdf::WriteTransaction& transaction = batch.transaction;
    const bool commits_early = batch.changes.mayCommitEarly();
    stages_.update(transaction, std::move(batch.changes), params_.threads, clock);
    if (commits_early) commitOutputs(batch.added, stages_.changedTiles(), transaction, [this] { return beginBatch(); });
    stages_.dropPoints();
    returnFreeMemory();
    if (is_last) work_.takeOverStatements(transaction, params_.drop_statements, sink_);
    if (is_last) addOperatorStatements(transaction, params_.statements);
    const SemanticUpdate layers = updateSemanticLayer(transaction, parsed_, stages_, ChangedInputs::Scans,
                                                      {.threads = params_.threads, .lists_objects = false}, clock);
    if (!is_last) stages_.dropIfMany();
    returnFreeMemory();
    const std::vector<Cloud> clouds = storedClouds(transaction);
    if (const std::string note = summaryOf(layers.statements); !note.empty()) sink_.note(note);
    storeInputs(transaction, parsed_.inputs);
    state_ = MapState{is_last, parsed_.inputs.hash().hex()};
    storeState(transaction, *state_);
    if (is_last) writeThings(transaction, dateTimeText(secondsNow()), {}, namesOfObjects(transaction));
    const auto policy = params_.threads > 1 ? std::launch::async : std::launch::deferred;
    const auto freed = std::async(policy, [&] {  // beside LMDB, which uses one thread
      if (is_last) stages_.dropAll();
    });
    transaction.writeIndexes();
    clock.progress("indexes", 1, 1);
    addActivity(transaction, {"build", started_s, secondsNow(), clock.seconds()}, clouds, parsed_.inputs);
    transaction.commit();
    report_.scans = clouds.size();
    report_.points = 0;
    for (const Cloud& cloud : clouds) report_.points += cloud.point_count;
    report_.tiles = storedTiles(work_.environment().read()).size();
    report_.cluxels = layers.cluxels, report_.primitives = layers.primitives;
    report_.objects = layers.objects;
    report_.quads = rdf::QuadReader(work_.environment().read()).size();
  }

  const scan::ScanSet& scans_;
  ScanReader& reader_;
  const ParsedInputs& parsed_;
  WorkFile& work_;
  const BuildParams& params_;
  ProgressSink& sink_;
  scan::ReadingNotes reading_notes_{scans_.remedies()};
  GivenScans given_;
  std::optional<MapState> state_;  ///< the state in the file after the last commit
  TileStages stages_;
  BuildReport report_;
};

BuildReport built(const scan::ScanSet& scans, const MapInputs& inputs, const fs::path& file, const BuildParams& params,
                  ProgressSink& sink) {
  if (scans.size() == 0) throw Error(ErrorKind::InvalidArgument, "there is no scan to build a map from");
  ScanReader early(scans, params.threads);
  if (!params.refine_poses) early.begin(0);  // beside what comes before the first scan is stored
  MapInputs complete = inputs;
  complete.map_origin = scans.mapOrigin();
  complete.crs = scans.crs();
  sink.note(describeFiles(complete));
  if (!complete.crs.empty()) sink.note("coordinate system of the map: " + complete.crs);
  checkNewSparqlRules(complete.sparql_rules);
  const rdf::OntologyView ontology = ontologyOf(complete.ontology);
  noteUnknownNames(complete.sparql_rules, ontology, sink);
  noteUnusedAxioms(complete.ontology, sink);
  const ParsedInputs parsed = parseNewInputs(complete, ontology);
  noteSharedLabels(ontology, sink);
  // A faulty statement is refused before anything is written.
  for (const Statement& statement : statementsAmong(params.statements)) {
    try {
      requireStatableOrKept(statement, parsed.rules.catalogue, sink);
    } catch (const Error& fault) {
      throw Error(ErrorKind::FaultyInput, "operator statement " + statement.id().hex() + ": " + fault.what());
    }
  }
  const auto about_objects = std::count_if(params.statements.begin(), params.statements.end(),
                                           [](const Quad& quad) { return namesObject(quad.subject); });
  if (about_objects > 0)
    sink.note(
        std::to_string(about_objects) +
        " quads are about objects by their names, which only a map knows: they change no object, now or later. To "
        "state them of objects, build without them, and load them into the finished map");
  WorkFile work(file, complete.hash().hex(), params.force);
  if (!params.refine_poses) noteDoubtfulPoses(scans, params.threads, sink);
  const scan::ScanSet posed = params.refine_poses ? withRefinedPoses(scans, params.threads, sink) : scans;
  ScanReader refined(posed, params.threads);
  ScanReader& reader = params.refine_poses ? refined : early;
  const BuildReport report = MapBuild(posed, reader, parsed, work, params, sink).run();
  work.finish();
  return report;
}

}  // namespace

BuildReport buildMap(const scan::ScanSet& scans, const MapInputs& inputs, const fs::path& file,
                     const BuildParams& params, ProgressSink& sink) {
  const BuildReport report = built(scans, inputs, file, params, sink);
  compactIfSparse(file, sink);  // each batch leaves the outputs of the one before
  return report;
}

}  // namespace cluxel::mapping
