// SPDX-License-Identifier: Apache-2.0
// What a map decided about the cluxels of one tile: their primitives and objects.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/content_hash.hpp"
#include "perception/tile.hpp"

namespace cluxel::mapping {

/// Of a cluxel that belongs to no object.
inline constexpr std::uint32_t kNoShare = 0xFFFFFFFFU;

struct TileLayer {
  /// The part of a primitive that lies in the tile.
  struct PrimitiveHere {
    ContentHash id;
    std::uint64_t input = 0;     ///< hash of all that reasoning reads of the primitive; 0 when nobody asked for it
    std::uint64_t trace = 0;     ///< hash of the decisions about it
    Eigen::AlignedBox3f bounds;  ///< of its cluxels here, relative to the tile's corner [m]
  };
  /// The part of an object, or of one of its parts, that lies in the tile.
  struct Share {
    ContentHash object;
    std::string part_class;                 ///< IRI, as ObjectPart::part_class
    std::vector<std::uint32_t> components;  ///< those that hold its cluxels, ascending
  };

  perception::TileKey key;
  std::vector<PrimitiveHere> primitives;       ///< by component of the tile (perception::ComponentTile)
  std::vector<Share> shares;                   ///< ascending by object and part class
  std::vector<std::uint32_t> share_of_cluxel;  ///< a number in `shares`, or kNoShare

  std::size_t size() const { return share_of_cluxel.size(); }
};

/// The box of a primitive's part in a tile, in plan [m, map].
Eigen::AlignedBox2d boxInMap(const TileLayer::PrimitiveHere& primitive, const Eigen::Vector3d& corner);

std::string toBytes(const TileLayer& layer);
/// Throws Error (StoreUnavailable) when the bytes are damaged or of another kind.
TileLayer tileLayerFromBytes(std::string_view bytes);

}  // namespace cluxel::mapping
