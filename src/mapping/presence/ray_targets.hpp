// SPDX-License-Identifier: Apache-2.0
// The places of objects that the rays of scans are compared with.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <span>
#include <vector>

#include "base/content_hash.hpp"
#include "perception/segments/scene.hpp"
#include "perception/visibility/place.hpp"
#include "rules/language/rule_set.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::mapping {

struct RayTarget {
  ContentHash object;
  std::vector<perception::Place> places;      ///< on it: placesOn()
  std::vector<Eigen::Vector3d> inner_places;  ///< of a barrier: placesWithin(); none of others
};

/// The place of a cluxel, with the extent of it and of those that intersect it and are of the same thing.
perception::Place rayPlaceOf(const perception::SceneCluxels& cluxels, std::uint32_t cluxel,
                             const std::function<bool(std::uint32_t)>& is_of_same_thing);

/// Up to 256 places on an object, at least 0.3 m above the ground where it has such; none of ground.
std::vector<perception::Place> placesOn(const perception::Scene& scene, const rules::SemanticObject& object);

/// Up to 512 places inside the outline of an object [m, map]: at least 0.3 m above the ground, and as far below its top
/// edge there. Rays over the edge are not meant.
std::vector<Eigen::Vector3d> placesWithin(const perception::Scene& scene, const rules::SemanticObject& object);

/// The target of each object. The classes of `rules` tell which objects are barriers.
std::vector<RayTarget> rayTargets(const perception::Scene& scene, std::span<const rules::SemanticObject> objects,
                                  const rules::RuleSet& rules);

/// Targets of objects that are made one after the other, of which some go again. Rays are looked at when all are there,
/// once for all of them.
class LaterTargets {
 public:
  void add(std::vector<RayTarget> targets);
  void remove(const std::set<ContentHash>& objects);

  bool contains(const ContentHash& object) const { return targets_.contains(object); }
  /// All objects that were removed, whether they came again or not.
  const std::set<ContentHash>& removed() const { return removed_; }
  /// By object, ascending. None is left.
  std::vector<RayTarget> take();

 private:
  std::map<ContentHash, RayTarget> targets_;
  std::set<ContentHash> removed_;
};

}  // namespace cluxel::mapping
