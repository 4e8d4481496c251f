// SPDX-License-Identifier: Apache-2.0
// Compares the poses of files with those of the clouds that hold the same scans.
#include "mapping/watch/other_poses.hpp"

#include <map>

#include "mapping/clouds/scan_store.hpp"

namespace cluxel::mapping {

namespace fs = std::filesystem;

namespace {

bool haveSamePose(const scan::ScanFile& a, const scan::ScanFile& b) {
  return a.T_map_sensor.matrix() == b.T_map_sensor.matrix();
}

/// Whether the cloud came from another file of the folder, which still holds the scan and gives it another pose.
bool hasOtherFile(const FolderLook& now, std::size_t i, const Cloud& cloud, WatchedScans& watched) {
  const scan::ScanSet& scans = *now.scans;
  for (std::size_t j = 0; j < scans.size(); ++j)
    if (j != i && scans.file(j).has_pose && scans.file(j).path.filename() == fs::path(cloud.source).filename() &&
        !haveSamePose(scans.file(j), scans.file(i)) && watched.idOf(now, j) == cloud.id)
      return true;
  return false;
}

}  // namespace

std::vector<ScanPose> OtherPoses::othersOf(const rdf::ReadTransaction& map, const FolderLook& now,
                                           const std::vector<std::size_t>& candidates, WatchedScans& watched) {
  struct KnownScan {
    Cloud cloud;
    std::vector<std::size_t> files;
    bool has_copy = false;
  };
  std::map<scan::ScanId, KnownScan> known;
  const scan::ScanSet& scans = *now.scans;
  for (const std::size_t i : candidates) {
    refused_.erase(scans.file(i).path);
    const std::optional<scan::ScanId> id = scans.file(i).has_pose ? watched.idOf(now, i) : std::nullopt;
    const std::optional<Cloud> cloud = id ? storedCloud(map, *id) : std::nullopt;
    if (!cloud) continue;
    KnownScan& scan = known.try_emplace(*id, KnownScan{*cloud, {}}).first->second;
    scan.has_copy = scan.has_copy || hasOtherFile(now, i, *cloud, watched) ||
                    (!scan.files.empty() && !haveSamePose(scans.file(scan.files.front()), scans.file(i)));
    scan.files.push_back(i);
  }
  std::vector<ScanPose> others;
  for (const auto& [id, scan] : known) {
    const Eigen::Isometry3d& pose = scans.file(scan.files.front()).T_map_sensor;
    if (scan.has_copy)
      for (const std::size_t i : scan.files) refuse(now, scans.file(i).path, id);
    else if (!scan.cloud.has_pose || scan.cloud.T_map_sensor.matrix() != pose.matrix())
      others.push_back({id, pose});
  }
  return others;
}

/// The scan is looked at again when the folder has changed.
void OtherPoses::refuse(const FolderLook& now, const fs::path& file, const scan::ScanId& id) {
  refused_.insert(file);
  refused_in_ = now.files;
  if (told_.insert(id).second)
    sink_.note(file.string() +
               ": is the same scan as another file of the folder, with another pose; it stays where it is in the map "
               "until one of the files is removed");
}

}  // namespace cluxel::mapping
