// SPDX-License-Identifier: Apache-2.0
// Goes through the scans one by one, and asks each about the places at which no scan before it looked.
#include "tasks/inventory/observed_places.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "mapping/clouds/ray_starts.hpp"
#include "mapping/regions/ground_heights.hpp"
#include "mapping/stored_grid.hpp"
#include "perception/visibility/sensor_sight.hpp"
#include "perception/visibility/standing_place.hpp"

namespace cluxel::tasks {

namespace {

using perception::StandingPlace;

constexpr double kBesidePoints_m = 1;  ///< of scans without rays
constexpr double kBelowGround_m = 0.3;

/// The places where the map has ground, by their numbers.
std::map<std::size_t, StandingPlace> standingPlaces(const mapping::MapReader& map,
                                                    const std::vector<AskedPlace>& places) {
  std::vector<Eigen::Vector2d> at;
  for (const AskedPlace& place : places) at.push_back(place.at);
  const std::vector<std::optional<double>> ground_m = groundHeightsAt(map, at);
  std::map<std::size_t, StandingPlace> standing;
  for (std::size_t i = 0; i < places.size(); ++i)
    if (ground_m[i]) standing[i] = {{at[i].x(), at[i].y(), *ground_m[i]}, places[i].height_m};
  return standing;
}

/// Whether rays or points of the cloud may tell of the place.
bool mayLookAt(const mapping::Cloud& cloud, const StandingPlace& place, double view_m) {
  if (const auto sensor = mapping::sensorPlaceOf(cloud))
    if ((*sensor - place.foot).head<2>().norm() > view_m + perception::kSameSensor_m) return false;
  const Eigen::Vector3d around = Eigen::Vector3d::Constant(kBesidePoints_m);
  const Eigen::AlignedBox3d line(place.foot - around, place.foot + place.top_m() * Eigen::Vector3d::UnitZ() + around);
  return cloud.rays.intersects(line);
}

/// The places near which points lie, found by squares of the ground.
class PlacesBeside {
 public:
  explicit PlacesBeside(const std::map<std::size_t, StandingPlace>& places) {
    for (const auto& [number, place] : places) {
      const Square square = squareAt(place.foot);
      for (std::int64_t x = -1; x <= 1; ++x)
        for (std::int64_t y = -1; y <= 1; ++y)
          in_square_[{square.first + x, square.second + y}].emplace_back(number, place);
    }
  }

  void markAt(const Eigen::Vector3d& p_map, std::vector<bool>& is_seen) const {
    const auto near = in_square_.find(squareAt(p_map));
    if (near == in_square_.end()) return;
    for (const auto& [number, place] : near->second) {
      const Eigen::Vector3d from_foot = p_map - place.foot;
      if (from_foot.head<2>().norm() <= kBesidePoints_m && from_foot.z() >= -kBelowGround_m &&
          from_foot.z() <= place.top_m())
        is_seen[number] = true;
    }
  }

 private:
  using Square = std::pair<std::int64_t, std::int64_t>;
  static Square squareAt(const Eigen::Vector3d& p_map) {
    const auto number = [](double at) { return static_cast<std::int64_t>(std::floor(at / kBesidePoints_m)); };
    return {number(p_map.x()), number(p_map.y())};
  }

  std::map<Square, std::vector<std::pair<std::size_t, StandingPlace>>> in_square_;
};

void markSeenBy(const scan::Scan& scan, const std::map<std::size_t, StandingPlace>& places, double view_m,
                const perception::TileGrid& grid, std::vector<bool>& is_seen) {
  const perception::ScanRays rays(scan);
  const perception::LookingRays looking(rays, view_m, grid);
  for (const auto& [number, place] : places)
    if (looking.lookAt(place)) is_seen[number] = true;
  if (!rays.empty()) return;
  const PlacesBeside beside(places);
  for (std::size_t i = 0; i < scan.points.size(); ++i)
    beside.markAt(scan::toMap(scan.T_map_sensor, {scan.points.x[i], scan.points.y[i], scan.points.z[i]}), is_seen);
}

}  // namespace

std::vector<bool> observedPlaces(const mapping::MapReader& map, const std::vector<AskedPlace>& places, double view_m) {
  std::vector<bool> is_seen(places.size(), false);
  if (places.empty()) return is_seen;
  const perception::TileGrid grid = mapping::storedGrid(map.transaction());
  std::map<std::size_t, StandingPlace> open = standingPlaces(map, places);
  for (const mapping::Cloud& cloud : map.clouds()) {
    std::map<std::size_t, StandingPlace> near;
    for (const auto& [number, place] : open)
      if (mayLookAt(cloud, place, view_m)) near.emplace(number, place);
    if (near.empty()) continue;
    markSeenBy(map.scanOf(cloud.id), near, view_m, grid, is_seen);
    std::erase_if(open, [&](const auto& asked) { return is_seen[asked.first]; });
  }
  return is_seen;
}

}  // namespace cluxel::tasks
