// SPDX-License-Identifier: Apache-2.0
// Volumes are entered into all grid cells they touch; a pair counts in the one cell where its intersection begins.
#include "perception/cluxel_graph.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "perception/radix_order.hpp"
#include "perception/vector_lanes.hpp"

namespace cluxel {
namespace {

Volume emptyVolume() {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  return {Eigen::Vector3f::Constant(kInfinity), Eigen::Vector3f::Constant(-kInfinity)};
}

void extend(Volume& hull, const Volume& volume) {
  hull.low = hull.low.cwiseMin(volume.low);
  hull.high = hull.high.cwiseMax(volume.high);
}

/// Calls `visit(ring place, number, volume)` for every cluxel of the ring whose volume intersects `hull`.
template <typename Visit>
void forEachTouching(const Ring<CluxelTile>& ring, const Volume& hull, const Visit& visit) {
  for (int r = 0; r < 9; ++r) {
    const CluxelTile* tile = ring[static_cast<std::size_t>(r)];
    if (tile == nullptr) continue;
    const Eigen::Vector3f shift = ringShift(r);
    for (std::uint32_t i = 0; i < tile->size(); ++i) {
      const Volume volume{tile->volume_min[i] + shift, tile->volume_max[i] + shift};
      if (intersects(volume, hull)) visit(r, i, volume);
    }
  }
}

Member memberOf(const CluxelTile& tile, std::uint32_t i, const Eigen::Vector3f& center) {
  const auto& s = tile.own[i].scatter;
  const float n = tile.own[i].count;
  return {{center.x(), center.y(), center.z(), 0},
          {center.y(), center.z(), center.x(), 0},
          {s[0] / n, s[3] / n, s[5] / n, tile.box_min[i].z()},
          {s[1] / n, s[4] / n, s[2] / n, tile.box_max[i].z()}};
}

using Cell = std::array<std::int32_t, 3>;

/// The grid cells that volumes touch.
class VolumeCells {
 public:
  explicit VolumeCells(const RingCluxels& cluxels) {
    Volume hull = emptyVolume();
    float least = std::numeric_limits<float>::infinity(), largest = 0;
    double sum = 0;
    for (const auto& volume : cluxels.volume) {
      extend(hull, volume);
      const float size = (volume.high - volume.low).maxCoeff();
      least = std::min(least, size);
      largest = std::max(largest, size);
      sum += size;
    }
    origin_ = hull.low;
    const auto mean = static_cast<float>(sum / static_cast<double>(cluxels.size()));
    per_m_ = 1.0F / std::max({0.05F, 1.5F * mean, largest / 6.0F});
  }
  Cell cellOf(const Eigen::Vector3f& p) const {
    Cell cell;
    for (int i = 0; i < 3; ++i)
      cell[static_cast<std::size_t>(i)] = static_cast<std::int32_t>((p[i] - origin_[i]) * per_m_);
    return cell;
  }
  static std::uint64_t keyOf(const Cell& cell) {
    return static_cast<std::uint64_t>(cell[0]) << 40U | static_cast<std::uint64_t>(cell[1]) << 20U |
           static_cast<std::uint64_t>(cell[2]);
  }

