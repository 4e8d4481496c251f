// SPDX-License-Identifier: Apache-2.0
// The stages from scans to features in memory: for training, tests and benchmarks. Maps run the same stages from
// storage.
#pragma once

#include <map>
#include <span>

#include "cluxel/perception/cluxel_tile.hpp"
#include "cluxel/perception/feature_tile.hpp"
#include "cluxel/perception/ground_tile.hpp"
#include "cluxel/perception/tile_points.hpp"

namespace cluxel {

/// Settings of all stages up to the features.
struct PerceptionParams {
  ThinParams thin;
  CoverParams cover;
  GroundParams ground;
  FeatureParams features;
};
void describe(PerceptionParams& params, ParameterVisitor& visitor);

/// Stored outputs of every stage, by tile. All four have the same keys.
struct PerceivedTiles {
  std::map<TileKey, TilePoints> points;
  std::map<TileKey, CluxelTile> cluxels;
  std::map<TileKey, GroundTile> ground;
  std::map<TileKey, FeatureTile> features;
};

/// Runs the stages over all tiles of the scans, which may come in any order; the outcome does not depend on `threads`.
PerceivedTiles perceive(std::span<const Scan> scans, const PerceptionParams& params, unsigned threads);

}  // namespace cluxel
