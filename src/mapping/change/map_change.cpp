// SPDX-License-Identifier: Apache-2.0
// The operations in terms of MapEditor: they add and remove segments, and commit.
#include "mapping/change/map_change.hpp"

#include <algorithm>
#include <set>

#include "cluxel/error.hpp"
#include "mapping/build/batch_size.hpp"
#include "mapping/change/map_compaction.hpp"
#include "mapping/change/scan_additions.hpp"
#include "mapping/facts/map_history.hpp"
#include "mapping/map_state.hpp"

namespace cluxel::mapping {

namespace fs = std::filesystem;

namespace {

void requireOnce(const std::vector<scan::ScanId>& scans) {
  std::set<scan::ScanId> seen;
  for (const scan::ScanId& id : scans)
    if (!seen.insert(id).second) throw Error(ErrorKind::InvalidArgument, "cloud " + id.hex() + " is named twice");
}

bool isNamed(const scan::ScanId& id, const fs::path& source, const std::string& name) {
  constexpr std::size_t kMinDigits = 4;
  std::string digits = name;
  if (const std::size_t slash = name.rfind('/'); slash != std::string::npos && name.find("cloud/") != std::string::npos)
    digits = name.substr(slash + 1);
  if (digits.size() >= kMinDigits && id.hex().starts_with(digits)) return true;
  return source == name || source.filename() == name || source.stem() == name;  // "0001" may be meant as a file
}

}  // namespace

void requireFrame(const MapInputs& map, const scan::ScanSet& scans) {
  // A set that names no origin and no coordinate system lies in the map frame.
  const bool other_origin = !scans.mapOrigin().isZero(0) && scans.mapOrigin() != map.map_origin;
  const bool other_crs = !scans.crs().empty() && scans.crs() != map.crs;
  if (other_origin || other_crs)
    throw Error(ErrorKind::InvalidArgument,
                std::string("the scans' ") + (other_crs ? "coordinate system" : "map_origin") +
                    " is not the map's; give them in the map's frame, or build the map anew from all scans");
  if (!scans.crs().empty() && scans.mapOrigin().isZero(0) && !map.map_origin.isZero(0))
    throw Error(ErrorKind::InvalidArgument,
                "the scans name the map's coordinate system but not its map_origin, so that their coordinates may be "
                "the outer ones; name map_origin in a manifest");
}

namespace {

void requireScans(const scan::ScanSet& scans) {
  if (scans.size() == 0) throw Error(ErrorKind::InvalidArgument, "there is no scan to add");
}

ChangeReport addBy(MapEditor& editor, const scan::ScanSet& scans) {
  ProgressSink& sink = editor.sink();
  requireFrame(editor.inputs().inputs, scans);
  ScanAdditions additions(editor, "extend");
  scan::ReadingNotes notes(scans.remedies());
  try {
    for (std::size_t i = 0; i < scans.size(); ++i) {
      const scan::LoadedScan loaded = scans.read(i);
      for (const std::string& note : notes.add(loaded.reading)) sink.note(note);
      additions.add(loaded.scan, scans.size() - i - 1);
      sink.progress("scans", i + 1, scans.size());
    }
    additions.finish();
  } catch (...) {
    if (editor.result().scans_added > 0 && !editor.params().dry_run)
      sink.note(std::to_string(editor.result().scans_added) +
                " scans were added before the error; the same command goes on from there");
    throw;
  }
  for (const std::string& note : notes.totals()) sink.note(note);
  return std::move(editor.result());
}

ChangeReport addedTo(const fs::path& file, const scan::ScanSet& scans, const ChangeParams& params, ProgressSink& sink) {
  requireScans(scans);
  MapEditor editor(file, params, sink);
  return addBy(editor, scans);
}

/// Whether an earlier command retracted the scan, perhaps this one before it was killed.
bool noteRetracted(const rdf::ReadTransaction& transaction, const scan::ScanId& id, ProgressSink& sink) {
  for (const RetractedScan& scan : retractedScans(transaction)) {
    if (scan.id != id) continue;
    sink.note("cloud " + id.hex() + " ('" + scan.source + "') was retracted already, on " + scan.time);
    return true;
  }
  return false;
}

ChangeReport removedFrom(const fs::path& file, const std::vector<scan::ScanId>& scans, const ChangeParams& params,
                         ProgressSink& sink) {
  requireOnce(scans);
  MapEditor editor(file, params, sink);
  rdf::WriteTransaction transaction = editor.begin();
  PointChanges changes;
  std::vector<Cloud> removed;
  for (const scan::ScanId& id : scans) {
    const auto cloud = storedCloud(transaction, id);
    if (!cloud && noteRetracted(transaction, id, sink)) continue;
    changes.anew = unionOf(std::move(changes.anew), removeScan(transaction, id));
    removed.push_back(*cloud);
    sink.progress("scans", ++editor.result().scans_removed, scans.size());
  }
  if (storedClouds(transaction).empty())
    throw Error(ErrorKind::InvalidArgument, file.string() + ": no scan would be left; remove the file instead");
  if (!removed.empty()) editor.commit(transaction, "retract", std::move(changes), removed);
  return std::move(editor.result());
}

/// Poses that scans do not have yet, from place to place, so that a batch changes few tiles that others change, too.
struct Moves {
  std::vector<ScanPose> poses;
  std::uint64_t batch_points = 0;
};

Moves movesTo(const std::vector<ScanPose>& poses, const rdf::ReadTransaction& transaction, std::uint64_t max_points) {
  Moves moves;
  std::uint64_t points = 0, map_points = 0;
  Eigen::AlignedBox2d area;
  for (const ScanPose& pose : poses) {
    const Cloud cloud = requiredCloud(transaction, pose.scan);
    if (cloud.has_pose && cloud.T_map_sensor.matrix() == pose.T_map_sensor.matrix()) continue;
    moves.poses.push_back(pose);
    points += cloud.point_count;
    area.extend(Eigen::Vector2d(pose.T_map_sensor.translation().head<2>()));
  }
  const Eigen::Index axis = !moves.poses.empty() && area.sizes().y() > area.sizes().x() ? 1 : 0;
  std::sort(moves.poses.begin(), moves.poses.end(), [&](const ScanPose& a, const ScanPose& b) {
    return std::pair(a.T_map_sensor.translation()[axis], a.scan) <
           std::pair(b.T_map_sensor.translation()[axis], b.scan);
  });
  for (const Cloud& cloud : storedClouds(transaction)) map_points += cloud.point_count;
  moves.batch_points = partSize(points, map_points, max_points);
  return moves;
}

ChangeReport movedIn(const fs::path& file, const std::vector<ScanPose>& poses, const ChangeParams& params,
                     ProgressSink& sink) {
  std::vector<scan::ScanId> named;
  for (const ScanPose& pose : poses) named.push_back(pose.scan);
  requireOnce(named);
  MapEditor editor(file, params, sink);
  std::optional<rdf::WriteTransaction> transaction(editor.begin());
  const Moves moves = movesTo(poses, *transaction, params.batch_points);
  PointChanges changes;
  std::vector<Cloud> moved;
  std::uint64_t points = 0;
  for (std::size_t i = 0; i < moves.poses.size(); ++i) {
    if (!transaction) transaction.emplace(editor.begin());
    scan::Scan scan = storedScan(*transaction, moves.poses[i].scan);
    scan.T_map_sensor = moves.poses[i].T_map_sensor;
    scan.has_pose = true;
    changes.anew = unionOf(std::move(changes.anew), removeScan(*transaction, scan.id));
    for (const auto& [tile, segment] : storeScan(*transaction, scan)) changes.anew.insert(tile);
    moved.push_back(*storedCloud(*transaction, scan.id));
    points += moved.back().point_count;
    sink.progress("scans", i + 1, moves.poses.size());
    const std::size_t left = moves.poses.size() - i - 1;
    if (left > 0 && !isFull(points, moved.size(), left, moves.batch_points)) continue;
    editor.commit(*transaction, "repose", std::exchange(changes, {}), moved);
    editor.result().scans_moved += moved.size();
    moved.clear();
    points = 0;
    if (!params.dry_run) transaction.reset();
  }
  return std::move(editor.result());
}

ChangeReport appliedTo(const fs::path& file, const std::function<MapInputs(MapInputs)>& change,
                       const ChangeParams& params, ProgressSink& sink) {
  MapEditor editor(file, params, sink);
  MapInputs inputs = change(editor.inputs().inputs);
  inputs.map_origin = editor.inputs().inputs.map_origin;
  inputs.crs = editor.inputs().inputs.crs;
  if (inputs.hash() == editor.inputs().inputs.hash()) return std::move(editor.result());
  editor.setInputs(parseInputs(inputs));
  rdf::WriteTransaction transaction = editor.begin();
  editor.commit(transaction, "rules apply", {}, {});
  return std::move(editor.result());
}

/// Frees the space that a committed change has left, where it is too much.
ChangeReport compacted(ChangeReport report, const fs::path& file, const ChangeParams& params, ProgressSink& sink) {
  if (report.has_changes && !params.dry_run && params.may_compact)
    compactIfSparse(file, report.free_space, sink, kMaxFreeShareOfChanged);
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
    editor_->rest();
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

std::vector<scan::ScanId> cloudsNamed(const fs::path& file, std::span<const std::string> names, Retracted retracted) {
  const auto environment = rdf::Environment::open(file, rdf::OpenMode::ReadOnly);
  const rdf::ReadTransaction transaction = environment->read();
  const std::vector<Cloud> clouds = storedClouds(transaction);
  std::vector<scan::ScanId> ids;
  for (const std::string& name : names) {
    std::vector<scan::ScanId> fitting;
    for (const Cloud& cloud : clouds)
      if (isNamed(cloud.id, cloud.source, name)) fitting.push_back(cloud.id);
    if (fitting.empty() && retracted == Retracted::Named)
      for (const RetractedScan& scan : retractedScans(transaction))
        if (isNamed(scan.id, scan.source, name)) fitting.push_back(scan.id);
    if (fitting.empty())
      throw Error(ErrorKind::NotFound, file.string() + ": has no cloud '" + name + "'", Remedy::ListClouds);
    if (fitting.size() > 1)
      throw Error(ErrorKind::InvalidArgument, file.string() + ": '" + name + "' names " +
                                                  std::to_string(fitting.size()) + " clouds; name each by its id");
    ids.push_back(fitting.front());
  }
  return ids;
}

}  // namespace cluxel::mapping
