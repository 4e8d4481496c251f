// SPDX-License-Identifier: Apache-2.0
// What a run of the stages needs beside them: which tiles each stage changed and who reads them, and the time of the
// processor.
#pragma once

#include <algorithm>
#include <array>
#include <ctime>

#include "perception/pipeline.hpp"

namespace cluxel::perception {

inline double processorSeconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

template <typename Tiles>
TileSet keysOf(const Tiles& tiles) {
  TileSet keys;
  for (const auto& [key, tile] : tiles) keys.insert(keys.end(), key);
  return keys;
}

/// For each stage the tiles of which the output changed, and the tiles that read it.
class StageTiles {
 public:
  void note(Stage stage, const TileKey& key, const OutputChange& change) {
    if (!change.is_other) return;
    Changes& changes = stages_[static_cast<std::size_t>(stage)];
    changes.tiles.insert(key);
    if (change.is_read_all) changes.read_by_all.insert(key);
    const auto ring = ringOf(key);
    for (std::size_t place = 0; place < ring.size(); ++place)
      if (change.is_read[place]) changes.readers.insert(ring[place]);
  }
  /// Tiles of which all stages count as changed.
  void fill(const TileSet& tiles) {
    for (std::size_t stage = 0; stage < kStageCount; ++stage)
      for (const TileKey& key : tiles) note(static_cast<Stage>(stage), key, kOtherEverywhere);
  }
  const TileSet& of(Stage stage) const { return stages_[static_cast<std::size_t>(stage)].tiles; }
  /// Tiles that read something that changed in them or near their border; they may be without points.
  const TileSet& readersOf(Stage stage) const { return stages_[static_cast<std::size_t>(stage)].readers; }
  /// Tiles of which something changed that all tiles around them read.
  const TileSet& readByAll(Stage stage) const { return stages_[static_cast<std::size_t>(stage)].read_by_all; }

 private:
  struct Changes {
    TileSet tiles, readers, read_by_all;
  };
  std::array<Changes, kStageCount> stages_;
};

inline TileSet commonOf(const TileSet& a, const TileSet& b) {
  TileSet common;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::inserter(common, common.end()));
  return common;
}

}  // namespace cluxel::perception
