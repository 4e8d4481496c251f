// SPDX-License-Identifier: Apache-2.0
// Brings in memory what a stage is about to read: from the store, from a donor, or computed again.
#pragma once

#include "perception/pipeline.hpp"

namespace cluxel::perception {

/// The tiles of a run.
struct RunTiles {
  TileSet all;        ///< with points
  TileSet emptied;    ///< that lost their points
  TileSet forgotten;  ///< whose stored outputs are not read; every stage computes them
  TileSet lent;       ///< that only the donor has

  TileSet around(const TileSet& tiles) const { return withRing(tiles, all); }
};

/// All arguments must outlive it.
class StageInputs {
 public:
  StageInputs(const PerceptionParams& params, const BorderWidths& widths, TileOutputs& outputs,
              const RunOptions& options, const RunTiles& tiles)
      : params_(params), widths_(widths), out_(outputs), options_(options), tiles_(tiles) {}

  /// Reads what is not there of these tiles from the run's own store.
  void readOwn(const TileSet& tiles);
  /// Reads what is not there of these tiles, but of forgotten ones.
  void read(const TileSet& tiles);
  /// Reads what a stage reads to compute an output for each of `keys`.
  template <typename Tile>
  void readFor(const std::map<TileKey, Tile>& /*stage*/, const TileSet& keys) {
    read(tiles_.around(keys));
  }
  void readFor(const std::map<TileKey, TilePoints>& /*stage*/, const TileSet& /*keys*/) {}
  void readFor(const std::map<TileKey, CluxelTile>& /*stage*/, const TileSet& keys) {
    for (const TileKey& key : keys) volumes_near_.erase(key);  // all its volumes are about to be computed
    read(tiles_.around(keys));
  }
  void readFor(const std::map<TileKey, FeatureTile>& /*stage*/, const TileSet& keys) {
    for (const TileKey& key : keys) rows_near_.erase(key);  // all its rows are about to be computed
    addVolumes(around(keys));
  }
  void readFor(const std::map<TileKey, LabelTile>& /*stage*/, const TileSet& keys) { addRows(keys); }

  /// Cluxels and their 2-ring to HOR and other features (paper 3.1).
  FeatureTile featuresOf(const TileKey& key) const;

  /// Rows of features are not stored; later runs compute them again where they need them. So with volumes. `row`: the
  /// first row of tiles that keeps them.
  void dropRowsBefore(std::int64_t row, Axis axis);
  void dropVolumesBefore(std::int64_t row, Axis axis);

 private:
  /// For each tile the ring places near which something is there, or needed: one bit for each. The centre: everywhere.
  using Places = std::map<TileKey, std::uint32_t>;

  Places around(const TileSet& keys) const;
  void addVolumes(const Places& needed);
  void addRows(const TileSet& keys);

  const PerceptionParams& params_;
  const BorderWidths& widths_;
  TileOutputs& out_;
  const RunOptions& options_;
  const RunTiles& tiles_;
  Places volumes_near_, rows_near_;  ///< of tiles that have volumes or rows of some cluxels only
};

}  // namespace cluxel::perception
