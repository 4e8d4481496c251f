// SPDX-License-Identifier: Apache-2.0
// The operations in terms of MapEditor: they add and remove segments, and commit.
#include "mapping/change/map_change.hpp"

#include <algorithm>
#include <functional>
#include <set>

#include "cluxel/error.hpp"
#include "mapping/build/batch_size.hpp"
#include "mapping/change/map_compaction.hpp"
#include "mapping/change/place_order.hpp"
#include "mapping/change/scan_additions.hpp"
#include "mapping/facts/map_history.hpp"
#include "mapping/inference/infer_facts.hpp"
#include "mapping/inference/sparql_rules.hpp"
#include "mapping/map_state.hpp"
#include "mapping/origin_text.hpp"
#include "mapping/stored_grid.hpp"

namespace cluxel::mapping {

namespace fs = std::filesystem;

namespace {

void requireOnce(const std::vector<scan::ScanId>& scans) {
  std::set<scan::ScanId> seen;
  for (const scan::ScanId& id : scans)
    if (!seen.insert(id).second) throw Error(ErrorKind::InvalidArgument, "cloud " + id.hex() + " is named twice");
}

}  // namespace

void requireFrame(const MapInputs& map, const scan::ScanSet& scans) {
  // A set that names no origin and no coordinate system lies in the map frame.
  const bool other_origin = !scans.mapOrigin().isZero(0) && scans.mapOrigin() != map.map_origin;
  const bool other_crs = !scans.crs().empty() && scans.crs() != map.crs;
  std::string differences;
  if (other_crs)
    differences = "the scans' coordinate system is not the map's: theirs is " + scans.crs() + ", the map's " +
                  (map.crs.empty() ? "none" : map.crs) + "; ";
  if (other_origin)
    differences += "the scans' map_origin is not the map's: theirs is " + originText(scans.mapOrigin()) +
                   ", the map's " + originText(map.map_origin) + "; ";
  if (!differences.empty())
    throw Error(ErrorKind::InvalidArgument,
                differences + "give them in the map's frame, or build the map anew from all scans");
  if (!scans.crs().empty() && scans.mapOrigin().isZero(0) && !map.map_origin.isZero(0))
    throw Error(ErrorKind::InvalidArgument,
                "the scans name the map's coordinate system but not its map_origin, so that their coordinates may be "
                "the outer ones; name map_origin in a manifest: the map's is " +
                    originText(map.map_origin));
}

void requireSameFrame(const fs::path& file, const MapInputs& map, const fs::path& other_file, const MapInputs& other) {
  const auto frameOf = [](const MapInputs& of_map) {
    return "map_origin " + originText(of_map.map_origin) + " and coordinate system " +
           (of_map.crs.empty() ? "none" : of_map.crs);
  };
  if (map.map_origin != other.map_origin || map.crs != other.crs)
    throw Error(ErrorKind::InvalidArgument,
                file.string() + ": has another map origin or coordinate system than " + other_file.string() + ": " +
                    frameOf(map) + ", there " + frameOf(other) + "; name the transform between the frames",
                Remedy::NameTransform);
}

namespace {

void requireScans(const scan::ScanSet& scans) {
  if (scans.size() == 0) throw Error(ErrorKind::InvalidArgument, "there is no scan to add");
}

/// What of an operation in batches was committed before an error.
void noteDone(const MapEditor& editor, std::size_t scans, const std::string& done) {
  if (scans > 0 && !editor.params().dry_run)
    editor.sink().note(std::to_string(scans) + (scans == 1 ? " scan was " : " scans were ") + done +
                       " before the error; the same command goes on from there");
}

ChangeReport addBy(MapEditor& editor, const scan::ScanSet& scans) {
  ProgressSink& sink = editor.sink();
  requireFrame(editor.inputs().inputs, scans);
  ScanAdditions additions(editor, "extend", kBatchPoints);
  scan::ReadingNotes notes(scans.remedies());
  try {
    for (std::size_t i = 0; i < scans.size(); ++i) {
      const scan::LoadedScan loaded = scans.read(i);
      for (const std::string& note : notes.add(loaded.reading)) sink.note(note);
      additions.add(loaded.scan, scans.size() - i - 1);
      editor.result().given.push_back(loaded.scan.id);
      sink.progress("scans", i + 1, scans.size());
    }
    additions.finish();
  } catch (...) {
    additions.drop();
    noteDone(editor, editor.result().scans_added, "added");
    throw;
  }
  for (const std::string& note : notes.totals()) sink.note(note);
  return editor.takeReport();
}

ChangeReport addedTo(const fs::path& file, const scan::ScanSet& scans, const ChangeParams& params, ProgressSink& sink) {
  requireScans(scans);
  MapEditor editor(file, params, sink);
  return addBy(editor, scans);
}

/// The clouds of these scans, from place to place. Scans that an earlier command retracted, perhaps this one before it
/// was killed, are only noted.
std::vector<Cloud> cloudsToRetract(const std::vector<scan::ScanId>& scans, const rdf::ReadTransaction& transaction,
                                   ProgressSink& sink) {
  std::optional<std::vector<RetractedScan>> retracted;
  const auto isRetracted = [&](const scan::ScanId& id) {
    if (!retracted) retracted = retractedScans(transaction);
    const auto scan = std::find_if(retracted->begin(), retracted->end(), [&](const auto& one) { return one.id == id; });
    if (scan == retracted->end()) return false;
    const std::string source = scan->sources.empty() ? "" : " ('" + scan->sources.front() + "')";
    sink.note("cloud " + id.hex() + source + " was retracted already, on " + scan->time);
    return true;
  };
  std::vector<Cloud> clouds;
  for (const scan::ScanId& id : scans) {
    std::optional<Cloud> cloud = storedCloud(transaction, id);
    if (!cloud && isRetracted(id)) continue;
    clouds.push_back(cloud ? *std::move(cloud) : requiredCloud(transaction, id));
  }
  sortAlongLongerSide(
      clouds, [](const Cloud& cloud) { return Eigen::Vector2d((cloud.min + cloud.max).head<2>() / 2); },
      [](const Cloud& cloud) { return cloud.id; });
  return clouds;
}

/// The size of batches in which these clouds of the map move or go, in points. They are one batch when batches would
/// compute each tile more than twice on average, for instance when all scans see the same place.
std::uint64_t batchSizeOf(const std::vector<Cloud>& clouds, const rdf::ReadTransaction& transaction,
                          std::uint64_t max_points) {
  std::uint64_t points = 0, map_points = 0, batch_points = 0;
  for (const Cloud& cloud : clouds) points += cloud.point_count;
  for (const Cloud& cloud : storedClouds(transaction)) map_points += cloud.point_count;
  const std::uint64_t size = partSize(points, map_points, max_points);
  const TileSet tiles = storedTiles(transaction);
  const perception::TileGrid grid = storedGrid(transaction);
  TileSet all, of_batch;
  std::size_t computed = 0, scans = 0;
  for (std::size_t i = 0; i < clouds.size(); ++i) {
    of_batch.merge(tilesInBounds(clouds[i], tiles, grid));
    batch_points += clouds[i].point_count;
    const std::size_t left = clouds.size() - i - 1;
    if (left > 0 && !isFull(batch_points, ++scans, left, size)) continue;
    computed += of_batch.size();
    all.merge(std::exchange(of_batch, {}));
    batch_points = 0, scans = 0;
  }
  return computed > 2 * all.size() ? std::max<std::uint64_t>(points, 1) : size;
}

/// Clouds that reach most of the map go together when nothing else is asked for: all is decided anew, once.
std::uint64_t usualBatchOf(const std::vector<Cloud>& clouds, const rdf::ReadTransaction& transaction) {
  const TileSet tiles = storedTiles(transaction);
  const perception::TileGrid grid = storedGrid(transaction);
  TileSet reached;
  for (const Cloud& cloud : clouds) reached.merge(tilesInBounds(cloud, tiles, grid));
  return 2 * reached.size() > tiles.size() ? kBatchPoints : kStagePoints;
}

/// The name of an operation in the history, what it has done with a scan, and the points of a batch.
struct Batches {
  std::string operation, done;
  std::uint64_t points = 0;
};

/// Changes one scan in a transaction, and gives its cloud for the history.
using ScanChange = std::function<Cloud(rdf::WriteTransaction&, std::size_t scan, PointChanges&)>;

/// Changes `scans` scans, and commits batch by batch. `changed` counts those that are committed.
void changeInBatches(MapEditor& editor, rdf::WriteTransaction first, std::size_t scans, const Batches& batches,
                     std::size_t& changed, const ScanChange& change) {
  std::optional<rdf::WriteTransaction> transaction(std::move(first));
  PointChanges changes;
  std::vector<Cloud> of_batch;
  std::uint64_t points = 0;
  try {
    for (std::size_t i = 0; i < scans; ++i) {
      if (!transaction) transaction.emplace(editor.begin());
      of_batch.push_back(change(*transaction, i, changes));
      points += of_batch.back().point_count;
      editor.sink().progress("scans", i + 1, scans);
      const std::size_t left = scans - i - 1;
      if (left > 0 && !isFull(points, of_batch.size(), left, batches.points)) continue;
      editor.commit(*transaction, batches.operation, std::exchange(changes, {}), of_batch);
      changed += of_batch.size();
      of_batch.clear();
      points = 0;
      if (!editor.params().dry_run) transaction.reset();
    }
  } catch (...) {
    noteDone(editor, changed, batches.done);
    throw;
  }
}

ChangeReport removedFrom(const fs::path& file, const std::vector<scan::ScanId>& scans, const ChangeParams& params,
                         ProgressSink& sink) {
  requireOnce(scans);
  MapEditor editor(file, params, sink);
  rdf::WriteTransaction transaction = editor.begin();
  const std::vector<Cloud> clouds = cloudsToRetract(scans, transaction, sink);
  if (clouds.size() == storedClouds(transaction).size())
    throw Error(ErrorKind::InvalidArgument, file.string() + ": no scan would be left; remove the file instead");
  const std::uint64_t batch_points =
      batchSizeOf(clouds, transaction, params.batch_points.value_or(usualBatchOf(clouds, transaction)));
  changeInBatches(editor, std::move(transaction), clouds.size(), {"retract", "retracted", batch_points},
                  editor.result().scans_removed, [&](rdf::WriteTransaction& now, std::size_t i, PointChanges& changes) {
                    changes.anew = unionOf(std::move(changes.anew), removeScan(now, clouds[i].id));
                    return clouds[i];
                  });
  return editor.takeReport();
}

/// A scan that gets another pose.
struct Move {
  ScanPose pose;
  Cloud before;
};

/// Those poses that scans do not have yet, from place to place.
std::vector<Move> movesTo(const std::vector<ScanPose>& poses, const rdf::ReadTransaction& transaction) {
  std::vector<Move> moves;
  for (const ScanPose& pose : poses) {
    Cloud cloud = requiredCloud(transaction, pose.scan);
    if (cloud.has_pose && cloud.T_map_sensor.matrix() == pose.T_map_sensor.matrix()) continue;
    moves.push_back({pose, std::move(cloud)});
  }
  sortAlongLongerSide(
      moves, [](const Move& move) { return move.pose.T_map_sensor.translation().head<2>(); },
      [](const Move& move) { return move.pose.scan; });
  return moves;
}

ChangeReport movedIn(const fs::path& file, const std::vector<ScanPose>& poses, const ChangeParams& params,
                     ProgressSink& sink) {
  std::vector<scan::ScanId> named;
  for (const ScanPose& pose : poses) named.push_back(pose.scan);
  requireOnce(named);
  MapEditor editor(file, params, sink);
  rdf::WriteTransaction transaction = editor.begin();
  const std::vector<Move> moves = movesTo(poses, transaction);
  std::vector<Cloud> before;
  for (const Move& move : moves) before.push_back(move.before);
  const std::uint64_t batch_points = batchSizeOf(before, transaction, params.batch_points.value_or(kStagePoints));
  const auto move = [&](rdf::WriteTransaction& now, std::size_t i, PointChanges& changes) {
    // Points that stay where they are change no tile, but what a sensor sees decides, too.
    if (!moves[i].before.has_pose) editor.decideAnew();
    scan::Scan scan = storedScan(now, moves[i].pose.scan);
    scan.T_map_sensor = moves[i].pose.T_map_sensor;
    scan.has_pose = true;
    changes.anew = unionOf(std::move(changes.anew), removeScan(now, scan.id));
    for (const auto& [tile, segment] : storeScan(now, scan)) {
      changes.anew.insert(tile);
      changes.stored_points[tile] += segment.size();
    }
    return requiredCloud(now, scan.id);
  };
  changeInBatches(editor, std::move(transaction), moves.size(), {"repose", "moved", batch_points},
                  editor.result().scans_moved, move);
  return editor.takeReport();
}

ChangeReport appliedTo(const fs::path& file, const std::function<MapInputs(MapInputs)>& change,
                       const ChangeParams& params, ProgressSink& sink) {
  MapEditor editor(file, params, sink);
  MapInputs inputs = change(editor.inputs().inputs);
  inputs.map_origin = editor.inputs().inputs.map_origin;
  inputs.crs = editor.inputs().inputs.crs;
  if (inputs.hash() == editor.inputs().inputs.hash()) return editor.takeReport();
  const MapInputs& before = editor.inputs().inputs;
  const bool has_new_queries = inputs.sparql_rules != before.sparql_rules;
  if (has_new_queries) checkNewSparqlRules(inputs.sparql_rules);
  const bool has_new_ontology = inputs.ontology != before.ontology;
  const rdf::OntologyView ontology = ontologyOf(inputs.ontology);
  if (has_new_queries || has_new_ontology) noteUnknownNames(inputs.sparql_rules, ontology, sink);
  if (has_new_ontology) {
    noteUnusedAxioms(inputs.ontology, sink);
    noteSharedLabels(ontology, sink);
  }
  const bool has_new_rules = inputs.rules != before.rules || has_new_ontology;
  editor.setInputs(has_new_rules ? parseNewInputs(inputs, ontology) : parseInputs(inputs));
  rdf::WriteTransaction transaction = editor.begin();
  editor.commit(transaction, "rules apply", {}, {});
  return editor.takeReport();
}

/// Frees the space that a committed change has left, where it is too much.
ChangeReport compacted(ChangeReport report, const fs::path& file, const ChangeParams& params, ProgressSink& sink) {
  if (params.dry_run || !params.may_compact) return report;
  if (report.has_changes)
    freeSpaceOfChange(file, report.free_space, sink);
  else
    finishCompaction(file, sink);
  return report;
}

}  // namespace

ChangeReport extendMap(const fs::path& file, const scan::ScanSet& scans, const ChangeParams& params,
                       ProgressSink& sink) {
  return compacted(addedTo(file, scans, params, sink), file, params, sink);
}

ChangeReport MapExtension::add(const scan::ScanSet& scans) {
  requireScans(scans);
  try {
    if (editor_ && !editor_->resume()) editor_.reset();
    if (!editor_) editor_.emplace(file_, params_, sink_);
    ChangeReport report = addBy(*editor_, scans);
    editor_->pause();
    return report;
  } catch (...) {
    editor_.reset();  // it may hold what was not committed
    throw;
  }
}

ChangeReport retractScans(const fs::path& file, const std::vector<scan::ScanId>& scans, const ChangeParams& params,
                          ProgressSink& sink) {
  return compacted(removedFrom(file, scans, params, sink), file, params, sink);
}

ChangeReport moveScans(const fs::path& file, const std::vector<ScanPose>& poses, const ChangeParams& params,
                       ProgressSink& sink) {
  return compacted(movedIn(file, poses, params, sink), file, params, sink);
}

ChangeReport applyInputs(const fs::path& file, const std::function<MapInputs(MapInputs)>& change,
                         const ChangeParams& params, ProgressSink& sink) {
  return compacted(appliedTo(file, change, params, sink), file, params, sink);
}

}  // namespace cluxel::mapping
