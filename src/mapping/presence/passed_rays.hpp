// SPDX-License-Identifier: Apache-2.0
// How many rays of the laser went through each barrier: many through a fence, none through a wall.
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/content_hash.hpp"
#include "mapping/clouds/cloud.hpp"
#include "mapping/presence/object_rows.hpp"
#include "mapping/presence/ray_pass.hpp"
#include "mapping/presence/ray_targets.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::mapping {

/// For each barrier that rays reached, how many ended at its inner places or passed them. A function of these places
/// and of the scans whose rays may pass them; where both are those of the stored counts, these are taken. Cost: linear
/// in the rays of the scans that may pass a new place.
class PassedRaysUpdate : public RayObserver {
 public:
  /// `targets` must outlive it.
  PassedRaysUpdate(const rdf::ReadTransaction& transaction, std::span<const RayTarget> targets,
                   const std::vector<Cloud>& clouds, unsigned threads);
  bool wants(const Cloud& cloud) const override;
  std::unique_ptr<ScanView> view(const Cloud& cloud) const override;
  void take(const ScanView& seen) override;
  /// The counts by target, after all rays were seen. Stores the outcome.
  std::vector<std::optional<perception::RayCounts>> finish(rdf::WriteTransaction& transaction, Covered covered) const;

 private:
  /// A target that has inner places, and what its counts follow from.
  struct Barrier {
    std::size_t target = 0;
    ContentHash id;
    std::span<const Eigen::Vector3d> places;
    Eigen::AlignedBox3d box;  ///< around them
    ContentHash cause;
    perception::RayCounts counts;
  };

  class View;

  std::size_t target_count_;
  std::vector<Barrier> barriers_;
  std::vector<std::size_t> unknown_;  ///< numbers of barriers
};

}  // namespace cluxel::mapping
