// SPDX-License-Identifier: Apache-2.0
// Bands of tiles: points that do not fit in memory at once go through the stages band by band. Each stage stores each
// tile once.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "perception/clustering/tile_points.hpp"
#include "perception/stage.hpp"
#include "perception/tile.hpp"

namespace cluxel::perception {

/// Points of scans by tile, the input of the first stage.
using TileSegments = std::map<TileKey, std::vector<ScanSegment>>;

/// The rows of tiles that bands consist of lie across this axis of the map.
enum class Axis : std::uint8_t { X, Y };

/// The axis along which the tiles reach farther; X when there are none.
Axis longerAxis(const TileSet& tiles);

/// The number of the row of a tile.
inline std::int32_t rowOf(const TileKey& key, Axis axis) {
  return axis == Axis::X ? key.x : key.y;
}

/// After the last row.
inline constexpr std::int64_t kEndOfRows = std::numeric_limits<std::int64_t>::max();

struct PointBand {
  TileSegments segments;
  std::int64_t end = kEndOfRows;  ///< no later band has segments in rows before it
};

/// Gives the points of a run band by band, with ascending rows.
class PointBands {
 public:
  virtual ~PointBands() = default;
  virtual Axis axis() const = 0;
  /// To be called until a band ends at kEndOfRows.
  virtual PointBand next() = 0;
};

/// How far each stage has come. A stage reads the tiles around its own, so that it stays behind the stages that it
/// reads by a row for each.
class StageFront {
 public:
  explicit StageFront(Axis axis) : axis_(axis) {}

  /// The points are complete in the rows before `end`.
  void moveTo(std::int64_t end) { from_ = std::exchange(end_, end); }
  Axis axis() const { return axis_; }
  std::int32_t rowOf(const TileKey& key) const { return perception::rowOf(key, axis_); }
  /// The row before which the stage may compute its tiles.
  std::int64_t endOf(Stage stage) const { return behind(end_, stage); }
  /// Whether the stage may compute the tile since the last move, and not before.
  bool isDue(Stage stage, const TileKey& key) const {
    return rowOf(key) >= behind(from_, stage) && rowOf(key) < endOf(stage);
  }
  TileSet due(Stage stage, const TileSet& tiles) const;
  /// In the order of rows.
  std::vector<TileKey> inRows(const TileSet& tiles) const;
  bool isAtEnd() const { return end_ == kEndOfRows; }
  /// No stage will read tiles in rows before this one again.
  std::int64_t firstRead() const { return isAtEnd() ? kEndOfRows : end_ - kFarthest; }

 private:
  static constexpr std::int64_t kBeforeRows = std::numeric_limits<std::int64_t>::min();
  /// Points, cluxels, ground, features, labels, summaries, even, components, contacts.
  static constexpr std::array<std::int64_t, kStageCount> kBehind{0, 1, 2, 3, 4, 1, 3, 4, 5};
  /// How many rows behind the points a stage may still read. Labels, four rows behind, read features one row farther. A
  /// tile may have features of some cluxels from an earlier band; these are computed again with the rest, and read
  /// volumes of cluxels two rows farther.
  static constexpr std::int64_t kFarthest = 7;

  static std::int64_t behind(std::int64_t end, Stage stage) {
    if (end == kEndOfRows || end == kBeforeRows) return end;
    return end - kBehind[static_cast<std::size_t>(stage)];
  }

  Axis axis_;
  std::int64_t from_ = kBeforeRows, end_ = kBeforeRows;
};

}  // namespace cluxel::perception
