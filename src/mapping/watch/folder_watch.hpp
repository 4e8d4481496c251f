// SPDX-License-Identifier: Apache-2.0
// Extends a map by the scans that arrive in a folder.
#pragma once

#include <filesystem>
#include <functional>

#include "mapping/build/map_builder.hpp"
#include "mapping/change/map_change.hpp"

namespace cluxel::mapping {

struct WatchParams {
  unsigned threads = 1;
  double interval_s = 1;  ///< between two looks at the folder
  double idle_s = 0;      ///< end when nothing has changed for this time; 0: never
  scan::ScanSetParams scans = {};
};

/// What a commit did.
struct WatchCommit {
  std::size_t added = 0;               ///< scans
  std::size_t scans = 0, objects = 0;  ///< of the map afterwards
  std::size_t tiles_decided = 0;       ///< in which the rules ran
  std::size_t objects_added = 0, objects_changed = 0, objects_redecided = 0, objects_gone = 0, objects_split = 0,
              objects_joined = 0;  ///< as in ObjectChanges
};

struct WatchCallbacks {
  std::function<MapInputs()> inputs;                        ///< for the build, when there is no map yet
  std::function<void(const WatchCommit&)> committed;        ///< after each commit
  std::function<bool()> is_stopped = [] { return false; };  ///< asked at each look
};

/// Looks at `folder` again and again, and makes the map the one that a build from the folder gives, as long as no scan
/// file is removed. Scans whose files
/// have not changed since the last look are added to the map in one commit; the first ones build it when it is not
/// there. Scans whose poses or times are corrected get these; a scan is retracted when its file holds another one than
/// this watch has added from it, the map has the new one, and no other file holds the old one. Scans of removed files
/// stay. Until a folder can be read as a set of scans (a pose is still missing), or while its frame is not the map's,
/// it waits. A fault that stays for two looks is a note, and so is a scan that cannot be read, which is tried again
/// when its file changes. While another program changes the map, it tries again at each look. Throws Error for faults
/// of the map, and when the folder has another frame from the beginning. Returns how many scans were added, moved,
/// retracted or given other times.
std::size_t watchFolder(const std::filesystem::path& folder, const std::filesystem::path& map,
                        const WatchParams& params, const WatchCallbacks& callbacks, ProgressSink& sink);

}  // namespace cluxel::mapping
