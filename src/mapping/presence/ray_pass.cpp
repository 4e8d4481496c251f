// SPDX-License-Identifier: Apache-2.0
// Loads each scan once.
#include "mapping/presence/ray_pass.hpp"

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>

namespace cluxel::mapping {

namespace {

bool isTimed(const Cloud& cloud) {
  return cloud.time_s && cloud.has_pose;
}

}  // namespace

std::vector<const Cloud*> timedClouds(const std::vector<Cloud>& clouds) {
  std::vector<const Cloud*> timed;
  for (const Cloud& cloud : clouds)
    if (isTimed(cloud)) timed.push_back(&cloud);
  std::sort(timed.begin(), timed.end(), [](const Cloud* a, const Cloud* b) {
    return std::pair(*a->time_s, a->id.hex()) < std::pair(*b->time_s, b->id.hex());
  });
  return timed;
}

void passRays(const std::vector<Cloud>& clouds, std::span<RayObserver* const> observers,
              const std::function<scan::Scan(const Cloud&)>& load) {
  std::vector<const Cloud*> order = timedClouds(clouds);
  for (const Cloud& cloud : clouds)
    if (!isTimed(cloud)) order.push_back(&cloud);
  for (const Cloud* cloud : order) {
    std::vector<RayObserver*> wanting;
    std::copy_if(observers.begin(), observers.end(), std::back_inserter(wanting),
                 [&](RayObserver* observer) { return observer->wants(*cloud); });
    if (wanting.empty()) continue;
    perception::forEachRayBundle(load(*cloud), [&](const perception::RayBundle& bundle) {
      for (RayObserver* observer : wanting) observer->look(bundle);
    });
  }
}

}  // namespace cluxel::mapping
