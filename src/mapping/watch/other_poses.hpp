// SPDX-License-Identifier: Apache-2.0
// Scans that a folder gives other poses than a map has.
#pragma once

#include <filesystem>
#include <set>
#include <vector>

#include "cluxel/progress.hpp"
#include "mapping/change/map_change.hpp"
#include "mapping/watch/watched_scans.hpp"

namespace cluxel::mapping {

class OtherPoses {
 public:
  /// The sink must outlive it.
  explicit OtherPoses(ProgressSink& sink) : sink_(sink) {}

  /// The poses of those candidates, by their number in the set, that the map has with other ones. A scan in two files
  /// with different poses is refused, with a note.
  std::vector<ScanPose> othersOf(const rdf::ReadTransaction& map, const FolderLook& now,
                                 const std::vector<std::size_t>& candidates, WatchedScans& watched);
  bool isRefused(const std::filesystem::path& file) const { return refused_.contains(file); }
  /// Whether the folder has changed since a scan was refused.
  bool mayHaveChanged(const FolderLook& now) const { return now.files != refused_in_; }

 private:
  void refuse(const FolderLook& now, const std::filesystem::path& file, const scan::ScanId& id);

  ProgressSink& sink_;
  std::set<std::filesystem::path> refused_;  ///< files of scans of which there are copies with other poses
  FolderState refused_in_;                   ///< the folder when they were looked at last
  std::set<scan::ScanId> told_;              ///< refused with a note
};

}  // namespace cluxel::mapping
