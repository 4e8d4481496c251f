// SPDX-License-Identifier: Apache-2.0
// Bounds for the number of tiles and for the heights in a tile.
#include "mapping/clouds/scan_plausibility.hpp"

#include <algorithm>
#include <cmath>

#include "cluxel/error.hpp"

namespace cluxel::mapping {

namespace {

constexpr const char* kUnitHint =
    "the coordinates may be in another unit than metres, or the file holds points that are no scan";

/// No surface can be found in a few points on 256 square metres.
void requireDensity(const scan::Scan& scan, std::size_t tiles) {
  constexpr std::size_t kManyTiles = 1000, kFewPointsInTile = 16;
  if (tiles <= kManyTiles || scan.points.size() >= kFewPointsInTile * tiles) return;
  throw InputError({.file = scan.source},
                   "its " + std::to_string(scan.points.size()) + " points lie in " + std::to_string(tiles) +
                       " tiles of 16 m, fewer than " + std::to_string(kFewPointsInTile) +
                       " in each: too sparse for a map",
                   kUnitHint);
}

/// The number of points that lie further from the median height of their tile than any thing outdoors does.
std::size_t countFarFromMedian(std::vector<float> heights) {
  constexpr float kHighest_m = 2000;
  const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
  if (low == heights.end() || *high - *low <= kHighest_m) return 0;
  const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
  std::nth_element(heights.begin(), middle, heights.end());
  const float median = *middle;
  return static_cast<std::size_t>(std::count_if(
      heights.begin(), heights.end(), [median](float height) { return std::abs(height - median) > kHighest_m; }));
}

void requireLowTile(const scan::Scan& scan, const perception::ScanSegment& segment) {
  constexpr std::size_t kMany = 1000, kShare = 10;
  const std::size_t far = countFarFromMedian(segment.z);
  if (far <= kMany || far * kShare <= segment.size()) return;
  throw InputError({.file = scan.source},
                   std::to_string(far) + " of " + std::to_string(segment.size()) +
                       " points in one tile of 16 m lie more than 2 km above or below the others",
                   kUnitHint);
}

}  // namespace

void requirePlausible(const scan::Scan& scan, const std::map<perception::TileKey, perception::ScanSegment>& segments) {
  requireDensity(scan, segments.size());
  for (const auto& [tile, segment] : segments) requireLowTile(scan, segment);
}

}  // namespace cluxel::mapping
