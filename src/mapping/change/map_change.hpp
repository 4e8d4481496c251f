// SPDX-License-Identifier: Apache-2.0
// Changes of a finished map: more scans, fewer scans, other poses, other rules. Each gives the very map that a build
// from the changed inputs would give.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "mapping/change/map_editor.hpp"
#include "scan/scan_set.hpp"

namespace cluxel::mapping {

/// All functions throw the Errors of MapEditor, and leave the map as it is when they fail, except for batches of
/// extendMap() and moveScans() that were committed before. With ChangeParams::dry_run nothing is written.

/// Scans that are given poses of their own must lie in the map's frame. Throws Error (InvalidArgument) when their
/// manifest names another map origin or coordinate system than the map's, or when they are in outer coordinates.
void requireFrame(const MapInputs& map, const scan::ScanSet& scans);

/// Throws Error (InvalidArgument) that names both frames when a map has another map origin or coordinate system than
/// the one that it is merged with.
void requireSameFrame(const std::filesystem::path& file, const MapInputs& map, const std::filesystem::path& other_file,
                      const MapInputs& other);

/// Adds scans, batch by batch. After each commit, readers see the exact map of the scans so far, so that a killed run
/// continues when it is repeated. Scans that are there with the same pose are passed over, but for later times (with
/// ChangeParams::takes_given_times, also earlier ones). Throws InputError for a scan that is there with another pose,
/// or whose manifest names another map origin or coordinate system than the map's.
ChangeReport extendMap(const std::filesystem::path& file, const scan::ScanSet& scans, const ChangeParams& params,
                       ProgressSink& sink);

/// Extends a map again and again. What one extension has read and computed serves the next, unless another program has
/// changed the map in between: then it is read anew. Between extensions other programs may change the map.
class MapExtension {
 public:
  MapExtension(std::filesystem::path file, const ChangeParams& params, ProgressSink& sink)
      : file_(std::move(file)), params_(params), sink_(sink) {}
  /// As extendMap(), but never rewrites the file.
  ChangeReport add(const scan::ScanSet& scans);
  /// Lets go of the file.
  void close() { editor_.reset(); }

 private:
  std::filesystem::path file_;
  ChangeParams params_;
  ProgressSink& sink_;
  std::optional<MapEditor> editor_;
};

/// Removes scans. One that was retracted before is noted, so that a killed command can be repeated. Throws Error:
/// NotFound for a scan that neither this map nor one that was merged into it ever had, InvalidArgument when none would
/// be left.
ChangeReport retractScans(const std::filesystem::path& file, const std::vector<scan::ScanId>& scans,
                          const ChangeParams& params, ProgressSink& sink);

struct ScanPose {
  scan::ScanId scan;
  Eigen::Isometry3d T_map_sensor = Eigen::Isometry3d::Identity();
};
/// Gives scans other poses, batch by batch from place to place. After each commit, readers see the exact map of the
/// poses so far, so that a killed run continues when it is repeated. Throws Error: NotFound for an unknown scan,
/// InvalidArgument for a scan that is named twice.
ChangeReport moveScans(const std::filesystem::path& file, const std::vector<ScanPose>& poses,
                       const ChangeParams& params, ProgressSink& sink);

/// Decides anew with other rules, ontology, model or settings. `change` gets the inputs of the map, which nobody can
/// change meanwhile, and returns the new ones. Scans, map origin and coordinate system stay.
ChangeReport applyInputs(const std::filesystem::path& file, const std::function<MapInputs(MapInputs)>& change,
                         const ChangeParams& params, ProgressSink& sink);

}  // namespace cluxel::mapping
