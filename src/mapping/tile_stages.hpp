// SPDX-License-Identifier: Apache-2.0
// All stages over a map's tiles: recomputes what depends on changed segments and nothing else.
#pragma once

#include "cluxel/base/progress.hpp"
#include "cluxel/knowledge/environment.hpp"
#include "cluxel/mapping/map_inputs.hpp"
#include "cluxel/perception/label_model.hpp"
#include "cluxel/perception/scene_assembly.hpp"
#include "mapping/stage_outputs.hpp"

namespace cluxel {

class TileStages {
 public:
  TileStages(const LabelModel& model, const MapParams& params) : model_(model), params_(params), labeller_(model) {}

  /// Brings every stage up to date after segments of the tiles `touched` came in.
  void update(WriteTransaction& transaction, const TileSet& touched, unsigned threads, ProgressSink& sink);
  /// Decodes all that the scene is assembled from.
  void loadAll(const ReadTransaction& transaction);
  /// The scene of what is loaded.
  Scene scene() const;

  const std::map<TileKey, TilePoints>& points() const { return points_.tiles(); }
  const std::map<TileKey, CluxelTile>& cluxels() const { return cluxels_.tiles(); }

 private:
  TileSet updatePoints(WriteTransaction& transaction, const TileSet& touched, unsigned threads, ProgressSink& sink);
  void loadAround(const ReadTransaction& transaction, const TileSet& tiles);

  const LabelModel& model_;
  const MapParams& params_;
  TileLabeller labeller_;
  TileSet existing_;
  StageOutputs<TilePoints> points_{tables::kPoints, &tilePointsFromBytes};
  StageOutputs<CluxelTile> cluxels_{tables::kCluxels, &cluxelTileFromBytes};
  StageOutputs<GroundTile> ground_{tables::kGround, &groundTileFromBytes};
  StageOutputs<FeatureTile> features_{tables::kFeatures, &featureTileFromBytes};
  StageOutputs<LabelTile> labels_{tables::kLabels, &labelTileFromBytes};
  StageOutputs<ComponentTile> components_{tables::kComponents, &componentTileFromBytes};
  StageOutputs<ContactTile> contacts_{tables::kContacts, &contactTileFromBytes};
};

}  // namespace cluxel
