// SPDX-License-Identifier: Apache-2.0
// From the stored outputs of all tiles to the scene: components join across tiles and their partial results merge.
#pragma once

#include <map>

#include "cluxel/perception/component_tile.hpp"
#include "cluxel/perception/contact_tile.hpp"
#include "cluxel/perception/feature_tile.hpp"
#include "cluxel/perception/scene.hpp"

namespace cluxel {

/// The tolerances of relations; see relationInfos().
struct RelationParams {
  double touches_m = 0.20;       ///< largest gap of things that touch
  double near_m = 1.0;           ///< largest gap of things that are near
  double above_m = 0.25;         ///< least mean height difference of what is above
  double stands_on_m = 0.30;     ///< largest gap of what stands on the other
  double ground_m = 1.0;         ///< lowest points higher than this above the ground have no touches_ground
  double inside_share = 0.9;     ///< least share of the box that lies in the other's
  double parallel_rad = 0.1745;  ///< largest angle between parallel directions (10 degrees)
};
void describe(RelationParams& params, ParameterVisitor& visitor);

/// Stored outputs of all tiles. All maps have the same keys.
struct SceneTiles {
  const std::map<TileKey, TilePoints>& points;
  const std::map<TileKey, CluxelTile>& cluxels;
  const std::map<TileKey, FeatureTile>& features;
  const std::map<TileKey, GroundTile>& ground;
  const std::map<TileKey, LabelTile>& labels;
  const std::map<TileKey, ComponentTile>& components;
  const std::map<TileKey, ContactTile>& contacts;
};

/// Cost: about 1 microsecond a cluxel.
Scene assembleScene(const SceneTiles& tiles, const RelationParams& params);

}  // namespace cluxel
