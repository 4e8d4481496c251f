// SPDX-License-Identifier: Apache-2.0
// A sorted array of cells, so that the order of visits depends on the cluxels only.
#include "rules/propose/cluxel_grid.hpp"

#include <algorithm>
#include <limits>
#include <tuple>

namespace cluxel::rules {

CluxelGrid::CluxelGrid(const perception::SceneCluxels& all) : all_(all) {
  std::vector<Cell> entries;
  entries.reserve(all.size());
  for (std::uint32_t i = 0; i < all.size(); ++i) {
    entries.push_back({cellOf(all.center[i].x()), cellOf(all.center[i].y()), i});
    margin_m_ = std::max(margin_m_, static_cast<double>(std::max(all.extent[i].x(), all.extent[i].y())) / 2);
  }
  std::sort(entries.begin(), entries.end(),
            [](const Cell& a, const Cell& b) { return std::tie(a.x, a.y, a.first) < std::tie(b.x, b.y, b.first); });
  cluxels_.reserve(entries.size());
  for (const Cell& entry : entries) {
    if (cells_.empty() || cells_.back().x != entry.x || cells_.back().y != entry.y)
      cells_.push_back({entry.x, entry.y, static_cast<std::uint32_t>(cluxels_.size())});
    cluxels_.push_back(entry.first);
  }
  constexpr std::int32_t kBeyond = std::numeric_limits<std::int32_t>::max();
  cells_.push_back({kBeyond, kBeyond, static_cast<std::uint32_t>(cluxels_.size())});
}

std::pair<std::uint32_t, std::uint32_t> CluxelGrid::row(std::int32_t x, std::int32_t low_y, std::int32_t high_y) const {
  auto cell = std::lower_bound(
      cells_.begin(), cells_.end() - 1, std::pair(x, low_y),
      [](const Cell& c, const auto& at) { return std::tie(c.x, c.y) < std::tie(at.first, at.second); });
  const std::uint32_t first = cell->first;
  while (cell->x == x && cell->y <= high_y) ++cell;
  return {first, cell->first};
}

std::vector<perception::PrimitiveIndex> CluxelGrid::primitivesNear(std::span<const std::uint32_t> cluxels,
                                                                   double distance_m) const {
  std::vector<perception::PrimitiveIndex> found;
  std::vector<std::pair<std::int32_t, std::int32_t>> done;
  // One look-up per occupied cell, with the cell itself as query box.
  for (std::uint32_t cluxel : cluxels)
    done.emplace_back(cellOf(all_.center[cluxel].x()), cellOf(all_.center[cluxel].y()));
  std::sort(done.begin(), done.end());
  done.erase(std::unique(done.begin(), done.end()), done.end());
  const auto reach = static_cast<std::int32_t>(std::ceil((distance_m + 2 * margin_m_) / kCell_m));
  for (const auto& [cx, cy] : done)
    for (std::int32_t x = cx - reach; x <= cx + reach; ++x) {
      const auto [first, last] = row(x, cy - reach, cy + reach);
      for (std::uint32_t i = first; i < last; ++i)
        if (found.empty() || found.back() != all_.primitive[cluxels_[i]]) found.push_back(all_.primitive[cluxels_[i]]);
    }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

}  // namespace cluxel::rules
