// SPDX-License-Identifier: Apache-2.0
// Third stage: the local ground surface, which follows slopes and continues under buildings, cars and crowns.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "perception/clustering/cluxel_tile.hpp"

namespace cluxel::perception {

struct GroundParams {
  double steepest = 0.5;  ///< rise over run that natural ground may have
  double step_m = 0.2;    ///< height above the slope cone that still counts as ground: kerbs and roughness
};
void describe(GroundParams& params, ParameterVisitor& visitor);

/// The origin of a ground cell's height.
enum class GroundSource : std::uint8_t { Measured, Filled };

/// Heights at the centres of the tile's cell stacks, row by row in y.
struct GroundTile {
  TileKey key;
  std::vector<float> height;  ///< [m, map], always finite
  std::vector<GroundSource> source;

  std::size_t size() const { return height.size(); }
};

/// The ground of the ring's centre tile from the cell stacks of the ring. Every cell gets a height: where no ground was
/// seen, from the ground around it; without any ground in the ring, from the lowest points.
GroundTile groundOf(const Ring<CluxelTile>& ring, const GroundParams& params);

/// Ground height [m, map] at a position relative to the corner of the ring's centre tile [m]: bilinear between cell
/// centres, constant beyond the outermost cells. The centre tile must exist. Both tiles at a border give the same
/// value.
double groundHeightAt(const Ring<GroundTile>& ring, double x_local, double y_local);

std::string toBytes(const GroundTile& tile);
/// Throws Error (StoreUnavailable) when the bytes are damaged or of another kind.
GroundTile groundTileFromBytes(std::string_view bytes);

}  // namespace cluxel::perception
