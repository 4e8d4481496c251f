// SPDX-License-Identifier: Apache-2.0
// A finished map opened for changes of its inputs. After every commit, readers see the exact map of them.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cluxel/progress.hpp"
#include "mapping/build/build_lock.hpp"
#include "mapping/build/tile_stages.hpp"
#include "mapping/change/object_changes.hpp"
#include "mapping/clouds/scan_store.hpp"
#include "mapping/facts/semantic_layer.hpp"
#include "mapping/window/semantic_update.hpp"
#include "rdf/file/space/layer_sizes.hpp"

namespace cluxel::mapping {

struct ChangeParams {
  unsigned threads = 1;
  /// A batch is committed when it holds this many points. Absent: kBatchPoints where scans are added, or most of the
  /// map loses some; else kStagePoints.
  std::optional<std::uint64_t> batch_points = {};
  bool dry_run = false;                       ///< compute what would change, and write nothing
  std::uint64_t stage_points = kStagePoints;  ///< batches of more than 1.5 times as many go through the stages in bands
  bool may_compact = true;                    ///< rewrite the map when the change leaves much free space
  double max_window_share = UpdateParams{}.max_window_share;  ///< this and the next as in UpdateParams
  std::uint64_t whole_cluxels = UpdateParams{}.whole_cluxels;
  bool takes_given_times = false;  ///< a known scan gets the latest time given for it, also an earlier one
};

struct ChangeReport {
  bool has_changes = false;  ///< something was committed, or would be without dry_run
  std::size_t scans_added = 0, scans_already_there = 0, scans_removed = 0, scans_moved = 0;
  std::size_t scans_retimed = 0;    ///< known scans that got another time
  std::vector<scan::ScanId> given;  ///< where scans are added: those that were given, in their order
  std::size_t tiles_touched = 0;    ///< a scan's points in them changed
  std::size_t tiles_changed = 0;    ///< the output of some stage changed
  std::size_t tiles_decided = 0;    ///< in which the rules ran again; summed over the commits
  std::size_t scans = 0, tiles = 0, cluxels = 0, primitives = 0, object_count = 0;  ///< of the map afterwards
  /// The objects that differ; of a merge all objects of all maps, and all of the result.
  std::vector<ObjectMembers> before, after;
  ObjectChanges objects;
  std::vector<StatementOutcome> statements;  ///< what became of the operator's
  std::size_t local_commits = 0;             ///< of which objects and facts were computed around the change alone
  std::size_t maps_taken_over = 0;           ///< of a merge: maps of which objects and facts were taken
  /// SPARQL rules that the change evaluated for the whole map: they cost as much as in a build.
  std::vector<WholeRule> rules_evaluated_whole;
  rdf::FreeSpace free_space;    ///< of the map afterwards
  rdf::ClassNames class_names;  ///< of the map's ontology afterwards
};

/// Counts what the map has now.
void tellMap(ChangeReport& report, const rdf::ReadTransaction& transaction);
/// Tells what became of the objects that differ, after tellMap().
void tellObjects(ChangeReport& report, DifferentObjects different);

/// Throws the Errors of MapEditor, before anything else is read. Cost: reads the inputs of the map.
void requireChangeable(const std::filesystem::path& file, const ChangeParams& params);

/// What a user is told when a dry run works on a copy.
std::string noteOfCopy(const std::filesystem::path& file);

class MapEditor {
 public:
  /// Takes the build lock and reads the inputs. A dry run of a map that this process may not write works on a temporary
  /// copy. Throws Error: InvalidArgument for an unfinished map or one that another version of the stages has made,
  /// StoreUnavailable when the file cannot be written or is being written.
  MapEditor(const std::filesystem::path& file, const ChangeParams& params, ProgressSink& sink);

  const ParsedInputs& inputs() const { return parsed_; }
  /// Changes the inputs beside the scans; the next commit computes the map anew as far as they reach: a new model or
  /// new settings reach everything, rules and ontology the layers above the scene. No scan may be removed in the same
  /// commit as other inputs are set.
  void setInputs(ParsedInputs inputs);

