// SPDX-License-Identifier: Apache-2.0
// Perception's stages over a map's tiles: outputs are kept in the map file, and only what a change reaches is computed.
#pragma once

#include <map>

#include "cluxel/progress.hpp"
#include "mapping/build/scan_store.hpp"
#include "mapping/map_inputs.hpp"
#include "perception/pipeline.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::mapping {

/// `model` and `params` must outlive it.
class TileStages {
 public:
  TileStages(const perception::LabelModel& model, const MapParams& params)
      : params_{params.labelling, params.component, params.contact, params.relation}, labeller_(model) {}

  /// Brings every stage up to date after scans were stored or removed. Returns the tiles of which an output changed.
  perception::TileSet update(rdf::WriteTransaction& transaction, PointChanges changes, unsigned threads,
                             ProgressSink& sink);
  /// Computes all stages of all tiles: the model or the settings changed. Returns the tiles of which an output changed.
  perception::TileSet updateAll(rdf::WriteTransaction& transaction, PointChanges changes, unsigned threads,
                                ProgressSink& sink);
  /// Decodes all stored outputs. Points are taken from the scans, and what is measured of cluxels from the points.
  void loadAll(const rdf::ReadTransaction& transaction);
  /// The scene of what is loaded, seen from the clouds of the map.
  perception::Scene scene(const std::vector<Cloud>& clouds) const {
    return assembleScene(outputs_, params_.relation, viewsOf(clouds));
  }
  /// The seeds of the scene's cluxels.
  perception::SceneSeeds seeds() const { return seedsOf(outputs_); }

  const std::map<perception::TileKey, perception::TilePoints>& points() const { return outputs_.points; }
  const std::map<perception::TileKey, perception::CluxelTile>& cluxels() const { return outputs_.cluxels; }
  const std::map<perception::TileKey, perception::GroundTile>& ground() const { return outputs_.ground; }

 private:
  perception::TileSet run(rdf::WriteTransaction& transaction, PointChanges changes, unsigned threads, bool compute_all,
                          ProgressSink& sink);

  perception::SceneParams params_;
  perception::TileLabeller labeller_;
  perception::TileOutputs outputs_;
};

}  // namespace cluxel::mapping
