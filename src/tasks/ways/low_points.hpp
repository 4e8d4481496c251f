// SPDX-License-Identifier: Apache-2.0
// Points at the height of the ground, which refine the heights of a grid's cells. Memory does not follow their number.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/sorting/temporary_bytes.hpp"
#include "tasks/ways/terrain_grid.hpp"

namespace cluxel::tasks {

/// Points come in any order. They wait in bands of rows of the grid; more than fit into memory go to a temporary file.
/// For one use.
class LowPoints {
 public:
  static constexpr std::size_t kPointsInMemory = 2'000'000;

  /// `frame` must outlive it.
  explicit LowPoints(const GridFrame& frame, std::size_t most_in_memory = kPointsInMemory);

  /// Throws Error (StoreUnavailable) when there is no room for the temporary file.
  void add(std::uint32_t cell, const Eigen::Vector3d& p_map);

  /// Something stood in the cell that does not count. Its lowest points may be among those of the ground.
  void addLeftOut(std::uint32_t cell) { had_thing_[cell] = 1; }

  /// Gives each cell the median height of its points, so that a cell at a kerb has the height of the side of which it
  /// holds more; where something stood that is left out, the lower quartile of at least eight heights. Where a cell has
  /// few points, those within half a metre count, moved along the slope of the surface. `grid` has the heights of the
  /// surface, NaN where there is none.
  void refine(TerrainGrid& grid);

 private:
  struct LowPoint {
    std::uint32_t cell;
    float x, y;  ///< from the corner of the frame [m]
    float height_m;
  };
  struct Piece {
    std::uint64_t place = 0;
    std::size_t count = 0;
  };
  /// Some rows of the grid.
  struct Band {
    std::vector<LowPoint> points;
    std::vector<Piece> in_file;
    std::vector<std::uint32_t> first;  ///< of each cell's points, once they are sorted
  };

  int bandOf(int row) const { return row / rows_in_band_; }
  void moveToFile();
  void sortByCell(int band);
  void refineCell(std::uint32_t cell, TerrainGrid& grid);
  void takeHeightsWithin(std::uint32_t cell, int ring, const Eigen::Vector2f& slope);
  float slopeOf(std::uint32_t cell, int dx, int dy) const;

  const GridFrame& frame_;
  int reach_;         ///< cells within half a metre
  int rows_in_band_;  ///< at least reach_
  std::size_t most_in_memory_, in_memory_ = 0;
  std::vector<Band> bands_;
  LargeArray<std::uint8_t> had_thing_;  ///< 1: addLeftOut()
  LargeArray<float> surface_;           ///< the heights before
  std::vector<float> heights_;          ///< of the cell that is refined
  TemporaryBytes file_;
};

}  // namespace cluxel::tasks
