// SPDX-License-Identifier: Apache-2.0
// Union-find over the edges within a tile, then one pass over the points for the summaries.
#include "perception/segments/component_tile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "base/convex_hull.hpp"
#include "base/disjoint_sets.hpp"
#include "perception/clustering/fast_floor.hpp"
#include "perception/clustering/local_steps.hpp"
#include "perception/simd_vector.hpp"

namespace cluxel::perception {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Component number per cluxel, numbered in the order of first cluxels.
std::vector<std::uint32_t> connect(const CluxelTile& cluxels, const FeatureTile& graph, const LabelTile& labels,
                                   const ComponentParams& params) {
  DisjointSets sets(cluxels.size());
  const auto largest_gap = static_cast<float>(params.max_gap_m);
  for (std::uint32_t a = 0; a < cluxels.size(); ++a)
    for (std::uint32_t e = graph.edge_offset[a]; e < graph.edge_offset[a + 1]; ++e) {
      const RingIndex target = graph.edge_target[e];
      const std::uint32_t b = target.index;
      if (target.ring != kRingCentre || b < a || labels.label[a] != labels.label[b]) continue;
      if (sets.find(a) == sets.find(b))
        continue;  // most edges are between cluxels already joined, for which no gap need be computed
      if (gapBetween(cluxels.box_min[a], cluxels.box_max[a], cluxels.box_min[b], cluxels.box_max[b]) <= largest_gap)
        sets.join(a, b);
    }
  return sets.numbers();
}

/// Points sorted by component, in canonical order within a component.
struct PointGroups {
  std::vector<std::uint32_t> offset, point;
};

PointGroups groupPoints(const CluxelTile& cluxels, const std::vector<std::uint32_t>& component_of, std::size_t count) {
  PointGroups groups;
  groups.offset.assign(count + 1, 0);
  groups.point.resize(cluxels.point_cluxel.size());
  for (const std::uint32_t cluxel : cluxels.point_cluxel) ++groups.offset[component_of[cluxel] + 1];
  std::partial_sum(groups.offset.begin(), groups.offset.end(), groups.offset.begin());
  std::vector<std::uint32_t> next(groups.offset.begin(), groups.offset.end() - 1);
  for (std::uint32_t point = 0; point < groups.point.size(); ++point)
    groups.point[next[component_of[cluxels.point_cluxel[point]]]++] = point;
  return groups;
}

/// Height of every point above the local ground [m].
std::vector<float> heightsAboveGround(const TilePoints& points, const Ring<GroundTile>& ground) {
  std::vector<float> heights(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    heights[i] = static_cast<float>(points.z[i] - groundHeightAt(ground, points.x[i], points.y[i]));
  return heights;
}

void addMoments(Component& component, const TilePoints& points, std::span<const std::uint32_t> members) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const std::uint32_t i : members) mean += points.at(i).cast<double>();
  mean /= static_cast<double>(members.size());
  std::array<double, 6>& s = component.scatter;
  for (const std::uint32_t i : members) {
    const Eigen::Vector3d d = points.at(i).cast<double>() - mean;
    s[0] += d.x() * d.x(), s[1] += d.x() * d.y(), s[2] += d.x() * d.z();
    s[3] += d.y() * d.y(), s[4] += d.y() * d.z(), s[5] += d.z() * d.z();
  }
  for (int axis = 0; axis < 3; ++axis) component.mean[static_cast<std::size_t>(axis)] = mean[axis];
}

std::uint16_t footprintCell(float local) {
  const auto cell = static_cast<int>(fastFloor(static_cast<double>(local / static_cast<float>(kFootprintCell_m))));
  return static_cast<std::uint16_t>(std::clamp(cell, 0, kFootprintCellsPerTile - 1));
}

void widen(std::array<float, 3>& low, std::array<float, 3>& high, const Eigen::Vector3f& point) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis] = std::min(low[axis], point[static_cast<int>(axis)]);
    high[axis] = std::max(high[axis], point[static_cast<int>(axis)]);
  }
}

/// The footprint cells of one component, row by row. `slot` is a buffer, all kNoSlot between calls.
class CellCollector {
 public:
  CellCollector() : slot_(static_cast<std::size_t>(kFootprintCellsPerTile * kFootprintCellsPerTile), kNoSlot) {}

