// SPDX-License-Identifier: Apache-2.0
// Third stage: the local ground surface, which follows slopes and runs on under buildings, cars and crowns.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "cluxel/perception/cluxel_tile.hpp"

namespace cluxel {

struct GroundParams {
  double steepest = 0.5;  ///< rise over run that natural ground may have
  double step_m = 0.2;    ///< what may rise above the slope cone and still be ground: kerbs and roughness
};
void describe(GroundParams& params, ParameterVisitor& visitor);

/// How the height of a ground cell is known.
enum class GroundSource : std::uint8_t { Measured, Filled };

/// Heights at the centres of the tile's columns, row by row in y.
struct GroundTile {
  TileKey key;
  std::vector<float> height;  ///< [m, map], always finite
  std::vector<GroundSource> source;

  std::size_t size() const { return height.size(); }
};

/// The ground of the ring's centre tile from the columns of the ring. Every cell gets a height: where no ground was
/// seen, it is filled from ground around it; without any in the ring, from the lowest things seen.
GroundTile groundOf(const Ring<CluxelTile>& ring, const GroundParams& params);

/// Ground height [m, map] at a place relative to the corner of the ring's centre tile [m]: bilinear between cell
/// centres, held constant beyond the outermost known cells. The centre tile must be there. The same value from either
/// tile of a border.
double groundHeightAt(const Ring<GroundTile>& ring, double x_local, double y_local);

std::string toBytes(const GroundTile& tile);
/// Throws Error (StoreUnavailable) when the bytes are not such a tile.
GroundTile groundTileFromBytes(std::string_view bytes);

}  // namespace cluxel
