// SPDX-License-Identifier: Apache-2.0
// A breadth-first search over primitives by the cells that their cluxels cover.
#include "rules/decide/local_layers.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <unordered_set>

namespace cluxel::rules {

namespace {

constexpr double kLayerCell_m = 2;

using Cell = std::uint64_t;

std::int32_t cellOf(double coordinate_m) {
  return static_cast<std::int32_t>(std::floor(coordinate_m / kLayerCell_m));
}
Cell keyOf(std::int32_t x, std::int32_t y) {
  return Cell{static_cast<std::uint32_t>(x)} << 32U | static_cast<std::uint32_t>(y);
}
std::int32_t xOf(Cell cell) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(cell >> 32U));
}
std::int32_t yOf(Cell cell) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(cell));
}

}  // namespace

class Layering {
 public:
  Layering(const perception::Scene& scene, const std::vector<char>& is_fixed, double reach_m)
      : scene_(scene), is_fixed_(is_fixed), cells_of_(scene.primitives.size()) {
    for (std::uint32_t cluxel = 0; cluxel < scene.cluxels.size(); ++cluxel) cover(cluxel);
    for (perception::PrimitiveIndex i = 0; i < cells_of_.size(); ++i) {
      std::vector<Cell>& cells = cells_of_[i];
      std::sort(cells.begin(), cells.end());
      cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
      for (const Cell cell : cells) here_[cell].push_back(i);
    }
    const auto far = static_cast<std::int32_t>(reach_m / kLayerCell_m) + 1;
    for (std::int32_t x = -far; x <= far; ++x)
      for (std::int32_t y = -far; y <= far; ++y) {
        const double gap_x = kLayerCell_m * std::max(0, std::abs(x) - 1),
                     gap_y = kLayerCell_m * std::max(0, std::abs(y) - 1);
        if (std::hypot(gap_x, gap_y) <= reach_m) disc_.emplace_back(x, y);
      }
  }

  std::vector<std::uint32_t> run(const std::vector<char>& is_dirty, std::span<const Eigen::AlignedBox2d> gone) {
    layers_.assign(scene_.primitives.size(), kNoLayer);
    reached_.clear();
    looked_around_.clear();
    for (perception::PrimitiveIndex i = 0; i < is_dirty.size(); ++i)
      if (is_dirty[i] != 0) begin(i);
    for (const Eigen::AlignedBox2d& box : gone)
      for (std::int32_t x = cellOf(box.min().x()); x <= cellOf(box.max().x()); ++x)
        for (std::int32_t y = cellOf(box.min().y()); y <= cellOf(box.max().y()); ++y) reachAround(keyOf(x, y), 0);
    // What a box of something gone reaches is not the same as what layer 0 reaches.
    looked_around_.clear();
    for (std::uint32_t layer = 1; layer <= kLastLayer && !reached_.empty(); ++layer)
      for (const perception::PrimitiveIndex from : std::exchange(reached_, {})) reachFrom(from, layer);
    return std::move(layers_);
  }

 private:
  void cover(std::uint32_t cluxel) {
    const Eigen::Vector2d low = scene_.cluxels.low_corner[cluxel].head<2>();
    const Eigen::Vector2d high = low + scene_.cluxels.extent[cluxel].head<2>().cast<double>();
    std::vector<Cell>& cells = cells_of_[scene_.cluxels.primitive[cluxel]];
    for (std::int32_t x = cellOf(low.x()); x <= cellOf(high.x()); ++x)
      for (std::int32_t y = cellOf(low.y()); y <= cellOf(high.y()); ++y)
        if (cells.empty() || cells.back() != keyOf(x, y)) cells.push_back(keyOf(x, y));
  }

  void begin(perception::PrimitiveIndex primitive) {
    layers_[primitive] = 0;
    reached_.push_back(primitive);
  }

  void reach(perception::PrimitiveIndex primitive, std::uint32_t layer) {
    if (layers_[primitive] != kNoLayer || is_fixed_[primitive] != 0) return;
    layers_[primitive] = layer;
    reached_.push_back(primitive);
  }

  void reachAround(Cell cell, std::uint32_t layer) {
    if (!looked_around_.insert(cell).second) return;
    for (const auto& [x, y] : disc_)
      if (const auto found = here_.find(keyOf(xOf(cell) + x, yOf(cell) + y)); found != here_.end())
        for (const perception::PrimitiveIndex primitive : found->second) reach(primitive, layer);
  }

  void reachFrom(perception::PrimitiveIndex from, std::uint32_t layer) {
    for (const Cell cell : cells_of_[from]) reachAround(cell, layer);
    for (const perception::Relation& relation : scene_.relationsOf(from)) reach(relation.to, layer);
    for (const std::uint32_t cluxel : scene_.primitives[from].cluxels)
      for (const std::uint32_t neighbour : scene_.cluxels.neighbours(cluxel))
        reach(scene_.cluxels.primitive[neighbour], layer);
  }

  const perception::Scene& scene_;
  const std::vector<char>& is_fixed_;
  std::vector<std::uint32_t> layers_;
  std::vector<std::vector<Cell>> cells_of_;                                 ///< by primitive
  std::unordered_map<Cell, std::vector<perception::PrimitiveIndex>> here_;  ///< the primitives of each cell
  std::vector<std::pair<std::int32_t, std::int32_t>> disc_;                 ///< cells within reach of a cell
  std::unordered_set<Cell> looked_around_;
  std::vector<perception::PrimitiveIndex> reached_;
};

LayerSearch::LayerSearch(const perception::Scene& scene, const std::vector<char>& is_fixed, double reach_m)
    : layering_(std::make_unique<Layering>(scene, is_fixed, reach_m)) {}
LayerSearch::~LayerSearch() = default;
LayerSearch::LayerSearch(LayerSearch&&) noexcept = default;

std::vector<std::uint32_t> LayerSearch::around(const std::vector<char>& is_dirty,
                                               std::span<const Eigen::AlignedBox2d> gone) {
  return layering_->run(is_dirty, gone);
}

std::vector<std::uint32_t> layersAround(const perception::Scene& scene, const std::vector<char>& is_dirty,
                                        const std::vector<char>& is_fixed, std::span<const Eigen::AlignedBox2d> gone,
                                        double reach_m) {
  return LayerSearch(scene, is_fixed, reach_m).around(is_dirty, gone);
}

}  // namespace cluxel::rules