  void append(const TilePoints& points, std::span<const std::uint32_t> members, const std::vector<float>& heights,
              std::vector<FootprintCell>& cells) {
    const std::size_t first = cells.size();
    sum_z_.clear();
    for (const std::uint32_t i : members) {
      const std::size_t cell = add(points.at(i), heights[i], cells);
      sum_z_.resize(cells.size() - first, 0);
      sum_z_[cell - first] += points.z[i];
    }
    for (std::size_t c = first; c < cells.size(); ++c) {
      slot_[index(cells[c])] = kNoSlot;
      cells[c].mean_z = toHeightStep(sum_z_[c - first] / cells[c].count);
    }
    std::sort(cells.begin() + static_cast<std::ptrdiff_t>(first), cells.end(),
              [](const FootprintCell& a, const FootprintCell& b) { return index(a) < index(b); });
  }

 private:
  static constexpr std::uint32_t kNoSlot = 0xffffffffU;
  static std::size_t index(const FootprintCell& cell) {
    return static_cast<std::size_t>(cell.y) * kFootprintCellsPerTile + cell.x;
  }

  /// The place of the point's cell.
  std::size_t add(const Eigen::Vector3f& point, float height, std::vector<FootprintCell>& cells) {
    FootprintCell fresh;
    fresh.x = footprintCell(point.x());
    fresh.y = footprintCell(point.y());
    std::uint32_t& slot = slot_[index(fresh)];
    if (slot == kNoSlot) {
      slot = static_cast<std::uint32_t>(cells.size());
      fresh.min.fill(kInfinity), fresh.max.fill(-kInfinity);
      fresh.lowest = kInfinity, fresh.highest = -kInfinity;
      cells.push_back(fresh);
    }
    FootprintCell& cell = cells[slot];
    ++cell.count;
    widen(cell.min, cell.max, point);
    cell.lowest = std::min(cell.lowest, height);
    cell.highest = std::max(cell.highest, height);
    return slot;
  }

  std::vector<std::uint32_t> slot_;
  std::vector<double> sum_z_;  ///< of the points of each cell [m]
};

/// 16 directions over the full circle, four per SIMD vector.
struct Directions {
  std::array<Floats, 4> x, y;
  Directions() {
    for (std::size_t k = 0; k < 4 * kLanes; ++k) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(k) / (4 * kLanes);
      x[k / kLanes][k % kLanes] = static_cast<float>(std::cos(angle));
      y[k / kLanes][k % kLanes] = static_cast<float>(std::sin(angle));
    }
  }
};

/// The convex polygon of the extreme points in 16 directions.
std::vector<Eigen::Vector2d> outmostPolygon(const TilePoints& points, std::span<const std::uint32_t> members) {
  static const Directions along;
  std::array<Floats, 4> best;
  best.fill(Floats{} - kInfinity);
  std::array<Numbers, 4> outmost{};
  for (const std::uint32_t i : members)
    for (std::size_t v = 0; v < best.size(); ++v) {
      const Floats reach = points.x[i] * along.x[v] + points.y[i] * along.y[v];
      const Numbers is_farther = reach > best[v];
      best[v] = is_farther ? reach : best[v];
      outmost[v] = is_farther ? Numbers{} + static_cast<std::int32_t>(i) : outmost[v];
    }
  std::vector<Eigen::Vector2d> polygon;
  for (std::size_t k = 0; k < 4 * kLanes; ++k) {
    const auto i = static_cast<std::size_t>(outmost[k / kLanes][k % kLanes]);
    polygon.emplace_back(points.x[i], points.y[i]);
  }
  return convexHull(std::move(polygon));
}

/// Tests whether a position is strictly inside a convex polygon, against all sides at once.
class InnerTest {
 public:
  explicit InnerTest(const std::vector<Eigen::Vector2d>& polygon) {
    constexpr double kAway_m = 1e-4;                             // larger than the rounding error of a side in float
    for (auto& offset : offset_) offset = Floats{} - kInfinity;  // fewer than three corners: nothing is inside
    if (polygon.size() < 3) return;
    for (std::size_t k = 0; k < 4 * kLanes; ++k) {  // padding repeats sides
      const Eigen::Vector2d& corner = polygon[k % polygon.size()];
      const Eigen::Vector2d side = polygon[(k + 1) % polygon.size()] - corner;
      const Eigen::Vector2d inward = Eigen::Vector2d(-side.y(), side.x()).normalized();
      x_[k / kLanes][k % kLanes] = static_cast<float>(inward.x());
      y_[k / kLanes][k % kLanes] = static_cast<float>(inward.y());
      offset_[k / kLanes][k % kLanes] = static_cast<float>(-inward.dot(corner) - kAway_m);
    }
  }
  bool holds(float x, float y) const {
    Numbers held = x * x_[0] + y * y_[0] + offset_[0] > 0;
    for (std::size_t v = 1; v < x_.size(); ++v) held &= x * x_[v] + y * y_[v] + offset_[v] > 0;
    return allHold(held);
  }

