// SPDX-License-Identifier: Apache-2.0
// Last stage: the scene from the outputs of all tiles. Components are joined across tiles, partial results merged.
#pragma once

#include <map>

#include "perception/features/even_tile.hpp"
#include "perception/features/feature_tile.hpp"
#include "perception/segments/component_tile.hpp"
#include "perception/segments/contact_tile.hpp"
#include "perception/segments/scene.hpp"
#include "perception/segments/summary_tile.hpp"

namespace cluxel::perception {

/// The tolerances of relations; see relationInfos().
struct RelationParams {
  double touches_m = 0.20;       ///< largest gap of primitives that touch
  double near_m = 1.0;           ///< largest gap of primitives that are near
  double above_m = 0.25;         ///< smallest mean height difference of `above`
  double stands_on_m = 0.30;     ///< largest gap of `stands_on`
  double ground_m = 1.0;         ///< lowest points higher than this above the ground have no touches_ground
  double inside_share = 0.9;     ///< smallest share of the box that is inside the other's
  double parallel_rad = 0.1745;  ///< largest angle between parallel directions (10 degrees)
};
void describe(RelationParams& params, ParameterVisitor& visitor);

/// Outputs of every stage by tile.
struct TileOutputs {
  TileGrid grid;
  std::map<TileKey, TilePoints> points;
  std::map<TileKey, CluxelTile> cluxels;
  std::map<TileKey, SummaryTile> summaries;
  std::map<TileKey, GroundTile> ground;
  std::map<TileKey, EvenTile> even;
  std::map<TileKey, FeatureTile> features;
  std::map<TileKey, LabelTile> labels;
  std::map<TileKey, ComponentTile> components;
  std::map<TileKey, ContactTile> contacts;
};

/// The scene of all tiles, from their summaries and what is computed of them; points, cluxels and even ground are not
/// read. The other maps must have the same keys. `views`: of the scans whose sensor's place is known, in any order.
/// Throws Error (StoreUnavailable) when outputs do not belong together. Cost: about 1 microsecond a cluxel.
Scene assembleScene(const TileOutputs& tiles, const RelationParams& params, std::vector<SceneView> views = {});

/// The scene of some of a map's tiles.
struct SceneWindow {
  Scene scene;
  std::vector<char> is_cut;  ///< by primitive: it continues in a tile that is not held
};
/// The same for some tiles of a map. `elsewhere`: the map's other tiles, as far as they are next to those that are
/// held; of them only the ground is read. Cut primitives have the ids and attributes of what is held of them. `hidden`:
/// tiles next to them that do not count, as if nothing led there.
SceneWindow assembleWindow(const TileOutputs& tiles, const TileSet& elsewhere, const TileSet& hidden,
                           const RelationParams& params, std::vector<SceneView> views = {});

/// The cluxels of the same scene alone, without their primitives, with the same errors. Cost: about 100 ns a cluxel.
SceneCluxels assembleCluxels(const TileOutputs& tiles, const TileSet& elsewhere);

/// The seeds of its cluxels alone, with the same errors. Cost: about 50 ns a cluxel.
SceneSeeds seedsOf(const TileOutputs& tiles);

}  // namespace cluxel::perception
