// SPDX-License-Identifier: Apache-2.0
// Which tiles of a commit are kept in memory for calls that follow each other.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "perception/tile.hpp"

namespace cluxel::mapping {

/// The cluxels of a stored tile in MapReader::scene().
struct CluxelRange {
  std::uint32_t first = 0;
  std::size_t count = 0;
};
using CluxelRanges = std::map<perception::TileKey, CluxelRange>;

/// The tiles that the last calls used, of at most `max_cluxels` together.
class RecentTiles {
 public:
  RecentTiles(CluxelRanges ranges, std::size_t max_cluxels) : ranges_(std::move(ranges)), max_cluxels_(max_cluxels) {
    for (const auto& [tile, range] : ranges_) in_map_ += range.count;
  }

  const CluxelRanges& ranges() const { return ranges_; }

  struct Change {
    perception::TileSet dropped, read;
  };
  /// What must be dropped, and then read, for a call that needs these tiles. Absent when they are too many to be kept.
  std::optional<Change> use(const perception::TileSet& tiles) {
    if (cluxelsIn(tiles) > max_cluxels_) return std::nullopt;
    Change change;
    for (const perception::TileKey& tile : tiles)
      if (!last_use_.contains(tile)) change.read.insert(tile);
    // Who asks twice may ask for all. To read a tile, all scans in it are unpacked, so all tiles are read at once.
    if (!change.read.empty() && !last_use_.empty() && in_map_ <= max_cluxels_)
      for (const auto& [tile, range] : ranges_)
        if (!last_use_.contains(tile)) change.read.insert(tile);
    ++calls_;
    for (const perception::TileKey& tile : change.read) last_use_[tile] = calls_;
    for (const perception::TileKey& tile : tiles) last_use_[tile] = calls_;
    change.dropped = takeOldest();
    return change;
  }
  void clear() { last_use_.clear(); }

 private:
  perception::TileSet takeOldest() {
    std::vector<std::pair<std::uint64_t, perception::TileKey>> oldest;
    std::size_t cluxels = 0;
    for (const auto& [tile, call] : last_use_) oldest.emplace_back(call, tile), cluxels += countOf(tile);
    std::sort(oldest.begin(), oldest.end());
    perception::TileSet taken;
    for (auto next = oldest.begin(); cluxels > max_cluxels_ && next->first != calls_; ++next) {
      taken.insert(next->second), last_use_.erase(next->second);
      cluxels -= countOf(next->second);
    }
    return taken;
  }

  std::size_t cluxelsIn(const perception::TileSet& tiles) const {
    std::size_t count = 0;
    for (const perception::TileKey& tile : tiles) count += countOf(tile);
    return count;
  }
  std::size_t countOf(const perception::TileKey& tile) const {
    const auto range = ranges_.find(tile);
    return range == ranges_.end() ? 0 : range->second.count;
  }

  CluxelRanges ranges_;
  std::size_t max_cluxels_, in_map_ = 0;
  std::map<perception::TileKey, std::uint64_t> last_use_;  ///< of the tiles that are kept: number of the call
  std::uint64_t calls_ = 0;
};

}  // namespace cluxel::mapping
