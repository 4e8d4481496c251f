// SPDX-License-Identifier: Apache-2.0
// Points that do not count are left out of copies of the tiles.
#include "mapping/ways/freed_ground.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

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

/// Where gone things stood, and which scans measured them.
class Stands {
 public:
  Stands(const Ring<TilePoints>& points, const Ring<GroundTile>& ground, const Ring<GonePoints>& gone)
      : ground_(ground) {
    for (int place = 0; place < static_cast<int>(points.size()); ++place) {
      const auto i = static_cast<std::size_t>(place);
      if (points[i] != nullptr && gone[i] != nullptr) add(place, *points[i], *gone[i]);
    }
  }

  bool standsIn(int place) const { return !things_in_[static_cast<std::size_t>(place)].empty(); }

  /// Whether a point that is not of a gone thing counts.
  bool counts(int place, const TilePoints& tile, std::size_t point) const {
    const auto& things_in = things_in_[static_cast<std::size_t>(place)];
    const auto found = things_in.find(cellOf(tile, point));
    if (found == things_in.end() || above(place, tile, point) >= perception::kThingBottom_m) return true;
    const scan::ScanId& scan = tile.scans[tile.scan[point]];
    return std::none_of(found->second.begin(), found->second.end(),
                        [&](std::uint32_t thing) { return scans_of_.at(thing).contains(scan); });
  }

 private:
  void add(int place, const TilePoints& tile, const GonePoints& gone) {
    for (std::size_t point = 0; point < tile.size(); ++point) {
      if (gone[point] == kNotGone) continue;
      scans_of_[gone[point]].insert(tile.scans[tile.scan[point]]);
      if (above(place, tile, point) <= perception::kThingTop_m)
        things_in_[static_cast<std::size_t>(place)][cellOf(tile, point)].insert(gone[point]);
    }
  }

  double above(int place, const TilePoints& tile, std::size_t point) const {
    const Eigen::Vector3f shift = perception::ringShift(place);
    return tile.z[point] - groundHeightAt(ground_, tile.x[point] + shift.x(), tile.y[point] + shift.y());
  }

  const Ring<GroundTile>& ground_;
  std::array<std::map<std::uint32_t, std::set<std::uint32_t>>, 9> things_in_;  ///< by place in the ring, and cell
  std::map<std::uint32_t, std::set<scan::ScanId>> scans_of_;                   ///< by thing
};

/// The places of the points that count.
TilePoints countedOf(int place, const TilePoints& tile, const GonePoints* gone, const Stands& stands) {
  TilePoints counted;
  counted.key = tile.key;
  for (std::size_t point = 0; point < tile.size(); ++point) {
    if (gone != nullptr && (*gone)[point] != kNotGone) continue;
    if (!stands.counts(place, tile, point)) continue;
    counted.x.push_back(tile.x[point]), counted.y.push_back(tile.y[point]), counted.z.push_back(tile.z[point]);
  }
  return counted;
}

}  // namespace

perception::EvenTile freedGroundOf(const Ring<TilePoints>& points, const Ring<GroundTile>& ground,
                                   const Ring<GonePoints>& gone) {
  const Stands stands(points, ground, gone);
  std::array<TilePoints, 9> counted;
  Ring<TilePoints> ring = points;
  for (int place = 0; place < static_cast<int>(points.size()); ++place) {
    const auto i = static_cast<std::size_t>(place);
    if (points[i] == nullptr || (gone[i] == nullptr && !stands.standsIn(place))) continue;
    counted[i] = countedOf(place, *points[i], gone[i], stands);
    ring[i] = &counted[i];
  }
  return evenGroundOf(ring, ground);
}

}  // namespace cluxel::mapping
