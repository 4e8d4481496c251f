// SPDX-License-Identifier: Apache-2.0
// The description of a cloud tells of one place; only its points tell of several.
#include "mapping/clouds/ray_starts.hpp"

#include <cmath>
#include <cstdint>
#include <set>
#include <utility>

#include "mapping/clouds/scan_store.hpp"

namespace cluxel::mapping {

namespace {

constexpr double kAlike_m = 1;  ///< what is seen from such a square is much the same

}  // namespace

std::optional<Eigen::Vector3d> sensorPlaceOf(const Cloud& cloud) {
  if (!cloud.sight) return std::nullopt;
  // Without a pose, the sight of returns that merely look as if seen from there lies at the origin of the frame.
  if (!cloud.has_pose && cloud.sight->origin.isZero(0)) return std::nullopt;
  return cloud.T_map_sensor * cloud.sight->origin;
}

std::vector<Eigen::Vector3d> rayStartsOf(const rdf::ReadTransaction& transaction, const Cloud& cloud) {
  if (const auto place = sensorPlaceOf(cloud)) return {*place};
  const std::vector<Eigen::Vector3f> origins = storedPoints(transaction, cloud.id).origin;
  std::vector<Eigen::Vector3d> starts;
  if (origins.empty() && cloud.has_pose) starts.emplace_back(cloud.T_map_sensor.translation());
  std::set<std::pair<std::int64_t, std::int64_t>> known;
  const auto number = [](double at) { return static_cast<std::int64_t>(std::floor(at / kAlike_m)); };
  for (auto origin = origins.rbegin(); origin != origins.rend(); ++origin) {
    const Eigen::Vector3d start = scan::toMap(cloud.T_map_sensor, *origin);
    if (known.emplace(number(start.x()), number(start.y())).second) starts.push_back(start);
  }
  return starts;
}

}  // namespace cluxel::mapping
