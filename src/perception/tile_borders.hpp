// SPDX-License-Identifier: Apache-2.0
// What the tiles around a tile read of its outputs. A change that none of them reads is not handed on to them.
#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <string>
#include <string_view>

#include "perception/crf/labelling.hpp"
#include "perception/features/feature_tile.hpp"

namespace cluxel::perception {

/// How far from the edge of a tile the stages read its outputs, for the tile next to it [m].
struct BorderWidths {
  double points = 0, cluxels = 0, ground = 0, features = 0;
  double ground_by_points = 0;  ///< and how far from a point of the tile its ground is read
  double volumes = 0;           ///< and how far volumes are read for rows of features that lie within `features`
};
BorderWidths borderWidths(const PerceptionParams& perception, const LabellingParams& labelling);

/// The neighbours of a tile that are within a distance of a position in it: one bit for each place of the ring.
std::uint32_t neighboursNear(const Eigen::Vector3f& p_local, double width_m);

/// Digests of what later stages read of an output.
struct TileBorders {
  std::array<std::uint64_t, 9> by{};  ///< by ring place: what that neighbour reads; in the centre: the tile itself
  std::uint64_t by_all = 0;           ///< what all neighbours read, wherever they lie
};

/// Positions of points. Cost: about 5 ns a point.
TileBorders bordersOf(const TilePoints& tile, const BorderWidths& widths);
/// Cluxels with their numbers and volumes, and cell stacks. All read the lowest points of all cell stacks.
TileBorders bordersOf(const CluxelTile& tile, const BorderWidths& widths);
/// Heights. The tile itself reads the lowest height and those near its points; `cluxels` are of the same tile.
TileBorders bordersOf(const GroundTile& tile, const CluxelTile& cluxels, const BorderWidths& widths);
/// Rows of cluxels and of their edges, which do not depend on the numbers of cluxels.
TileBorders bordersOf(const FeatureTile& tile, const BorderWidths& widths);

/// How one stored output of a tile differs from another.
struct OutputChange {
  bool is_other = false;     ///< the output differs
  std::bitset<9> is_read;    ///< by ring place: something that differs is read there
  bool is_read_all = false;  ///< something that differs is read by all neighbours
};
inline constexpr OutputChange kOtherEverywhere{true, 0x1ff, true};

/// Stored outputs with borders: the digests stand before the bytes of the tile.
std::string withBorders(const TileBorders& borders, std::string_view tile_bytes);
/// The bytes of the tile; of earlier versions, which stored no borders, the whole block. Throws Error
/// (StoreUnavailable) when the block is cut short.
std::string_view withoutBorders(std::string_view block);
/// Compares two blocks that withBorders() made.
OutputChange changeOfBordered(std::string_view before, std::string_view after);

}  // namespace cluxel::perception
