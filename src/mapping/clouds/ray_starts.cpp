// SPDX-License-Identifier: Apache-2.0
// The description of a cloud tells of one place; only its points tell of several.
#include "mapping/clouds/ray_starts.hpp"

#include <cmath>
#include <cstdint>
#include <set>
#include <utility>

#include "mapping/clouds/scan_store.hpp"

namespace cluxel::mapping {

std::optional<Eigen::Vector3d> sensorPlaceOf(const Cloud& cloud) {
  // Else the sight is that of returns that merely look as if they were seen from the origin of the frame.
  if (!cloud.sight || !cloud.has_ray_starts) return std::nullopt;
  return cloud.T_map_sensor * cloud.sight->origin;
}

std::vector<Eigen::Vector3d> rayStartsOf(const rdf::ReadTransaction& transaction, const Cloud& cloud, double square_m) {
  if (!cloud.has_ray_starts) return {};
  if (const auto place = sensorPlaceOf(cloud)) return {*place};
  const std::vector<Eigen::Vector3f> origins = storedPoints(transaction, cloud.id).origin;
  std::vector<Eigen::Vector3d> starts;
  if (origins.empty()) starts.emplace_back(cloud.T_map_sensor.translation());
  std::set<std::pair<std::int64_t, std::int64_t>> known;
  const auto number = [square_m](double at) { return static_cast<std::int64_t>(std::floor(at / square_m)); };
  for (auto origin = origins.rbegin(); origin != origins.rend(); ++origin) {
    const Eigen::Vector3d start = scan::toMap(cloud.T_map_sensor, *origin);
    if (known.emplace(number(start.x()), number(start.y())).second) starts.push_back(start);
  }
  return starts;
}

}  // namespace cluxel::mapping
