// SPDX-License-Identifier: Apache-2.0
// A map read region by region: memory follows the largest region, not the map.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <vector>

#include "mapping/map_reader.hpp"

namespace cluxel::mapping {

/// Some tiles of a map, and the objects that begin there.
struct MapRegion {
  perception::TileSet tiles;
  /// Holds cluxels only, and none of their primitives: those of `tiles`, of the tiles next to them, and of `objects`.
  perception::Scene scene;
  std::vector<bool> is_own;                      ///< by cluxel of `scene`: it lies in `tiles`
  std::vector<std::uint32_t> number;             ///< by cluxel of `scene`: its number in MapReader::scene(), ascending
  std::vector<std::uint32_t> object;             ///< by cluxel: number in MapReader::objects(), or kNoObject
  std::vector<rules::SemanticObject> objects;    ///< those whose first tile is in `tiles`, whole; none of ground
  std::vector<std::uint32_t> number_of_objects;  ///< parallel to `objects`: numbers in MapReader::objects()
};

class MapRegions {
 public:
  /// Cuts the map into regions of at most `max_cluxels`, or single tiles. `map` must outlive it. Cost: 5 us a tile and
  /// an object.
  MapRegions(const MapReader& map, std::size_t max_cluxels);
  ~MapRegions();
  MapRegions(const MapRegions&) = delete;
  MapRegions& operator=(const MapRegions&) = delete;

  std::size_t size() const { return regions_.size(); }
  /// The tiles of all regions.
  const perception::TileSet& tiles() const { return all_tiles_; }
  /// Numbers of objects of ground; rays are not compared with them.
  bool isGround(std::uint32_t object) const { return is_ground_[object]; }
  /// Reads a region; gives up the one before. Cost: some milliseconds a tile.
  MapRegion read(std::size_t region);
  using PointVisit = std::function<void(const Eigen::Vector3d& p_map, std::uint32_t cluxel, std::size_t point)>;
  /// Visits those points of the cloud that lie in the tiles of the region, in their order. `cluxel`: number in the
  /// scene of the region, which must be the last that was read; `point`: number in the cloud. Cost: the points of the
  /// cloud; the first call for a region reads the points of all clouds in it.
  void forEachPoint(const MapRegion& region, const Cloud& cloud, const PointVisit& visit);

 private:
  /// What is read of the points of the last region.
  struct RegionPoints;

  void readObjects(MapRegion& region) const;
  void readPoints(const MapRegion& region);

  const MapReader& map_;
  perception::TileSet all_tiles_;
  std::map<perception::TileKey, std::uint32_t> first_cluxel_;                  ///< in MapReader::scene()
  std::map<perception::TileKey, std::vector<std::uint32_t>> objects_of_tile_;  ///< by their first tile; none of ground
  std::vector<bool> is_ground_;
  std::vector<perception::TileSet> regions_;
  MapInputs inputs_;
  std::unique_ptr<TileStages> stages_;
  std::unique_ptr<RegionPoints> points_;
};

}  // namespace cluxel::mapping