  /// The next commit decides about everything anew, because of what the outputs of tiles do not tell.
  void decideAnew() { changed_inputs_ = ChangedInputs::Any; }

  /// Begins a write transaction, and erases in it what early commits of a killed command left.
  rdf::WriteTransaction begin();
  /// Begins anew after an early commit.
  rdf::WriteTransaction beginAgain();
  /// Brings the stages up to date after points changed, so that these can be given in several parts before commit().
  void update(rdf::WriteTransaction& transaction, PointChanges changes, ProgressSink& sink);
  /// Brings all layers up to date after points changed, and commits unless this is a dry run. `operation` names the
  /// change in the history ("extend"), and `scans` those it was about.
  void commit(rdf::WriteTransaction& transaction, const std::string& operation, PointChanges changes,
              const std::vector<Cloud>& scans);

  /// For merges: commits write no things. writeDeferredThings() does it once, from the objects of all maps in
  /// result().before and their names in the maps.
  void deferThings() { defers_things_ = true; }
  void writeDeferredThings(const NamesInMaps& names);

  /// Ends a change and gives up the build lock; what was read and computed stays in memory for the next change.
  void pause();
  /// Begins another change, with a report of its own. False when the map has changed since pause(): then this editor is
  /// of no use. Throws as the constructor when another program is changing the map.
  bool resume();

  /// The report so far, without what became of the objects.
  ChangeReport& result() { return report_; }
  /// The whole report, at the end of a change. Cost: that of compareStates().
  ChangeReport takeReport();
  ProgressSink& sink() const { return sink_; }
  const ChangeParams& params() const { return params_; }

 private:
  /// Brings the stages and what follows from them up to date.
  SemanticUpdate decide(rdf::WriteTransaction& transaction, PointChanges changes, const std::vector<Cloud>& scans,
                        ProgressSink& sink);
  SemanticUpdate decideInParts(rdf::WriteTransaction& transaction, std::vector<TileSet> parts, ProgressSink& sink);
  /// All tiles of the map and `more`, in parts that go through the stages at once.
  std::vector<TileSet> partsOfAll(const rdf::ReadTransaction& transaction, const TileSet& more) const;
  void noteChanged(const TileSet& tiles) { changed_.insert(tiles.begin(), tiles.end()); }
  rdf::QuadReader newest() const;
  void note(SemanticUpdate update);
  void report(const rdf::ReadTransaction& transaction, const SemanticUpdate& update);
  void noteStatements() const;
  /// Opens the file again. Throws Error (StoreUnavailable) when another has taken its name.
  void reopen();
  UpdateParams layerParams() const {
    UpdateParams params{params_.threads, params_.max_window_share, params_.whole_cluxels};
    params.is_first_of_commit = !has_decided_;
    return params;
  }

  std::filesystem::path file_;
  std::optional<BuildLock> lock_;
  std::shared_ptr<rdf::Environment> environment_;
  std::shared_ptr<const void> paused_at_;  ///< names the commit that was the newest then
  const ChangeParams& params_;
  ProgressSink& sink_;
  ParsedInputs parsed_;
  std::string inputs_hash_;    ///< as stored in the file
  std::string last_activity_;  ///< IRI of the run that the last commit was
  bool defers_things_ = false;
  bool has_own_before_ = false;  ///< of a merge: report_.before holds the objects of this map
  bool all_tiles_ = false;       ///< the next commit computes every tile
  bool ends_in_tiles_ = false;   ///< and decides what follows from their outputs, as after other scans
  ChangedInputs changed_inputs_ = ChangedInputs::Scans;  ///< since the last commit
  std::optional<TileStages> stages_;
  TileSet touched_, changed_;    ///< in all commits
  ObjectDifference difference_;  ///< from before the first commit on
  bool has_begun_ = false;
  bool has_decided_ = false;  ///< since the last commit: a dry run does so several times
  bool reopens_ = false;      ///< the file is to be opened again
  ino_t inode_ = 0;           ///< of the file that is open
  ChangeReport report_;
};

}  // namespace cluxel::mapping
