// SPDX-License-Identifier: Apache-2.0
// A sorted array of cells, so that the order of visits depends on the cluxels only.
#include "rules/propose/cluxel_grid.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>

namespace cluxel::rules {

namespace {

std::vector<std::uint32_t> numbersTo(std::size_t count) {
  std::vector<std::uint32_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0U);
  return numbers;
}

}  // namespace

CluxelGrid::CluxelGrid(const perception::SceneCluxels& all) : CluxelGrid(all, numbersTo(all.size())) {
  listPrimitives();
}

CluxelGrid::CluxelGrid(const perception::SceneCluxels& all, std::span<const std::uint32_t> some) : all_(all) {
  if (all.size() > 0) origin_z_ = all.center[all.size() / 2].z();
  struct Placed {
    std::int32_t x, y;
    Entry entry;
  };
  std::vector<Placed> placed;
  placed.reserve(some.size());
  float highest = 0;
  for (const std::uint32_t i : some) {
    placed.push_back({cellOf(all.center[i].x()), cellOf(all.center[i].y()), {heightOf(i), i}});
    margin_m_ = std::max(margin_m_, static_cast<double>(all.extent[i].head<2>().maxCoeff()) / 2);
    tallest_half_m_ = std::max(tallest_half_m_, all.extent[i].z() / 2);
    highest = std::max(highest, std::abs(placed.back().entry.z));
  }
  rounding_m_ = 1e-4F + 8 * std::numeric_limits<float>::epsilon() * highest;
  std::sort(placed.begin(), placed.end(), [](const Placed& a, const Placed& b) {
    return std::tuple(a.x, a.y, a.entry.z, a.entry.cluxel) < std::tuple(b.x, b.y, b.entry.z, b.entry.cluxel);
  });
  entries_.reserve(placed.size());
  for (const Placed& one : placed) {
    if (columns_.empty() || columns_.back().first != one.x) columns_.emplace_back(one.x, cells_.size());
    if (cells_.empty() || cells_.back().x != one.x || cells_.back().y != one.y)
      cells_.push_back({one.x, one.y, static_cast<std::uint32_t>(entries_.size())});
    entries_.push_back(one.entry);
  }
  constexpr std::int32_t kBeyond = std::numeric_limits<std::int32_t>::max();
  columns_.emplace_back(kBeyond, cells_.size());
  cells_.push_back({kBeyond, kBeyond, static_cast<std::uint32_t>(entries_.size())});
}

void CluxelGrid::listPrimitives() {
  for (std::size_t cell = 0; cell + 1 < cells_.size(); ++cell) {
    const auto first = static_cast<std::ptrdiff_t>(primitives_.size());
    first_primitive_.push_back(static_cast<std::uint32_t>(first));
    for (std::uint32_t i = cells_[cell].first; i < cells_[cell + 1].first; ++i)
      primitives_.push_back(all_.primitive[entries_[i].cluxel]);
    std::sort(primitives_.begin() + first, primitives_.end());
    primitives_.erase(std::unique(primitives_.begin() + first, primitives_.end()), primitives_.end());
  }
  first_primitive_.push_back(static_cast<std::uint32_t>(primitives_.size()));
}

std::pair<std::uint32_t, std::uint32_t> CluxelGrid::row(std::int32_t x, std::int32_t low_y, std::int32_t high_y) const {
  const auto column = std::lower_bound(columns_.begin(), columns_.end() - 1, std::pair(x, std::uint32_t{0}));
  if (column->first != x) return {0, 0};
  const auto begin = cells_.begin(), end = begin + std::next(column)->second;
  const auto first =
      std::lower_bound(begin + column->second, end, low_y, [](const Cell& cell, std::int32_t y) { return cell.y < y; });
  auto last = first;
  while (last != end && last->y <= high_y) ++last;
  return {static_cast<std::uint32_t>(first - begin), static_cast<std::uint32_t>(last - begin)};
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
      const auto [cell, end] = row(x, cy - reach, cy + reach);
      found.insert(found.end(), primitives_.begin() + first_primitive_[cell],
                   primitives_.begin() + first_primitive_[end]);
    }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

}  // namespace cluxel::rules
