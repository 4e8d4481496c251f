// SPDX-License-Identifier: Apache-2.0
// One pass over the rays of a map's scans for all that looks at rays.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "mapping/cloud.hpp"
#include "perception/visibility/ray_bundle.hpp"

namespace cluxel::mapping {

/// Looks at the rays of scans, one scan after the other.
class RayObserver {
 public:
  virtual ~RayObserver() = default;
  /// Whether rays of the cloud may matter. Called before look(); scans that nobody wants are not loaded.
  virtual bool wants(const Cloud& cloud) = 0;
  /// A bundle of the last cloud that was wanted.
  virtual void look(const perception::RayBundle& bundle) = 0;
};

/// The clouds with a time and a pose, ascending by time.
std::vector<const Cloud*> timedClouds(const std::vector<Cloud>& clouds);

/// Shows the rays of all clouds to the observers that want them: first those of timedClouds() in their order, then the
/// others. `load` gives a cloud's scan. Cost: linear in the rays of the scans that are wanted.
void passRays(const std::vector<Cloud>& clouds, std::span<RayObserver* const> observers,
              const std::function<scan::Scan(const Cloud&)>& load);

}  // namespace cluxel::mapping
