// SPDX-License-Identifier: Apache-2.0
// Loads each scan once, and some scans at the same time.
#include "mapping/presence/ray_pass.hpp"

#include <algorithm>
#include <map>
#include <mutex>
#include <string>
#include <utility>

#include "base/parallel.hpp"

namespace cluxel::mapping {

namespace {

bool isTimed(const Cloud& cloud) {
  return cloud.time_s && cloud.has_pose;
}

using Loader = std::function<scan::Scan(const Cloud&)>;
/// A view for each observer, null where it does not want the scan.
using ScanViews = std::vector<std::unique_ptr<ScanView>>;

class RayPass {
 public:
  RayPass(std::vector<const Cloud*> order, std::span<RayObserver* const> observers, const Loader& load)
      : order_(std::move(order)), observers_(observers), load_(load) {}

  void run() {
    unsigned threads = 1;
    for (const RayObserver* observer : observers_) threads = std::max(threads, observer->threads());
    const std::size_t together = std::clamp<std::size_t>(order_.size(), 1, threads);
    threads_of_scan_ = static_cast<unsigned>((threads + together - 1) / together);
    parallelFor(order_.size(), threads, [this](std::size_t i) { take(i, viewsOf(*order_[i])); });
  }

 private:
  ScanViews viewsOf(const Cloud& cloud) {
    ScanViews views;
    for (const RayObserver* observer : observers_)
      views.push_back(observer->wants(cloud) ? observer->view(cloud) : nullptr);
    const perception::ScanRays rays(loaded(cloud));
    for (const auto& view : views)
      if (view) view->look(rays, threads_of_scan_);
    return views;
  }

  scan::Scan loaded(const Cloud& cloud) {
    const std::lock_guard lock(loading_);
    return load_(cloud);
  }

  /// Takes the views of the scans up to the first that is not finished.
  void take(std::size_t number, ScanViews views) {
    const std::lock_guard lock(taking_);
    finished_.emplace(number, std::move(views));
    for (; !finished_.empty() && finished_.begin()->first == next_; ++next_) {
      const ScanViews& seen = finished_.begin()->second;
      for (std::size_t i = 0; i < seen.size(); ++i)
        if (seen[i]) observers_[i]->take(*seen[i]);
      finished_.erase(finished_.begin());
    }
  }

  std::vector<const Cloud*> order_;
  std::span<RayObserver* const> observers_;
  const Loader& load_;
  unsigned threads_of_scan_ = 1;
  std::mutex loading_, taking_;
  std::map<std::size_t, ScanViews> finished_;  ///< by the number of the scan
  std::size_t next_ = 0;                       ///< the first scan that was not taken
};

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
  std::erase_if(order, [&](const Cloud* cloud) {
    return std::none_of(observers.begin(), observers.end(),
                        [&](const RayObserver* observer) { return observer->wants(*cloud); });
  });
  RayPass(std::move(order), observers, load).run();
}

}  // namespace cluxel::mapping