 private:
  std::array<Floats, 4> x_{}, y_{}, offset_{};
};

/// The hull of the component's points. Points strictly inside the polygon of extreme points cannot be on the hull:
/// excluding them avoids sorting nearly all points.
std::vector<Eigen::Vector2d> hullOf(const TilePoints& points, std::span<const std::uint32_t> members) {
  constexpr std::size_t kFew = 24;
  std::vector<Eigen::Vector2d> candidates;
  if (members.size() > kFew) candidates = outmostPolygon(points, members);
  const InnerTest inner(candidates);
  for (const std::uint32_t i : members)
    if (!inner.holds(points.x[i], points.y[i])) candidates.emplace_back(points.x[i], points.y[i]);
  return convexHull(std::move(candidates));
}

void addExtremes(Component& component, const TilePoints& points, std::span<const std::uint32_t> members,
                 const std::vector<float>& heights) {
  component.min.fill(kInfinity), component.max.fill(-kInfinity);
  component.lowest = kInfinity, component.highest = -kInfinity;
  for (const std::uint32_t i : members) {
    widen(component.min, component.max, points.at(i));
    component.lowest = std::min(component.lowest, heights[i]);
    component.highest = std::max(component.highest, heights[i]);
    if (!points.intensity.empty()) component.intensity += points.intensity[i];
  }
}

void appendScans(ComponentTile& tile, const TilePoints& points, std::span<const std::uint32_t> members,
                 std::vector<bool>& seen) {
  for (const std::uint32_t i : members) seen[points.scan[i]] = true;
  for (std::size_t scan = 0; scan < points.scans.size(); ++scan)
    if (seen[scan]) tile.scans.push_back(points.scans[scan]), seen[scan] = false;
  tile.scan_offset.push_back(static_cast<std::uint32_t>(tile.scans.size()));
}

void addCluxels(ComponentTile& tile, const CluxelTile& cluxels, const LabelTile& labels) {
  for (std::uint32_t c = 0; c < cluxels.size(); ++c) {
    Component& component = tile.components[tile.component_of[c]];
    component.label = labels.label[c];
    if (component.cluxels++ == 0) component.first_cluxel = c;
    for (std::size_t k = 0; k < scan::kPrimitiveLabelCount; ++k)
      component.probability[k] += static_cast<double>(cluxels.own[c].count) * labels.probability[c][k];
  }
}

}  // namespace

void describe(ComponentParams& params, ParameterVisitor& visitor) {
  visitor.real({"component.largest_gap", "m", 0, 10, "cluxels of one label join when their points are this near"},
               params.max_gap_m);
}

ComponentTile componentsOf(const TilePoints& points, const CluxelTile& cluxels, const FeatureTile& graph,
                           const LabelTile& labels, const Ring<GroundTile>& ground, const ComponentParams& params) {
  ComponentTile tile;
  tile.key = cluxels.key;
  tile.component_of = connect(cluxels, graph, labels, params);
  const auto last = std::max_element(tile.component_of.begin(), tile.component_of.end());
  tile.components.resize(last == tile.component_of.end() ? 0 : *last + 1);
  tile.cell_offset = tile.hull_offset = tile.scan_offset = {0};
  addCluxels(tile, cluxels, labels);
  const PointGroups groups = groupPoints(cluxels, tile.component_of, tile.size());
  const std::vector<float> heights = heightsAboveGround(points, ground);
  CellCollector cells;
  std::vector<bool> seen(points.scans.size(), false);
  for (std::size_t c = 0; c < tile.size(); ++c) {
    const std::span<const std::uint32_t> members{groups.point.data() + groups.offset[c],
                                                 groups.point.data() + groups.offset[c + 1]};
    Component& component = tile.components[c];
    component.points = static_cast<std::uint32_t>(members.size());
    addMoments(component, points, members);
    addExtremes(component, points, members, heights);
    cells.append(points, members, heights, tile.cells);
    tile.cell_offset.push_back(static_cast<std::uint32_t>(tile.cells.size()));
    for (const Eigen::Vector2d& corner : hullOf(points, members)) tile.hull.push_back(corner.cast<float>());
    tile.hull_offset.push_back(static_cast<std::uint32_t>(tile.hull.size()));
    appendScans(tile, points, members, seen);
  }
  return tile;
}

}  // namespace cluxel::perception
