// SPDX-License-Identifier: Apache-2.0
// A cell reads points of its own band of rows and of the two beside it.
#include "tasks/ways/low_points.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

namespace cluxel::tasks {

namespace {

/// The rows of a tile where cells have a quarter of a metre.
constexpr int kRowsInBand = 64;

}  // namespace

LowPoints::LowPoints(const GridFrame& frame, std::size_t most_in_memory)
    : frame_(frame),
      reach_(std::max(1, static_cast<int>(std::lround(0.5 / frame.cell_m)))),
      rows_in_band_(std::max(kRowsInBand, reach_)),
      most_in_memory_(most_in_memory),
      bands_(static_cast<std::size_t>(bandOf(frame.rows - 1) + 1)),
      had_thing_(frame.size(), 0) {}

void LowPoints::add(std::uint32_t cell, const Eigen::Vector3d& p_map) {
  const Eigen::Vector3f place = (p_map - Eigen::Vector3d(frame_.min_x, frame_.min_y, 0)).cast<float>();
  bands_[bandOf(frame_.rowOf(cell))].points.push_back({cell, place.x(), place.y(), place.z()});
  if (++in_memory_ >= most_in_memory_) moveToFile();
}

void LowPoints::moveToFile() {
  for (Band& band : bands_) {
    const std::vector<LowPoint> points = std::exchange(band.points, {});
    if (points.empty()) continue;
    const std::string_view bytes(reinterpret_cast<const char*>(points.data()), points.size() * sizeof(LowPoint));
    band.in_file.push_back({file_.append(bytes), points.size()});
  }
  in_memory_ = 0;
}

void LowPoints::sortByCell(int number) {
  Band& band = bands_[number];
  std::vector<LowPoint> points = std::exchange(band.points, {});
  for (const Piece& piece : band.in_file) {
    const std::size_t before = points.size();
    points.resize(before + piece.count);
    file_.read(piece.place, reinterpret_cast<char*>(points.data() + before), piece.count * sizeof(LowPoint));
  }
  const std::uint32_t begin = frame_.index(0, number * rows_in_band_);
  const std::uint32_t end = frame_.index(0, std::min(frame_.rows, (number + 1) * rows_in_band_));
  band.first.assign(end - begin + 1, 0);
  for (const LowPoint& point : points) ++band.first[point.cell - begin + 1];
  for (std::size_t i = 1; i < band.first.size(); ++i) band.first[i] += band.first[i - 1];
  std::vector<std::uint32_t> next(band.first.begin(), band.first.end() - 1);
  band.points.resize(points.size());
  for (const LowPoint& point : points) band.points[next[point.cell - begin]++] = point;
}

void LowPoints::refine(TerrainGrid& grid) {
  surface_ = grid.height;
  const int count = static_cast<int>(bands_.size());
  if (count > 0) sortByCell(0);
  for (int band = 0; band < count; ++band) {
    if (band + 1 < count) sortByCell(band + 1);
    const std::uint32_t end = frame_.index(0, std::min(frame_.rows, (band + 1) * rows_in_band_));
    for (std::uint32_t cell = frame_.index(0, band * rows_in_band_); cell < end; ++cell)
      if (grid.seen[cell] != 0) refineCell(cell, grid);
    if (band > 0) bands_[band - 1] = {};
  }
}

void LowPoints::refineCell(std::uint32_t cell, TerrainGrid& grid) {
  // The lowest of few heights may be that of a stray return.
  constexpr std::size_t enough = 3, enough_for_quartile = 8;
  const Eigen::Vector2f slope(slopeOf(cell, 1, 0), slopeOf(cell, 0, 1));
  const bool had_thing = had_thing_[cell] != 0;
  const std::size_t wanted = had_thing ? enough_for_quartile : enough;
  heights_.clear();
  for (int ring = 0; ring <= reach_ && heights_.size() < wanted; ++ring) takeHeightsWithin(cell, ring, slope);
  if (heights_.size() < enough) return;
  const bool takes_quartile = had_thing && heights_.size() >= enough_for_quartile;
  const std::size_t rank = heights_.size() / (takes_quartile ? 4 : 2);
  const auto chosen = heights_.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(heights_.begin(), chosen, heights_.end());
  grid.height[cell] = *chosen;
}

/// Sets heights_ to those of the cells up to `ring` columns and rows away.
void LowPoints::takeHeightsWithin(std::uint32_t cell, int ring, const Eigen::Vector2f& slope) {
  heights_.clear();
  const int x = frame_.columnOf(cell), y = frame_.rowOf(cell);
  const int left = std::max(0, x - ring), right = std::min(frame_.columns - 1, x + ring);
  const Eigen::Vector2f middle = (frame_.centreOf(cell) - Eigen::Vector2d(frame_.min_x, frame_.min_y)).cast<float>();
  for (int row = std::max(0, y - ring); row <= std::min(frame_.rows - 1, y + ring); ++row) {
    const Band& band = bands_[bandOf(row)];
    const std::uint32_t begin = frame_.index(0, bandOf(row) * rows_in_band_);
    for (std::uint32_t i = band.first[frame_.index(left, row) - begin];
         i < band.first[frame_.index(right, row) - begin + 1]; ++i) {
      const LowPoint& point = band.points[i];
      heights_.push_back(point.height_m - slope.dot(Eigen::Vector2f(point.x, point.y) - middle));
    }
  }
}

/// Of the surface over two metres, as far as there is one.
float LowPoints::slopeOf(std::uint32_t cell, int dx, int dy) const {
  const int x = frame_.columnOf(cell), y = frame_.rowOf(cell);
  const int reach = std::max(1, static_cast<int>(std::lround(1 / frame_.cell_m)));
  const auto end = [&](int direction) {
    int last = 0;
    for (int i = 1; i <= reach; ++i) {
      const int column = x + direction * i * dx, row = y + direction * i * dy;
      if (!frame_.holds(column, row) || std::isnan(surface_[frame_.index(column, row)])) break;
      last = direction * i;
    }
    return last;
  };
  const int from = end(-1), to = end(1);
  if (from == to) return 0;
  const float rise =
      surface_[frame_.index(x + to * dx, y + to * dy)] - surface_[frame_.index(x + from * dx, y + from * dy)];
  return rise / static_cast<float>((to - from) * frame_.cell_m);
}

}  // namespace cluxel::tasks
