// SPDX-License-Identifier: Apache-2.0
// What a tile contributes to the ways of a map. The map's ways are a merge of these.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/ways/even_ground.hpp"

namespace cluxel::mapping {

inline constexpr std::uint16_t kNoRegion = 0xffff;

/// Cells of lines one cell wide, in the order of their numbers in the tile.
struct LineCells {
  std::vector<std::uint16_t> cell;
  std::vector<std::uint16_t> edge_distance2;  ///< as of squaredEdgeDistances()
  std::vector<float> height;                  ///< of the ground [m, map]
};

/// What one sees from a cell of a middle line across it.
struct AcrossWay {
  std::uint8_t left = 0, right = 0;  ///< to the edge of even ground [kMarchStep_m]
  bool is_lower = false;             ///< beyond an edge the ground is lower by a kerb
  bool is_higher = false;            ///< the same for higher ground
};

/// Open cells of the tile that are connected within it.
struct RegionPart {
  std::uint16_t first = 0;  ///< its first cell
  std::uint16_t cells = 0;
  std::uint8_t min_x = 0, min_y = 0, max_x = 0, max_y = 0;  ///< columns and rows in the tile
};

/// A part of this tile and one of another tile of its ring belong together.
struct RegionLink {
  std::uint8_t ring = 0;             ///< as ringOf(); each pair of tiles is named by the later one
  std::uint16_t own = 0, other = 0;  ///< numbers of parts
  auto operator<=>(const RegionLink&) const = default;
};

struct WayTile {
  perception::TileKey key;
  LineCells middle;                   ///< of ways
  std::vector<AcrossWay> across;      ///< by number in `middle`
  std::vector<std::uint16_t> region;  ///< by number in `middle`: the part it lies in, or kNoRegion
  LineCells kerbs;
  std::vector<float> step_m;      ///< by number in `kerbs`; 0 where there is none
  std::vector<RegionPart> parts;  ///< those that touch the border or are regions; ascending
  std::vector<RegionLink> links;  ///< ascending
};

inline constexpr double kMarchStep_m = 0.125;
inline constexpr double kFarthestSide_m = 12;

std::string toBytes(const WayTile& tile);
/// Throws Error (StoreUnavailable) when the bytes are damaged or of another kind.
WayTile wayTileFromBytes(std::string_view bytes);

std::string surfaceBytes(const perception::TileKey& key, const SurfaceTile& surface);
SurfaceTile surfaceTileFromBytes(std::string_view bytes, const perception::TileKey& key);

}  // namespace cluxel::mapping
