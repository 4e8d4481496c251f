// SPDX-License-Identifier: Apache-2.0
// Scans are loaded on several threads, kept thinned, and sorted by id.
#include "scan/registration/registration_scans.hpp"

#include <algorithm>
#include <cmath>
#include <compare>
#include <map>
#include <numeric>
#include <optional>

#include "base/counted_progress.hpp"
#include "base/mixed_bits.hpp"
#include "base/parallel.hpp"
#include "cluxel/error.hpp"
#include "scan/registration/voxel_thinning.hpp"
#include "scan/scan_layouts.hpp"

namespace cluxel::scan {

namespace {

void refuseScansWithoutPose(const ScanSet& set) {
  for (std::size_t i = 0; i < set.size(); ++i)
    if (!set.file(i).has_pose)
      throw InputError({.file = set.file(i).path.string()}, "has no pose to refine",
                       set.remedies().poses + ", or put poses beside the scans or in a manifest");
}

struct Column {
  std::int64_t x = 0, y = 0;
  auto operator<=>(const Column&) const = default;
};

/// The column of a square grid with this edge [m].
Column columnOf(const Eigen::Vector3d& p, double edge_m) {
  const auto number = [edge_m](double at_m) { return std::llround(std::floor(at_m / edge_m)); };
  return {number(p.x()), number(p.y())};
}

/// Which points lie where the scan has something higher than the ground: these tell about the horizontal position.
std::vector<bool> areTall(const std::vector<Eigen::Vector3d>& points) {
  constexpr double kEdge_m = 1, kTall_m = 0.5;
  std::map<Column, std::pair<double, double>> heights;
  for (const Eigen::Vector3d& p : points) {
    auto& [low, high] = heights.try_emplace(columnOf(p, kEdge_m), p.z(), p.z()).first->second;
    low = std::min(low, p.z()), high = std::max(high, p.z());
  }
  std::vector<bool> are_tall;
  for (const Eigen::Vector3d& p : points) {
    const auto& [low, high] = heights.at(columnOf(p, kEdge_m));
    are_tall.push_back(high - low > kTall_m);
  }
  return are_tall;
}

/// Some `count` of the points, half of them tall if there are as many. They are those of some squares of the outer
/// frame, whatever the map's origin, and the squares for few points are among those for more: so points that lie near
/// each other in two scans are chosen in both.
std::vector<std::size_t> chosenPoints(const std::vector<Eigen::Vector3f>& p_sensor,
                                      const Eigen::Isometry3d& T_outer_sensor, std::size_t count) {
  constexpr double kSquare_m = 4;
  std::vector<std::size_t> chosen(p_sensor.size());
  std::iota(chosen.begin(), chosen.end(), std::size_t{0});
  if (count >= p_sensor.size()) return chosen;
  std::vector<Eigen::Vector3d> p_outer;
  for (const Eigen::Vector3f& p : p_sensor) p_outer.push_back(T_outer_sensor * p.cast<double>());
  const std::vector<bool> are_tall = areTall(p_outer);
  const auto tall = static_cast<std::size_t>(std::count(are_tall.begin(), are_tall.end(), true));
  const std::size_t flat = p_outer.size() - tall;
  const std::size_t tall_count = std::min(tall, std::max(count / 2, count - std::min(count, flat)));
  const auto share = [](std::size_t part, std::size_t all) {
    return static_cast<double>(part) / static_cast<double>(std::max<std::size_t>(all, 1));
  };
  const double tall_share = share(tall_count, tall), flat_share = share(count - tall_count, flat);
  std::erase_if(chosen, [&](std::size_t i) {
    const auto [x, y] = columnOf(p_outer[i], kSquare_m);
    return hashedShare(0, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y)) >=
           (are_tall[i] ? tall_share : flat_share);
  });
  return chosen;
}

/// Numbers of the scans by id, each id once.
std::vector<std::size_t> orderOf(const ScanSet& set, const std::vector<ScanId>& ids) {
  std::vector<std::size_t> order(ids.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    if (ids[a] != ids[b]) return ids[a] < ids[b];
    const std::string first = set.file(a).path.string(), second = set.file(b).path.string();
    return naturalLess(first, second) || (!naturalLess(second, first) && a < b);
  });
  std::vector<std::size_t> once;
  for (const std::size_t i : order) {
    if (once.empty() || ids[once.back()] != ids[i]) {
      once.push_back(i);
    } else if (set.file(once.back()).T_map_sensor.matrix() != set.file(i).T_map_sensor.matrix()) {
      throw InputError({.file = set.file(i).path.string()},
                       "is the same scan as " + set.file(once.back()).path.string() + " with another pose",
                       "leave one of them out");
    }
  }
  return once;
}

}  // namespace

std::vector<std::size_t> RegistrationScans::byPath() const {
  std::vector<std::size_t> order(path.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return naturalLess(path[a], path[b]); });
  return order;
}

RegistrationScans loadForRegistration(const ScanSet& set, const RegistrationParams& params, unsigned threads,
                                      ProgressSink& sink) {
  refuseScansWithoutPose(set);
  std::vector<std::optional<SurfaceCloud>> clouds(set.size());
  std::vector<ScanId> ids(set.size());
  CountedProgress progress(sink, "read", set.size());
  parallelFor(set.size(), threads, [&](std::size_t i) {
    const Scan scan = set.load(i);
    ids[i] = scan.id;
    std::vector<Eigen::Vector3f> thinned = thinnedToVoxels(scan.points, {.voxel_m = params.voxel_m});
    const Eigen::Isometry3d T_outer_sensor = Eigen::Translation3d(set.mapOrigin()) * scan.T_map_sensor;
    std::vector<std::size_t> compared = chosenPoints(thinned, T_outer_sensor, params.max_compared);
    clouds[i].emplace(std::move(thinned), std::move(compared));
    progress.step();
  });
  RegistrationScans scans;
  for (const std::size_t i : orderOf(set, ids)) {
    scans.clouds.push_back(std::move(*clouds[i]));
    scans.given.push_back(set.file(i).T_map_sensor);
    scans.index.push_back(i);
    scans.path.push_back(set.file(i).path.string());
  }
  return scans;
}

}  // namespace cluxel::scan