 private:
  Eigen::Vector3f origin_;
  float per_m_ = 1;
};

struct Entries {
  std::vector<KeyedItem> entry;       ///< (cell, cluxel), sorted
  std::vector<Cell> first_cell;       ///< per cluxel: the cell of its volume's low corner
};

Entries enterVolumes(const RingCluxels& cluxels) {
  const VolumeCells cells(cluxels);
  Entries entries;
  entries.entry.reserve(6 * cluxels.size());
  entries.first_cell.resize(cluxels.size());
  for (std::uint32_t c = 0; c < cluxels.size(); ++c) {
    const Cell low = cells.cellOf(cluxels.volume[c].low), high = cells.cellOf(cluxels.volume[c].high);
    entries.first_cell[c] = low;
    for (std::int32_t x = low[0]; x <= high[0]; ++x)
      for (std::int32_t y = low[1]; y <= high[1]; ++y)
        for (std::int32_t z = low[2]; z <= high[2]; ++z) entries.entry.push_back({VolumeCells::keyOf({x, y, z}), c});
  }
  sortByKey(entries.entry);
  return entries;
}

/// Whether the intersection of two volumes begins in this cell: their low corners' cells, axis by axis the later one.
bool beginsHere(const Cell& a, const Cell& b, std::uint64_t key) {
  return VolumeCells::keyOf({std::max(a[0], b[0]), std::max(a[1], b[1]), std::max(a[2], b[2])}) == key;
}

struct Pair {
  std::uint32_t a, b;
};

/// A volume in vectors; the last lanes let a pair through only when one of the two is near.
struct Box {
  Floats low, high;
};

std::vector<Box> boxesOf(const RingCluxels& cluxels) {
  std::vector<Box> boxes;
  boxes.reserve(cluxels.size());
  for (std::size_t c = 0; c < cluxels.size(); ++c) {
    const auto &low = cluxels.volume[c].low, &high = cluxels.volume[c].high;
    const float near = cluxels.near[c] ? 1.0F : 0.0F;
    boxes.push_back({Floats{low.x(), low.y(), low.z(), 1.0F - near}, Floats{high.x(), high.y(), high.z(), near}});
  }
  return boxes;
}

bool meet(const Box& a, const Box& b) { return allHold((a.low <= b.high) & (b.low <= a.high)); }

std::vector<Pair> intersectingPairs(const RingCluxels& cluxels, const Entries& entries) {
  std::vector<Pair> pairs;
  pairs.reserve(8 * cluxels.size());
  const auto boxes = boxesOf(cluxels);
  const auto& entry = entries.entry;
  for (std::size_t begin = 0, end = 0; begin < entry.size(); begin = end) {
    for (end = begin + 1; end < entry.size() && entry[end].key == entry[begin].key;) ++end;
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t j = i + 1; j < end; ++j) {
        const std::uint32_t a = entry[i].item, b = entry[j].item;
        if (!meet(boxes[a], boxes[b])) continue;
        if (beginsHere(entries.first_cell[a], entries.first_cell[b], entry[begin].key)) pairs.push_back({a, b});
      }
  }
  return pairs;
}

void reserve(RingCluxels& cluxels, std::size_t count) {
  cluxels.name.reserve(count), cluxels.center.reserve(count), cluxels.volume.reserve(count);
  cluxels.member.reserve(count), cluxels.reach.reserve(count), cluxels.near.reserve(count);
}

}  // namespace

RingCluxels gatherCluxels(const Ring<CluxelTile>& ring) {
  const CluxelTile& own = *ring[kRingCentre];
  Volume own_hull = emptyVolume();
  for (std::size_t i = 0; i < own.size(); ++i) extend(own_hull, {own.volume_min[i], own.volume_max[i]});
  Volume near_hull = own_hull;
  forEachTouching(ring, own_hull, [&](int, std::uint32_t, const Volume& volume) { extend(near_hull, volume); });
  RingCluxels cluxels;
  reserve(cluxels, 2 * own.size());
  forEachTouching(ring, near_hull, [&](int r, std::uint32_t i, const Volume& volume) {
    if (r == kRingCentre && i == 0) cluxels.own_begin = static_cast<std::uint32_t>(cluxels.size());
    cluxels.name.push_back({static_cast<std::uint32_t>(r), i});
    const CluxelTile& tile = *ring[static_cast<std::size_t>(r)];
    cluxels.center.push_back(tile.own[i].mean + ringShift(r));
    cluxels.member.push_back(memberOf(tile, i, cluxels.center.back()));
    cluxels.reach.push_back(tile.reach[i]);
    cluxels.volume.push_back(volume);
    cluxels.near.push_back(intersects(volume, own_hull) ? 1 : 0);
  });
  cluxels.own_end = cluxels.own_begin + static_cast<std::uint32_t>(own.size());
  return cluxels;
}

RingGraph intersectionGraph(const RingCluxels& cluxels) {
  RingGraph graph;
  graph.offset.assign(cluxels.size() + 1, 0);
  if (cluxels.size() == 0) return graph;
  const auto pairs = intersectingPairs(cluxels, enterVolumes(cluxels));
  for (const auto& [a, b] : pairs) {
    graph.offset[a + 1] += cluxels.near[a];
    graph.offset[b + 1] += cluxels.near[b];
  }
  for (std::size_t c = 0; c < cluxels.size(); ++c) graph.offset[c + 1] += graph.offset[c];
  graph.target.resize(graph.offset.back());
  auto next = graph.offset;
  for (const auto& [a, b] : pairs) {
    if (cluxels.near[a]) graph.target[next[a]++] = b;
    if (cluxels.near[b]) graph.target[next[b]++] = a;
  }
  for (std::size_t c = 0; c < cluxels.size(); ++c)
    std::sort(graph.target.begin() + graph.offset[c], graph.target.begin() + graph.offset[c + 1]);
  return graph;
}

}  // namespace cluxel
