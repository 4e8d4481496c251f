// SPDX-License-Identifier: Apache-2.0
// Points that do not count are left out of copies of the tiles.
#include "mapping/ways/freed_ground.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace cluxel::mapping {

namespace {

using perception::GroundTile;
using perception::kEvenCellsPerTile;
using perception::Ring;
using perception::TilePoints;

std::uint32_t cellOf(const TilePoints& tile, std::size_t point) {
  const auto at = [](float local) {
    return std::clamp(static_cast<int>(local / perception::kEvenCell_m), 0, kEvenCellsPerTile - 1);
  };
  return static_cast<std::uint32_t>(at(tile.y[point]) * kEvenCellsPerTile + at(tile.x[point]));
}

/// How high the ground reaches among low points: the lowest of few may be stray returns.
double highestOfGround(std::vector<double>& heights) {
  constexpr std::size_t enough = 8;
  if (heights.size() < enough) return std::numeric_limits<double>::infinity();
  const auto quartile = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 4);
  std::nth_element(heights.begin(), quartile, heights.end());
  return *quartile + perception::kLargestNoise_m;
}

/// The points of one tile of a ring, in which something stood that is gone.
class FreedPoints {
 public:
  FreedPoints(int place, const TilePoints& tile, const GonePoints& gone, const Ring<GroundTile>& ground)
      : shift_(perception::ringShift(place)), tile_(tile), gone_(gone), ground_(ground) {
    std::map<std::uint32_t, std::vector<double>> low_in;  // of cells where something stood
    for (std::size_t point = 0; point < tile.size(); ++point)
      if (gone[point] != 0 && above(point) <= perception::kThingTop_m) low_in[cellOf(tile, point)];
    for (std::size_t point = 0; point < tile.size(); ++point) {
      const auto heights = gone[point] != 0 ? low_in.end() : low_in.find(cellOf(tile, point));
      if (heights == low_in.end()) continue;
      if (const double height = above(point); std::abs(height) < perception::kThingBottom_m)
        heights->second.push_back(height);
    }
    for (auto& [cell, heights] : low_in) highest_in_.emplace(cell, highestOfGround(heights));
  }

  /// The places of the points that count.
  TilePoints counted() const {
    TilePoints counted;
    counted.key = tile_.key;
    for (std::size_t point = 0; point < tile_.size(); ++point) {
      if (gone_[point] != 0 || isOfFoot(point)) continue;
      counted.x.push_back(tile_.x[point]), counted.y.push_back(tile_.y[point]), counted.z.push_back(tile_.z[point]);
    }
    return counted;
  }

 private:
  double above(std::size_t point) const {
    return tile_.z[point] - groundHeightAt(ground_, tile_.x[point] + shift_.x(), tile_.y[point] + shift_.y());
  }

  bool isOfFoot(std::size_t point) const {
    const auto highest = highest_in_.find(cellOf(tile_, point));
    if (highest == highest_in_.end()) return false;
    const double height = above(point);
    return height < perception::kThingBottom_m && height > highest->second;
  }

  Eigen::Vector3f shift_;
  const TilePoints& tile_;
  const GonePoints& gone_;
  const Ring<GroundTile>& ground_;
  std::map<std::uint32_t, double> highest_in_;  ///< of the ground above its surface [m], by cell where something stood
};

}  // namespace

perception::EvenTile freedGroundOf(const Ring<TilePoints>& points, const Ring<GroundTile>& ground,
                                   const Ring<GonePoints>& gone) {
  std::array<TilePoints, 9> counted;
  Ring<TilePoints> ring = points;
  for (std::size_t place = 0; place < points.size(); ++place) {
    if (points[place] == nullptr || gone[place] == nullptr) continue;
    counted[place] = FreedPoints(static_cast<int>(place), *points[place], *gone[place], ground).counted();
    ring[place] = &counted[place];
  }
  return evenGroundOf(ring, ground);
}

}  // namespace cluxel::mapping
