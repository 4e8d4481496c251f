// SPDX-License-Identifier: Apache-2.0
// Copies of a place: the points visible to another sensor, and thinning by hash.
#include "perception/training/virtual_sensor.hpp"

#include "base/mixed_bits.hpp"
#include "perception/training/depth_image.hpp"

namespace cluxel::perception {

namespace {

template <typename T>
std::vector<T> chosen(const std::vector<T>& values, const std::vector<std::size_t>& keep) {
  std::vector<T> rest;
  if (values.empty()) return rest;
  for (const std::size_t i : keep) rest.push_back(values[i]);
  return rest;
}

void keepOf(const scan::Scan& scan, const scan::PointTruth& truth, const std::vector<std::size_t>& keep,
            LabelledScans& rest) {
  const scan::ScanPoints& points = scan.points;
  scan::Scan copy;
  copy.points = {chosen(points.x, keep),         chosen(points.y, keep),     chosen(points.z, keep),
                 chosen(points.intensity, keep), chosen(points.label, keep), chosen(points.origin, keep)};
  copy.time_s = scan.time_s;
  copy.T_map_sensor = scan.T_map_sensor;
  copy.has_pose = scan.has_pose;
  copy.source = scan.source;
  copy.id = contentIdOf(copy);
  rest.scans.push_back(std::move(copy));
  rest.truth.push_back({chosen(truth.primitive, keep), {}, {}, {}});
}

}  // namespace

LabelledScans thinned(std::span<const scan::Scan> scans, std::span<const scan::PointTruth> truth, double share,
                      std::uint64_t seed) {
  LabelledScans rest;
  for (std::size_t s = 0; s < scans.size(); ++s) {
    std::vector<std::size_t> keep;
    for (std::size_t i = 0; i < scans[s].points.size(); ++i)
      if (hashedShare(seed, 0, i) < share) keep.push_back(i);
    if (!keep.empty()) keepOf(scans[s], truth[s], keep, rest);
  }
  return rest;
}

std::vector<VirtualSensor> spinningSensors() {
  return {{.highest_rad = 0.06, .spacing_m = 60, .range_m = 45},
          {.highest_rad = 0.03, .spacing_m = 40, .range_m = 45},
          {.highest_rad = 0.05, .spacing_m = 4, .range_m = 30},
          {.height_m = 1.2, .lowest_rad = -0.26, .highest_rad = 0.26, .lines = 32, .spacing_m = 20}};
}

LabelledScans seenBy(std::span<const scan::Scan> scans, std::span<const scan::PointTruth> truth,
                     const VirtualSensor& sensor) {
  const PlaceCloud cloud = placeCloud(scans, truth);
  std::vector<bool> seen(cloud.point.size(), false);
  for (const Eigen::Vector3d& stand : standsOf(cloud, sensor))
    for (const std::size_t i : nearestPoints(cloud, stand, sensor)) seen[i] = true;
  LabelledScans rest;
  std::size_t first = 0;
  for (std::size_t s = 0; s < scans.size(); ++s) {
    std::vector<std::size_t> keep;
    for (std::size_t i = 0; i < scans[s].points.size(); ++i)
      if (seen[first + i]) keep.push_back(i);
    first += scans[s].points.size();
    if (!keep.empty()) keepOf(scans[s], truth[s], keep, rest);
  }
  return rest;
}

}  // namespace cluxel::perception
