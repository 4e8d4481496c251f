// SPDX-License-Identifier: Apache-2.0
// The part of a map around a change: its tiles, its scene, and what the map knew of it before the change.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "mapping/build/tile_stages.hpp"
#include "mapping/cloud.hpp"
#include "mapping/layers/tile_layer.hpp"
#include "perception/segments/scene_assembly.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::mapping {

/// What the map knew of a primitive.
struct KnownPrimitive {
  std::uint64_t input = 0, trace = 0;  ///< as in TileLayer
};

struct MapWindow {
  perception::TileSet tiles;                                  ///< that are held, and those that are gone
  perception::TileSet elsewhere;                              ///< other tiles of the map next to them
  perception::Scene scene;                                    ///< after the change
  std::vector<char> is_cut;                                   ///< by primitive
  std::vector<std::uint64_t> inputs;                          ///< by primitive: inputHashes()
  std::map<perception::TileKey, std::uint32_t> first_cluxel;  ///< of each tile, in the scene
  std::map<perception::TileKey, std::vector<perception::PrimitiveIndex>> primitive_of_component;
  std::map<perception::TileKey, TileLayer> layers;  ///< before the change; tiles that are new have none
  std::map<ContentHash, KnownPrimitive> known;      ///< before the change, by id
};

/// The window of the tiles `rings` around the changed ones and of `more`. Absent when it would hold more than
/// `max_share` of the map's tiles, or when the map lacks layers: then the whole map is computed.
std::optional<MapWindow> windowAround(const rdf::ReadTransaction& transaction, TileStages& stages,
                                      const OutputChanges& changes, const perception::TileSet& more, int rings,
                                      const std::vector<Cloud>& clouds, double max_share);

/// For each cluxel of the window's scene its number in the layer of its tile before the change; kNoFormer for new ones.
inline constexpr std::uint32_t kNoFormer = 0xFFFFFFFFU;
std::vector<std::uint32_t> formerNumbers(const MapWindow& window, const TileStages& stages,
                                         const OutputChanges& changes);

}  // namespace cluxel::mapping
