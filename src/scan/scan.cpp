// SPDX-License-Identifier: Apache-2.0
// The name of a scan is a hash of what was measured.
#include "scan/scan.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "cluxel/error.hpp"

namespace cluxel::scan {

namespace {

/// Three floats a ray origin, without whatever padding a vector type may have.
std::vector<float> flattened(const std::vector<Eigen::Vector3f>& origins) {
  std::vector<float> flat;
  flat.reserve(3 * origins.size());
  for (const Eigen::Vector3f& origin : origins) flat.insert(flat.end(), origin.data(), origin.data() + 3);
  return flat;
}

}  // namespace

ScanId contentIdOf(const Scan& scan) {
  const ScanPoints& points = scan.points;
  ContentHasher hasher;
  hasher.addText("cluxel scan 2");
  hasher.addSpan(std::span<const float>(points.x));
  hasher.addSpan(std::span<const float>(points.y));
  hasher.addSpan(std::span<const float>(points.z));
  hasher.addSpan(std::span<const float>(points.intensity));
  hasher.addSpan(std::span<const float>(flattened(points.origin)));
  return hasher.finish();
}

void refusePointOutOfRange(const Scan& scan, std::size_t point) {
  throw InputError({.file = scan.source},
                   "point " + std::to_string(point) + " lies outside the map's range or is not a number",
                   "coordinates may reach 10000 km, heights 20 km; check unit and pose, or give the manifest a map "
                   "origin");
}

void requireInMapRange(const Scan& scan) {
  Eigen::AlignedBox3f box;
  for (std::size_t i = 0; i < scan.points.size(); ++i)
    box.extend(Eigen::Vector3f(scan.points.x[i], scan.points.y[i], scan.points.z[i]));
  const std::array corners{Eigen::AlignedBox3f::BottomLeftFloor, Eigen::AlignedBox3f::BottomRightFloor,
                           Eigen::AlignedBox3f::TopLeftFloor,    Eigen::AlignedBox3f::TopRightFloor,
                           Eigen::AlignedBox3f::BottomLeftCeil,  Eigen::AlignedBox3f::BottomRightCeil,
                           Eigen::AlignedBox3f::TopLeftCeil,     Eigen::AlignedBox3f::TopRightCeil};
  const bool all_in_range = std::all_of(corners.begin(), corners.end(), [&](auto corner) {
    return isInMapRange(toMap(scan.T_map_sensor, box.corner(corner)));
  });
  for (std::size_t i = 0; i < scan.points.origin.size(); ++i)
    if (!isInMapRange(toMap(scan.T_map_sensor, scan.points.origin[i])))
      throw InputError({.file = scan.source},
                       "the ray of point " + std::to_string(i) + " starts outside the map's range",
                       "origins of rays are in the frame of the points; coordinates may reach 10000 km, heights 20 km");
  if (all_in_range) return;
  for (std::size_t i = 0; i < scan.points.size(); ++i)
    if (!isInMapRange(toMap(scan.T_map_sensor, {scan.points.x[i], scan.points.y[i], scan.points.z[i]})))
      refusePointOutOfRange(scan, i);
}

}  // namespace cluxel::scan
