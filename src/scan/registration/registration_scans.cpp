// SPDX-License-Identifier: Apache-2.0
// Scans are loaded on several threads, kept thinned, and sorted by id.
#include "scan/registration/registration_scans.hpp"

#include <algorithm>
#include <numeric>
#include <optional>

#include "base/counted_progress.hpp"
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
    clouds[i].emplace(thinnedToVoxels(scan.points, {.voxel_m = params.voxel_m}));
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
