// SPDX-License-Identifier: Apache-2.0
// From measured points to the cluxels that hold them now, and from an object to the points that anchor a statement.
#pragma once

#include <map>
#include <vector>

#include "mapping/build/tile_stages.hpp"
#include "mapping/cloud.hpp"
#include "mapping/statements/statement.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::mapping {

inline constexpr std::size_t kAnchorScans = 16;          ///< those with most of the object's points
inline constexpr std::size_t kAnchorPointsOfAScan = 16;  ///< those with the smallest hashes

/// The points that a statement about an object is anchored to: a sample of those that thinning keeps, the same whatever
/// the order of anything. Throws Error (InvalidArgument) for an object without points.
PointAnchor anchorOf(const TileStages& stages, const rules::SemanticObject& object);

/// Finds the cluxels of measured points. The stages must outlive it.
class PointOwners {
 public:
  PointOwners(const rdf::ReadTransaction& transaction, const TileStages& stages, const perception::ThinParams& thin,
              const std::vector<Cloud>& clouds);

  /// The numbers of the scene's cluxels that hold the points, one for each point that the map has. Points of scans that
  /// it does not have are left out. Cost: one reading of each scan that is named, the first time.
  std::vector<std::uint32_t> cluxelsOf(const PointAnchor& anchor);

 private:
  struct Posed {
    scan::ScanPoints points;
    Eigen::Isometry3d T_map_sensor;
  };
  const Posed* posed(const scan::ScanId& id);

  const rdf::ReadTransaction& transaction_;
  const TileStages& stages_;
  perception::ThinParams thin_;
  const std::vector<Cloud>& clouds_;
  std::map<perception::TileKey, std::uint32_t> first_cluxel_;
  std::map<perception::TileKey, perception::RepresentativeFinder> finders_;
  std::map<scan::ScanId, Posed> scans_;
};

}  // namespace cluxel::mapping
