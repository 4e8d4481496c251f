// SPDX-License-Identifier: Apache-2.0
// Takes the steps out of the rises between cells, line by line; the rest is slope.
#include "tasks/ways/ground_relief.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace cluxel::tasks {

namespace {

/// What stands out by less is part of the slope. Heights of cells are wrong by a centimetre, and rises by more.
constexpr float kLeastStep_m = 0.05F;
/// No step is looked for where the ground rises by less.
constexpr float kLeastRise_m = 0.01F;

/// The cells of one line, in the order of their x or y.
class LineRelief {
 public:
  LineRelief(const TerrainGrid& terrain, std::uint32_t first, std::uint32_t pitch, int count)
      : cell_m_(terrain.frame.cell_m),
        per_half_metre_(std::max(1, static_cast<int>(std::lround(0.5 / cell_m_)))),
        rises_(count > 0 ? static_cast<std::size_t>(count - 1) : 0, 0.0F),
        is_known_(rises_.size(), 0),
        steps_(rises_.size(), 0.0F),
        slopes_(rises_.size(), 0.0F) {
    for (std::size_t i = 0; i < rises_.size(); ++i) {
      const std::uint32_t a = first + static_cast<std::uint32_t>(i) * pitch, b = a + pitch;
      is_known_[i] = terrain.seen[a] != 0 && terrain.seen[b] != 0 ? 1 : 0;
      if (is_known_[i] != 0) rises_[i] = terrain.height[b] - terrain.height[a];
    }
    for (int begin = 0; begin < size(); ++begin) {
      float rise = 0;
      for (int end = begin + 1; end <= std::min(size(), begin + per_half_metre_) && is_known_[end - 1] != 0; ++end) {
        rise += rises_[end - 1];
        if (std::abs(rise) > kLeastRise_m) findStep(begin, end, rise);
      }
    }
  }

  /// Between cell `i` of the line and the next [m, upwards].
  float step(std::size_t i) const { return steps_[i]; }

  /// Of a cell, along the line.
  float slope(int cell) const {
    float rise = 0;
    int known = 0;
    for (int i = std::max(0, cell - per_half_metre_); i < std::min(size(), cell + per_half_metre_); ++i) {
      if (is_known_[i] == 0) continue;
      rise += withoutStep(i);
      ++known;
    }
    return known == 0 ? 0.0F : rise / static_cast<float>(known * cell_m_);
  }

 private:
  int size() const { return static_cast<int>(rises_.size()); }

  float withoutStep(int i) const { return std::abs(steps_[i]) > kLeastStep_m ? slopes_[i] : rises_[i]; }

  /// Adds how the ground rises from cell to cell beside a stretch, on one side of it: at the nearest place, the median
  /// of three, and where cells are small the mean of four. Nothing where it is not known.
  void addBeside(int nearest, int direction, float& low, float& high) const {
    std::array<float, 4> rises{};
    std::size_t count = 0;
    for (int i = nearest; count < rises.size() && i >= 0 && i < size() && is_known_[i] != 0; i += direction)
      rises[count++] = rises_[i];
    const auto add = [&](float rise) { low = std::min(low, rise), high = std::max(high, rise); };
    if (count > 0) add(rises[0]);
    if (count == rises.size() && per_half_metre_ >= 4) add((rises[0] + rises[1] + rises[2] + rises[3]) / 4);
    if (count >= 3) add(std::max(std::min(rises[0], rises[1]), std::min(std::max(rises[0], rises[1]), rises[2])));
  }

  /// What `rise`, over some neighbours, is more than a slope like those on either side explains.
  void findStep(int begin, int end, float rise) {
    float low = 0, high = 0, largest = 0;  // of rises from cell to cell that a slope explains
    addBeside(begin - 1, -1, low, high);
    addBeside(end, 1, low, high);
    const auto length = static_cast<float>(end - begin);
    const float step = rise - std::clamp(rise, low * length, high * length);
    if (step == 0) return;
    const auto part = [&](int i) { return (rises_[i] - std::clamp(rises_[i], low, high)) * (step > 0 ? 1.0F : -1.0F); };
    for (int i = begin; i < end; ++i) largest = std::max(largest, part(i));
    // It is where most of it is. Two cells may share it equally.
    constexpr float equal_share = 0.75F;
    for (int i = begin; i < end; ++i) {
      if (part(i) < equal_share * largest || std::abs(step) <= std::abs(steps_[i])) continue;
      steps_[i] = step;
      slopes_[i] = std::clamp(rises_[i], low, high);
    }
  }

  double cell_m_;
  int per_half_metre_;
  std::vector<float> rises_;            ///< from each cell to the next [m]
  std::vector<std::uint8_t> is_known_;  ///< of rises
  std::vector<float> steps_, slopes_;   ///< of each rise: the step in it, and what is left without it
};

}  // namespace

GroundRelief reliefOf(const TerrainGrid& terrain) {
  const GridFrame& frame = terrain.frame;
  GroundRelief relief{LargeArray<float>(frame.size(), 0.0F), LargeArray<float>(frame.size(), 0.0F),
                      LargeArray<float>(frame.size(), 0.0F)};
  for (int row = 0; row < frame.rows; ++row) {
    const LineRelief line(terrain, frame.index(0, row), 1, frame.columns);
    for (int column = 0; column < frame.columns; ++column) relief.slope[frame.index(column, row)] = line.slope(column);
    for (int column = 0; column + 1 < frame.columns; ++column)
      relief.step_east[frame.index(column, row)] = std::abs(line.step(static_cast<std::size_t>(column)));
  }
  for (int column = 0; column < frame.columns; ++column) {
    const LineRelief line(terrain, frame.index(column, 0), static_cast<std::uint32_t>(frame.columns), frame.rows);
    for (int row = 0; row < frame.rows; ++row) {
      float& slope = relief.slope[frame.index(column, row)];
      slope = std::hypot(slope, line.slope(row));
    }
    for (int row = 0; row + 1 < frame.rows; ++row)
      relief.step_north[frame.index(column, row)] = std::abs(line.step(static_cast<std::size_t>(row)));
  }
  return relief;
}

}  // namespace cluxel::tasks
