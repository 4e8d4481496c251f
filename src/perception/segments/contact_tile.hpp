// SPDX-License-Identifier: Apache-2.0
// Seventh stage: contacts between components of a tile and its ring: links that join components across tiles, and the
// measures from which relations are computed.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "perception/segments/component_tile.hpp"

namespace cluxel::perception {

/// Which pairs of components are recorded.
struct ContactParams {
  double near_m = 1.0;          ///< pairs farther apart are not recorded
  double ground_layer_m = 0.5;  ///< horizontal planes lower than this above the ground are floor: see contactsOf()
};
void describe(ContactParams& params, ParameterVisitor& visitor);

/// A component of the tile and one of the ring that are near each other. Recorded from both ends.
struct Contact {
  std::uint32_t from = 0;          ///< component of the tile
  std::uint32_t to_ring = 0;       ///< which tile of the ring
  std::uint32_t to = 0;            ///< component of that tile
  std::uint32_t linked_edges = 0;  ///< same label and near enough: the two are parts of one primitive
  std::uint32_t edges = 0;         ///< edges of the cluxel graph between them
  std::uint32_t overlaps = 0;      ///< pairs of a footprint cell of `from` and one of `to` that are the same or touch
  double height_difference = 0;    ///< mean height of `from` minus that of `to`, summed over those pairs [m]
  double gap = 0;                  ///< smallest gap between boxes of cluxels or cells [m]
};

/// Contacts of one tile, sorted by (from, to_ring, to).
struct ContactTile {
  TileKey key;
  std::vector<Contact> contacts;
};

/// The floor has no contacts but edges of the cluxel graph within its tile: it is a primitive for each tile. Cost:
/// about 100 ns a point.
ContactTile contactsOf(const Ring<ComponentTile>& components, const Ring<CluxelTile>& cluxels, const FeatureTile& graph,
                       const ComponentParams& component_params, const ContactParams& params);

std::string toBytes(const ContactTile& tile);
/// Throws Error (StoreUnavailable) when the bytes are damaged or of another kind.
ContactTile contactTileFromBytes(std::string_view bytes);

}  // namespace cluxel::perception
