// SPDX-License-Identifier: Apache-2.0
// The sequence of perception's stages, from scans to the scene. One sequence serves maps, which keep outputs and
// recompute what a change reaches, and runs in memory: training, rule tests on clouds, benchmarks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "perception/crf/labelling.hpp"
#include "perception/point_bands.hpp"
#include "perception/segments/scene_assembly.hpp"
#include "perception/tile_borders.hpp"

namespace cluxel::perception {

/// Settings of the stages after the features. (Settings up to the features belong to the model.)
struct SceneParams {
  LabellingParams labelling;
  ComponentParams component;
  ContactParams contact;
  RelationParams relation;
};

/// Whether the stored outputs of a stage begin with what the tiles around read of them: withBorders().
constexpr bool hasBorders(Stage stage) {
  return stage <= Stage::Features;
}

/// How a stored output differs from the one before.
inline OutputChange changeOf(Stage stage, std::string_view before, std::string_view after) {
  if (before == after) return {};
  if (!hasBorders(stage)) return kOtherEverywhere;
  OutputChange change = changeOfBordered(before, after);
  if (stage != Stage::Ground) change.is_read[kRingCentre] = true;  // later stages read all of the tile itself
  return change;
}

/// Cuts scans into tiles. Errors and cost as for splitScan().
TileSegments segmentsOf(std::span<const scan::Scan> scans, const TileGrid& grid);

/// Keeps outputs beyond a run, so that a later run recomputes only what has changed. Called from one thread.
class OutputStore {
 public:
  virtual ~OutputStore() = default;
  /// All tiles with points: with those of the new segments, without those that lost their points.
  virtual TileSet tiles() const = 0;
  /// Reads the stored outputs of `tiles` into `outputs`, except those that are there. Summaries, even ground and
  /// contacts may be left out: no stage reads them. So may volumes of cluxels and rows of features: they are computed
  /// again where they are needed.
  virtual void load(const TileSet& tiles, TileOutputs& outputs) = 0;
  /// Stores one output, and tells how it differs from the one before, as changeOf() does.
  virtual OutputChange store(Stage stage, const TileKey& key, std::string_view bytes) = 0;
  /// Removes an output; does nothing when there is none.
  virtual void erase(Stage stage, const TileKey& key) = 0;
};

/// Outputs that another store keeps of the same stages, model and settings, of other scans. A tile whose inputs are the
/// same in both has the same output, which is then taken instead of being computed.
class OutputDonor {
 public:
  virtual ~OutputDonor() = default;
  /// Where the run's store has no tile yet, the points are those of the donor, and `segments` has none.
  virtual const TileSet& tiles() const = 0;
  virtual std::string_view bytes(Stage stage, const TileKey& key) const = 0;
  /// As OutputStore::load().
  virtual void load(const TileSet& tiles, TileOutputs& outputs) const = 0;
};

/// Watches a run. Called from one thread.
class StageObserver {
 public:
  virtual ~StageObserver() = default;
  virtual void progress(Stage /*stage*/, std::size_t /*done*/, std::size_t /*total*/) {}
  /// `cpu_s` is the processor time of the stage since the last call, all threads together.
  virtual void finished(Stage /*stage*/, double /*cpu_s*/) {}
};

struct RunOptions {
  unsigned threads = 1;               ///< outputs do not depend on it
  OutputStore* store = nullptr;       ///< without a store every tile is computed and kept in memory only
  StageObserver* observer = nullptr;  ///< may be absent
  /// Tiles of which `segments` holds all points; one without segments has lost its points. In other tiles the segments
  /// are added to the points that are there.
  TileSet anew = {};
  bool compute_anew = false;           ///< every stage computes these tiles: the model or settings changed
  const OutputDonor* donor = nullptr;  ///< may be absent; expects a store, and no compute_anew
};

/// Runs all stages: brings `outputs` and the store up to date after segments came in or went. `outputs` then holds what
/// was read or computed, without volumes and rows. Returns the tiles of which an output of some stage changed.
TileSet runStages(TileSegments segments, const TileLabeller& labeller, const SceneParams& params, TileOutputs& outputs,
                  const RunOptions& run);
/// The same, band by band. Expects a store, and no donor. `outputs` then holds what belongs to the last rows.
TileSet runStages(PointBands& bands, const TileLabeller& labeller, const SceneParams& params, TileOutputs& outputs,
                  const RunOptions& run);

/// The same up to the features, in memory. The scans may come in any order.
TileOutputs perceive(std::span<const scan::Scan> scans, const PerceptionParams& params, unsigned threads,
                     const TileGrid& grid = {});

/// The scene of some scans, in memory. The scans may come in any order.
Scene sceneOf(std::span<const scan::Scan> scans, const LabelModel& model, const SceneParams& params, unsigned threads,
              const TileGrid& grid = {});

}  // namespace cluxel::perception
