// SPDX-License-Identifier: Apache-2.0
// One pass over the rays of a map's scans for all that looks at rays.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "mapping/clouds/cloud.hpp"
#include "perception/visibility/scan_rays.hpp"

namespace cluxel::mapping {

/// What one observer sees of one scan.
class ScanView {
 public:
  virtual ~ScanView() = default;
  /// Called once. May use `threads` threads.
  virtual void look(const perception::ScanRays& rays, unsigned threads) = 0;
};

/// Looks at the rays of scans. Several scans are looked at at once, each with a view of its own; the views are taken
/// one by one in the order of the scans, so that the outcome does not depend on the threads.
class RayObserver {
 public:
  explicit RayObserver(unsigned threads) : threads_(threads) {}
  virtual ~RayObserver() = default;
  unsigned threads() const { return threads_; }
  /// Whether rays of the cloud may matter. Scans that nobody wants are not loaded.
  virtual bool wants(const Cloud& cloud) const = 0;
  /// A view of a cloud that was wanted. Called on any thread.
  virtual std::unique_ptr<ScanView> view(const Cloud& cloud) const = 0;
  /// Adds what the view saw.
  virtual void take(const ScanView& seen) = 0;

 private:
  unsigned threads_;
};

/// The clouds with a time and a pose, ascending by time.
std::vector<const Cloud*> timedClouds(const std::vector<Cloud>& clouds);

/// Shows the rays of all clouds to the observers that want them: first those of timedClouds() in their order, then the
/// others. `load` gives a cloud's scan; it is called on any thread, but never twice at once. Cost: linear in the rays
/// of the scans that are wanted. Holds one scan a thread.
void passRays(const std::vector<Cloud>& clouds, std::span<RayObserver* const> observers,
              const std::function<scan::Scan(const Cloud&)>& load);

}  // namespace cluxel::mapping
