// SPDX-License-Identifier: Apache-2.0
// Every volume is listed in all grid cells that it touches. A pair is counted only in the cell that holds the low
// corner of its intersection.
#include "perception/features/cluxel_graph.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>

#include "base/radix_order.hpp"
#include "perception/simd_vector.hpp"

namespace cluxel::perception {
namespace {

Volume emptyVolume() {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  return {Eigen::Vector3f::Constant(kInfinity), Eigen::Vector3f::Constant(-kInfinity)};
}

void extend(Volume& hull, const Volume& volume) {
  hull.low = hull.low.cwiseMin(volume.low);
  hull.high = hull.high.cwiseMax(volume.high);
}

/// Calls `visit(ring place, number, volume)` for every own cluxel, and for those of the ring whose volume intersects
/// `hull`.
template <typename Visit>
void forEachTouching(const Ring<CluxelTile>& ring, const Volume& hull, const Visit& visit) {
  for (int r = 0; r < 9; ++r) {
    const CluxelTile* tile = ring[static_cast<std::size_t>(r)];
    if (tile == nullptr || !tile->hasVolumes()) continue;
    const Eigen::Vector3f shift = ringShift(r);
    for (std::uint32_t i = 0; i < tile->size(); ++i) {
      const Volume volume{tile->volume_min[i] + shift, tile->volume_max[i] + shift};
      if (r == kRingCentre || intersects(volume, hull)) visit(r, i, volume);
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
    float largest = 0;
    double sum = 0;
    for (const auto& volume : cluxels.volume) {
      if (volume.isEmpty()) continue;
      extend(hull, volume);
      const float size = (volume.high - volume.low).maxCoeff();
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
  static Cell cellOf(std::uint64_t key) {
    constexpr std::uint64_t kPart = (std::uint64_t{1} << 20U) - 1;
    return {static_cast<std::int32_t>(key >> 40U), static_cast<std::int32_t>(key >> 20U & kPart),
            static_cast<std::int32_t>(key & kPart)};
  }

 private:
  Eigen::Vector3f origin_;
  float per_m_ = 1;
};

struct Entries {
  std::vector<KeyedItem> entry;  ///< (cell, cluxel), sorted
  std::vector<Cell> first_cell;  ///< per cluxel: the cell of its volume's low corner
};

Entries enterVolumes(const RingCluxels& cluxels) {
  const VolumeCells cells(cluxels);
  Entries entries;
  entries.entry.reserve(6 * cluxels.size());
  entries.first_cell.resize(cluxels.size());
  for (std::uint32_t c = 0; c < cluxels.size(); ++c) {
    if (cluxels.volume[c].isEmpty()) continue;
    const Cell low = cells.cellOf(cluxels.volume[c].low), high = cells.cellOf(cluxels.volume[c].high);
    entries.first_cell[c] = low;
    for (std::int32_t x = low[0]; x <= high[0]; ++x)
      for (std::int32_t y = low[1]; y <= high[1]; ++y)
        for (std::int32_t z = low[2]; z <= high[2]; ++z) entries.entry.push_back({VolumeCells::keyOf({x, y, z}), c});
  }
  sortByKey(entries.entry);
  return entries;
}

struct Pair {
  std::uint32_t a, b;
};

/// A growing list of pairs with spare capacity, for branchless appends.
struct PairBuffer {
  std::vector<Pair> pair;
  std::size_t count = 0;
  void makeRoom(std::size_t more) {
    if (pair.size() < count + more) pair.resize(2 * (count + more));
  }
  std::span<const Pair> all() const { return {pair.data(), count}; }
};

/// The volumes listed in one cell, four per SIMD vector, with flags: bits 0 to 2 say that a volume begins in this cell
/// along x, y, z; bit 3 that its cluxel is near. Along each axis, the intersection of two volumes begins where one of
/// them begins; so a pair is counted in this cell when the union of its flags is complete.
class CellVolumes {
 public:
  void fill(const RingCluxels& cluxels, const std::vector<Cell>& first_cell, std::span<const KeyedItem> entries) {
    size_ = entries.size();
    const std::size_t whole = (size_ + kLanes - 1) / kLanes * kLanes;
    if (item_.size() < whole) resize(2 * whole);
    const Cell here = VolumeCells::cellOf(entries.front().key);
    for (std::size_t i = 0; i < size_; ++i) {
      const std::uint32_t c = item_[i] = entries[i].item;
      std::int32_t mark = cluxels.near[c] ? 8 : 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low_[axis][i] = cluxels.volume[c].low[static_cast<int>(axis)];
        high_[axis][i] = cluxels.volume[c].high[static_cast<int>(axis)];
        mark |= first_cell[c][axis] == here[axis] ? 1 << axis : 0;
      }
      mark_[i] = mark;
    }
    for (std::size_t i = size_; i < whole; ++i)
      low_[0][i] = std::numeric_limits<float>::infinity();  // padding: intersects nothing
  }

  void appendPairs(PairBuffer& pairs) const {
    for (std::size_t i = 0; i + 1 < size_; ++i) {
      pairs.makeRoom(size_ - i + kLanes);
      for (std::size_t j = (i + 1) / kLanes * kLanes; j < size_; j += kLanes) {
        const unsigned later = j > i ? 0xfU : 0xfU << (i + 1 - j) & 0xfU;
        const unsigned meets = lanesThatHold(meetFour(i, j)) & later;
        for (unsigned lane = 0; lane < kLanes; ++lane) {  // branchless append
          pairs.pair[pairs.count] = {item_[i], item_[j + lane]};
          pairs.count += meets >> lane & 1U;
        }
      }
    }
  }

 private:
  Numbers meetFour(std::size_t i, std::size_t j) const {
    constexpr std::int32_t kAllMarks = 15;
    Numbers marks;
    std::memcpy(&marks, mark_.data() + j, sizeof marks);
    Numbers holds = (marks | mark_[i]) == kAllMarks;
    for (std::size_t axis = 0; axis < 3; ++axis)
      holds &=
          (loadFloats(low_[axis].data() + j) <= high_[axis][i]) & (loadFloats(high_[axis].data() + j) >= low_[axis][i]);
    return holds;
  }
  void resize(std::size_t size) {
    item_.resize(size);
    mark_.resize(size);
    for (auto* values : {&low_, &high_})
      for (auto& along : *values) along.resize(size);
  }

  std::size_t size_ = 0;
  std::vector<std::uint32_t> item_;
  std::vector<std::int32_t> mark_;
  std::array<std::vector<float>, 3> low_, high_;
};

PairBuffer intersectingPairs(const RingCluxels& cluxels, const Entries& entries) {
  PairBuffer pairs;
  pairs.makeRoom(5 * cluxels.size());
  CellVolumes cell;
  const auto& entry = entries.entry;
  for (std::size_t begin = 0, end = 0; begin < entry.size(); begin = end) {
    for (end = begin + 1; end < entry.size() && entry[end].key == entry[begin].key;) ++end;
    if (end == begin + 1) continue;
    cell.fill(cluxels, entries.first_cell, {entry.data() + begin, end - begin});
    cell.appendPairs(pairs);
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

namespace {

/// Both directions of all pairs in CSR form: `offset` and `target` (unsorted).
RingGraph bothWays(std::span<const Pair> pairs, std::size_t cluxels) {
  RingGraph graph;
  graph.offset.assign(cluxels + 1, 0);
  for (const auto& [a, b] : pairs) {
    ++graph.offset[a + 1];
    ++graph.offset[b + 1];
  }
  for (std::size_t c = 0; c < cluxels; ++c) graph.offset[c + 1] += graph.offset[c];
  graph.target.resize(graph.offset.back());
  auto next = graph.offset;
  for (const auto& [a, b] : pairs) {
    graph.target[next[a]++] = b;
    graph.target[next[b]++] = a;
  }
  return graph;
}

}  // namespace

RingGraph intersectionGraph(const RingCluxels& cluxels) {
  const auto size = static_cast<std::uint32_t>(cluxels.size());
  if (size == 0) return {{0}, {}};
  const RingGraph any_order = bothWays(intersectingPairs(cluxels, enterVolumes(cluxels)).all(), size);
  RingGraph graph;
  graph.offset.assign(size + 1, 0);
  for (std::uint32_t c = 0; c < size; ++c)
    graph.offset[c + 1] =
        graph.offset[c] + (cluxels.near[c] ? static_cast<std::uint32_t>(any_order.neighbours(c).size()) : 0);
  graph.target.resize(graph.offset.back());
  auto next = graph.offset;
  for (std::uint32_t target = 0; target < size; ++target)  // ascending, so the targets of each cluxel are sorted
    for (const std::uint32_t c : any_order.neighbours(target))
      if (cluxels.near[c]) graph.target[next[c]++] = target;
  return graph;
}

}  // namespace cluxel::perception
