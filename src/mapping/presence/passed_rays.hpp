// SPDX-License-Identifier: Apache-2.0
// How many rays of the laser went through each barrier: many through a fence, none through a wall.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/content_hash.hpp"
#include "mapping/clouds/cloud.hpp"
#include "mapping/presence/object_rows.hpp"
#include "mapping/presence/ray_pass.hpp"
#include "perception/segments/scene.hpp"
#include "rdf/file/environment.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::mapping {

/// Says which objects rays are counted for.
using CountsRays = std::function<bool(const rules::SemanticObject&)>;

/// Places inside the outline of an object [m, map]: at least 0.3 m above the ground, and as far below its top edge
/// there. Rays over the edge are not meant.
std::vector<Eigen::Vector3d> placesWithin(const perception::Scene& scene, const rules::SemanticObject& object);

/// For each object that `counts_rays` names and that rays reached, how many ended at its inner places or passed them.
/// A function of these places and of the scans whose rays may pass them; where both are those of the stored counts,
/// these are taken. Cost: linear in the rays of the scans that may pass a new place.
class PassedRaysUpdate : public RayObserver {
 public:
  PassedRaysUpdate(const rdf::ReadTransaction& transaction, const perception::Scene& scene,
                   std::span<const rules::SemanticObject> objects, const std::vector<Cloud>& clouds,
                   const CountsRays& counts_rays, unsigned threads);
  bool wants(const Cloud& cloud) const override;
  std::unique_ptr<ScanView> view(const Cloud& cloud) const override;
  void take(const ScanView& seen) override;
  /// The counts by object, after all rays were seen. Stores the outcome.
  std::vector<std::optional<perception::RayCounts>> finish(rdf::WriteTransaction& transaction, Covered covered) const;

 private:
  /// A barrier and what its counts follow from.
  struct Target {
    std::size_t object = 0;
    ContentHash id;
    std::vector<Eigen::Vector3d> places;
    ContentHash cause;
    perception::RayCounts counts;
  };

  class View;

  std::size_t object_count_;
  std::vector<Target> targets_;
  std::vector<std::size_t> unknown_;  ///< numbers of targets
};

}  // namespace cluxel::mapping
