// SPDX-License-Identifier: Apache-2.0
// From measured points to the cluxels that hold them now, and from an object to the points that anchor a statement.
#pragma once

#include <functional>
#include <map>
#include <vector>

#include "mapping/build/cluxel_finder.hpp"
#include "mapping/clouds/cloud.hpp"
#include "mapping/statements/statement.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::mapping {

inline constexpr std::size_t kAnchorScans = 16;          ///< those with most of the object's points
inline constexpr std::size_t kAnchorPointsOfAScan = 16;  ///< those with the smallest hashes

/// The points that a statement about an object is anchored to: a sample of those that thinning keeps, the same whatever
/// the order of anything. Cluxel numbers are those of the tiles that `stages` holds, of which the object's have points.
/// Throws Error (InvalidArgument) for an object without points.
PointAnchor anchorOf(const TileStages& stages, const rules::SemanticObject& object);
/// The same for an object of the map. Only its tiles are read. Throws Error (NotFound) when there is none.
PointAnchor anchorOfStored(const rdf::ReadTransaction& transaction, TileStages& stages, const ContentHash& object);

/// Finds the cluxels of measured points.
class PointOwners {
 public:
  /// `stages` holds the tiles of a scene, loads the points of those that are asked for, and must outlive it.
  PointOwners(const rdf::ReadTransaction& transaction, TileStages& stages, const perception::ThinParams& thin,
              const std::vector<Cloud>& clouds);

  /// The numbers of the scene's cluxels that hold the points, one for each point that the scene has. Points of scans
  /// that the map does not have are left out. Throws Error (StoreUnavailable) as CluxelFinder does. Cost: one reading
  /// of each scan and tile that is named, the first time.
  std::vector<std::uint32_t> cluxelsOf(const PointAnchor& anchor);
  /// The tiles in which the points lie, held or not.
  perception::TileSet tilesOf(const PointAnchor& anchor);
  /// In which the tiles of the map lie.
  const perception::TileGrid& grid() const { return grid_; }

 private:
  struct Posed {
    scan::ScanPoints points;
    Eigen::Isometry3d T_map_sensor;
  };
  const Posed* posed(const scan::ScanId& id);
  /// Calls `visit(point_in_map)` for each point of the map.
  void forEachPoint(const PointAnchor& anchor, const std::function<void(const Eigen::Vector3d&)>& visit);

  const rdf::ReadTransaction& transaction_;
  perception::TileGrid grid_;
  TileStages& stages_;
  perception::ThinParams thin_;
  const std::vector<Cloud>& clouds_;
  std::map<perception::TileKey, std::uint32_t> first_cluxel_;
  std::map<perception::TileKey, CluxelFinder> finders_;
  std::map<scan::ScanId, Posed> scans_;
};

}  // namespace cluxel::mapping
