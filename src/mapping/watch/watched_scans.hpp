// SPDX-License-Identifier: Apache-2.0
// Which scans the files of a watched folder hold, as far as the watch has read them.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "mapping/clouds/cloud.hpp"
#include "mapping/watch/folder_look.hpp"

namespace cluxel::mapping {

/// Absolute and without "." and "..", so that the spellings of one path compare as equal.
std::filesystem::path plainPath(const std::filesystem::path& path);

struct WatchedScan {
  SeenScan seen;                   ///< the file when it was dealt with last
  std::optional<scan::ScanId> id;  ///< of what was read from it last; absent when it could never be read
  bool is_read = false;            ///< since the file changed
  bool is_in_map = false;          ///< the map has what was read, at the place that the folder gives it
};

class WatchedScans {
 public:
  /// Whether there is nothing to do about a file that is as `now`, unless it has another place.
  bool isDone(const std::filesystem::path& path, const SeenScan& now) const;
  bool hasOtherPlace(const std::filesystem::path& path, const Placement& now) const;
  /// Null when the file is not known.
  const WatchedScan* find(const std::filesystem::path& path) const;

  /// The scan that a file of the set holds, which is read unless that is known; absent when it cannot be read.
  std::optional<scan::ScanId> idOf(const FolderLook& now, std::size_t i);
  void noteInMap(const std::filesystem::path& path, const scan::ScanId& id);
  void noteDone(const std::filesystem::path& path, const SeenScan& now);

  /// The file has changed: what it held may have to leave the map.
  void noteChanged(const std::filesystem::path& path);
  /// What changed files held and no file holds now. A file counts when the map has what it holds now: until then the
  /// map keeps the scan of before.
  std::vector<scan::ScanId> replaced() const;
  /// Forgets these, and what a file holds again or whose file is gone.
  void forgetReplaced(const std::vector<scan::ScanId>& ids);
  /// Whether a scan was read from this file, perhaps before it changed.
  bool hasRead(const std::filesystem::path& path) const { return read_.contains(plainPath(path)); }

  /// Forgets files that neither of two looks shows, and returns those whose scan no other file holds.
  std::vector<std::filesystem::path> forgetRemoved(const FolderLook& before, const FolderLook& now);
  bool isHeld(const scan::ScanId& id) const;

 private:
  void noteRead(const std::filesystem::path& path, const scan::ScanId& id);

  std::map<std::filesystem::path, WatchedScan> scans_;      ///< by plain path
  std::map<scan::ScanId, std::filesystem::path> replaced_;  ///< what changed files held, with their plain paths
  std::set<std::filesystem::path> read_;                    ///< plain paths
};

/// The scans that a map has when a watch begins, by the files from which they came.
class EarlierScans {
 public:
  EarlierScans() = default;
  explicit EarlierScans(const std::vector<Cloud>& clouds);

  /// Those that came from this file; they are forgotten.
  std::vector<scan::ScanId> takeFrom(const std::filesystem::path& path);
  /// The files below `folder` that are gone and whose scans `watched` does not find in other files.
  std::vector<std::filesystem::path> goneFrom(const std::filesystem::path& folder, const WatchedScans& watched) const;

 private:
  std::multimap<std::filesystem::path, scan::ScanId> by_source_;  ///< plain paths
};

}  // namespace cluxel::mapping
