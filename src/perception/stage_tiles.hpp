// SPDX-License-Identifier: Apache-2.0
// What a run of the stages needs beside them: sets of tiles, one for each stage, and the time of the processor.
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

class StageTiles {
 public:
  TileSet& operator[](Stage stage) { return tiles_[static_cast<std::size_t>(stage)]; }
  const TileSet& operator[](Stage stage) const { return tiles_[static_cast<std::size_t>(stage)]; }
  void fill(const TileSet& tiles) { tiles_.fill(tiles); }

 private:
  std::array<TileSet, kStageCount> tiles_;
};

/// Whether the features of the tile or of its ring are among the changed ones.
inline bool readsFeatures(const TileKey& key, const StageTiles& changed) {
  const auto ring = ringOf(key);
  return std::any_of(ring.begin(), ring.end(),
                     [&](const TileKey& near) { return changed[Stage::Features].contains(near); });
}

inline TileSet without(TileSet tiles, const TileSet& others) {
  for (const TileKey& key : others) tiles.erase(key);
  return tiles;
}

}  // namespace cluxel::perception
