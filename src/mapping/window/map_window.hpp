// SPDX-License-Identifier: Apache-2.0
// The part of a map around a change: its tiles, its scene, and what the map knew of it before the change.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "mapping/build/tile_stages.hpp"
#include "mapping/clouds/cloud.hpp"
#include "mapping/layers/tile_layer.hpp"
#include "perception/segments/scene_assembly.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::mapping {

/// A tile in plan view [m, map].
inline Eigen::AlignedBox2d boxOfTile(const perception::TileGrid& grid, const perception::TileKey& tile) {
  const Eigen::Vector2d corner = grid.cornerOf(tile).head<2>();
  return {corner, Eigen::Vector2d(corner.array() + perception::kTileSize_m)};
}

/// What the map knew of a primitive.
struct KnownPrimitive {
  std::uint64_t input = 0, trace = 0;  ///< as in TileLayer
};

struct MapWindow {
  perception::TileSet tiles;      ///< that are read into `scene`, and changed tiles that the map no longer has
  perception::TileSet elsewhere;  ///< tiles of the map next to them, which are not read
  perception::Scene scene;        ///< after the change
  std::vector<char> is_cut;       ///< by primitive
  std::map<perception::TileKey, std::uint32_t> first_cluxel;  ///< of each tile, in the scene
  std::map<perception::TileKey, std::vector<perception::PrimitiveIndex>> primitive_of_component;
  std::map<perception::TileKey, TileLayer> layers;  ///< before the change; tiles that are new have none
  std::map<ContentHash, KnownPrimitive> known;      ///< before the change, by id
};

/// By primitive: whether it is cut, or something within `reach_m` of it may lie in a tile that is not held.
std::vector<char> openPrimitives(const MapWindow& window, double reach_m);

/// The hash of what reasoning reads of a primitive of a window (perception::PrimitiveInputs).
using InputOf = std::function<std::uint64_t(perception::PrimitiveIndex)>;

/// The summaries that changed tiles had before the change, each read once.
class FormerSummaries {
 public:
  explicit FormerSummaries(const OutputChanges& changes) : changes_(changes) {}

  /// Whether the summary of the tile changed; also when there was none before.
  bool hasChanged(const perception::TileKey& tile) const { return changes_.former_summaries.contains(tile); }
  /// Null where there was none.
  const perception::SummaryTile* of(const perception::TileKey& tile);
  /// Gives their memory back; they are read again when they are needed.
  void drop() { read_.clear(); }

 private:
  const OutputChanges& changes_;
  std::map<perception::TileKey, perception::SummaryTile> read_;
};

/// The window of the tiles `rings` around the changed ones and of `more`. `map`: the tiles that count; what leads to
/// others is left out. Absent when the window would hold more than `max_share` of them, or when the map lacks layers:
/// then the whole map is computed.
std::optional<MapWindow> windowAround(const rdf::ReadTransaction& transaction, TileStages& stages,
                                      const OutputChanges& changes, FormerSummaries& former,
                                      const perception::TileSet& map, const perception::TileSet& more, int rings,
                                      const std::vector<Cloud>& clouds, double max_share);

/// For each cluxel of the window's scene its number in the layer of its tile before the change; kNoFormer for new ones.
inline constexpr std::uint32_t kNoFormer = 0xFFFFFFFFU;
std::vector<std::uint32_t> formerNumbers(const MapWindow& window, const TileStages& stages, FormerSummaries& former);

}  // namespace cluxel::mapping
