// SPDX-License-Identifier: Apache-2.0
// What a watch tells of its folder: each thing once, although each look finds it again.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "cluxel/progress.hpp"
#include "mapping/watch/folder_look.hpp"
#include "mapping/watch/watched_scans.hpp"

namespace cluxel::mapping {

class WatchNotes {
 public:
  /// Both must outlive it.
  WatchNotes(const std::filesystem::path& folder, ProgressSink& sink) : folder_(folder), sink_(sink) {}

  /// That the folder is gone or cannot be read, and scans that cannot be read, when two looks show them alike.
  void tellFaults(const FolderLook& before, const FolderLook& now);
  void tellFaulty(const std::string& fault);
  /// Why the folder does not fit the map; empty when it does.
  void tellFrame(const std::string& fault);
  /// Notes on the set of scans. One that differs from an earlier one by numbers alone is not told again.
  void tellOfSet(const std::vector<std::string>& notes);
  void tellRemoved(const std::vector<std::filesystem::path>& files);
  /// Of a file that changed while nobody watched, the map may have the earlier scan. That may as well have come from
  /// another file, which had this name then.
  void tellReplacedBefore(const std::filesystem::path& file, const std::vector<scan::ScanId>& earlier,
                          const WatchedScans& watched);

 private:
  void tellOnce(std::string& told, const std::string& message);

  const std::filesystem::path& folder_;
  ProgressSink& sink_;
  std::string told_fault_, told_frame_;
  std::map<std::filesystem::path, FaultySeen> told_faulty_;
  std::set<std::string> told_of_set_;  ///< without their numbers
};

}  // namespace cluxel::mapping
