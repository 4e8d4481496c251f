// SPDX-License-Identifier: Apache-2.0
// A faulty transform is told by bounds, before scans are moved one by one.
#include "mapping/clouds/merged_scans.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdio>

#include "base/utc_time.hpp"
#include "cluxel/error.hpp"
#include "mapping/clouds/scan_store.hpp"

namespace cluxel::mapping {

namespace {

/// Refuses a transform that moves the whole box of a scan out of the range. Where a part of it is in the range, its
/// points are looked at when they are stored.
void requireInRange(const std::string& map, const Cloud& cloud, const Eigen::Isometry3d& T) {
  if (cloud.point_count == 0) return;
  Eigen::AlignedBox3d moved;
  for (int corner = 0; corner < 8; ++corner) {
    const auto side = [&](int axis) { return ((corner >> axis) & 1) != 0 ? cloud.max[axis] : cloud.min[axis]; };
    moved.extend(T * Eigen::Vector3d(side(0), side(1), side(2)));
  }
  const Eigen::Vector3d nearest = Eigen::Vector3d::Zero().cwiseMax(moved.min()).cwiseMin(moved.max());
  if (scan::isInMapRange(nearest)) return;
  std::array<char, 128> place{};
  std::snprintf(place.data(), place.size(), "%.1f %.1f %.1f", nearest.x(), nearest.y(), nearest.z());
  throw Error(ErrorKind::FaultyInput,
              map + ": the transform moves points to about " + place.data() +
                  ", out of the range of a map; coordinates may reach 10000 km, heights 20 km: check the translation "
                  "of the transform");
}

}  // namespace

bool addScanInputs(const std::vector<Cloud>& clouds, const Eigen::Isometry3d& T_first_map,
                   std::map<scan::ScanId, ScanInputs>& scans) {
  for (const Cloud& cloud : clouds) {
    ScanInputs inputs{cloud.has_pose, (T_first_map * cloud.T_map_sensor).matrix(), toMicroseconds(cloud.time_s)};
    const auto [known, is_new] = scans.emplace(cloud.id, inputs);
    if (is_new) continue;
    known->second.time_s = std::max(known->second.time_s, inputs.time_s);
    inputs.time_s = known->second.time_s;
    if (known->second != inputs) return false;
  }
  return true;
}

void ScansOfMaps::add(const std::string& map, std::vector<Cloud> clouds, const Eigen::Isometry3d& T_first_map,
                      bool has_transform) {
  for (Cloud& cloud : clouds) {
    if (has_transform) requireInRange(map, cloud, T_first_map);
    cloud.T_map_sensor = T_first_map * cloud.T_map_sensor;
    const auto [entry, is_new] = scans_.try_emplace(cloud.id, map, cloud);
    if (is_new) continue;
    const auto& [other, there] = entry->second;
    const auto difference = differenceOfPoses(cloud, there);
    if (!difference) continue;
    const std::string otherwise = there.has_pose ? " with one" : " without one";
    const std::string fault = "holds the scan of '" + cloud.source + "' " + *difference + ", and " + other +
                              " holds the same scan" + (there.has_pose == cloud.has_pose ? "" : otherwise);
    if (has_transform)
      throw InputError({.file = map}, fault + " in its frame",
                       "only one of two maps in different frames may hold a scan: retract it from one of them");
    throw InputError({.file = map}, fault, "retract it from one of the maps, or give it the same pose in both",
                     Remedy::MoveScans);
  }
}

}  // namespace cluxel::mapping
