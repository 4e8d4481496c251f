// SPDX-License-Identifier: Apache-2.0
// A sorted array of cells, so that the order of visits depends on the cluxels only.
#include "rules/propose/cluxel_grid.hpp"

#include <algorithm>
#include <bit>
#include <compare>
#include <limits>
#include <numeric>
#include <utility>

#include "base/radix_order.hpp"

namespace cluxel::rules {

namespace {

std::vector<std::uint32_t> numbersTo(std::size_t count) {
  std::vector<std::uint32_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0U);
  return numbers;
}

/// Unsigned numbers in the order of heights.
std::uint32_t rankOf(float z) {
  const auto bits = std::bit_cast<std::uint32_t>(z + 0.0F);  // no negative zero
  return (bits >> 31U) != 0 ? ~bits : bits | 0x8000'0000U;
}

/// Cells of one x.
struct CellRow {
  std::int32_t x = 0, low_y = 0, high_y = 0;
  auto operator<=>(const CellRow&) const = default;
};

/// Joins rows that overlap or follow each other. The rows are ascending.
void joinRows(std::vector<CellRow>& rows) {
  std::size_t count = 0;
  for (const CellRow& row : rows) {
    if (count > 0 && rows[count - 1].x == row.x && row.low_y <= rows[count - 1].high_y + 1)
      rows[count - 1].high_y = std::max(rows[count - 1].high_y, row.high_y);
    else
      rows[count++] = row;
  }
  rows.resize(count);
}

/// The cells up to `reach` cells from some cells, each once.
std::vector<CellRow> rowsAround(std::vector<CellRow> cells, std::int32_t reach) {
  std::sort(cells.begin(), cells.end());
  for (CellRow& cell : cells) cell.low_y -= reach, cell.high_y += reach;
  joinRows(cells);
  std::vector<CellRow> rows;
  rows.reserve(cells.size() * static_cast<std::size_t>(2 * reach + 1));
  for (const CellRow& cell : cells)
    for (std::int32_t x = cell.x - reach; x <= cell.x + reach; ++x) rows.push_back({x, cell.low_y, cell.high_y});
  std::sort(rows.begin(), rows.end());
  joinRows(rows);
  return rows;
}

}  // namespace

CluxelGrid::CluxelGrid(const perception::SceneCluxels& all) : CluxelGrid(all, numbersTo(all.size())) {
  listPrimitives();
}

CluxelGrid::CluxelGrid(const perception::SceneCluxels& all, std::span<const std::uint32_t> some) : all_(all) {
  if (all.size() > 0) origin_z_ = all.center[all.size() / 2].z();
  float highest = 0;
  for (const std::uint32_t i : some) {
    const float z = heightOf(i);
    margin_m_ = std::max(margin_m_, static_cast<double>(all.extent[i].head<2>().maxCoeff()) / 2);
    tallest_half_m_ = std::max(tallest_half_m_, all.extent[i].z() / 2);
    highest = std::max(highest, std::abs(z));
  }
  rounding_m_ = 1e-4F + 8 * std::numeric_limits<float>::epsilon() * highest;
  entries_.reserve(some.size());
  for (const std::uint32_t cluxel : inCellOrder(some)) {
    const std::int32_t x = cellOf(all.center[cluxel].x()), y = cellOf(all.center[cluxel].y());
    if (columns_.empty() || columns_.back().first != x) columns_.emplace_back(x, cells_.size());
    if (cells_.empty() || cells_.back().x != x || cells_.back().y != y)
      cells_.push_back({x, y, static_cast<std::uint32_t>(entries_.size())});
    entries_.push_back({heightOf(cluxel), cluxel});
  }
  constexpr std::int32_t kBeyond = std::numeric_limits<std::int32_t>::max();
  columns_.emplace_back(kBeyond, cells_.size());
  cells_.push_back({kBeyond, kBeyond, static_cast<std::uint32_t>(entries_.size())});
}

/// By cell, then by height, then by number.
std::vector<std::uint32_t> CluxelGrid::inCellOrder(std::span<const std::uint32_t> some) const {
  std::vector<std::uint32_t> cluxels(some.begin(), some.end());
  sortNumbers(cluxels);
  std::vector<std::uint64_t> keys(cluxels.size());
  const auto sortBy = [&](const auto& key_of) {  // stable
    std::transform(cluxels.begin(), cluxels.end(), keys.begin(), key_of);
    std::vector<std::uint32_t> order = orderOf(keys);
    for (std::uint32_t& place : order) place = cluxels[place];
    cluxels = std::move(order);
  };
  sortBy([this](std::uint32_t i) -> std::uint64_t { return rankOf(heightOf(i)); });
  std::int64_t low_x = std::numeric_limits<std::int32_t>::max(), low_y = low_x;
  for (const std::uint32_t i : cluxels) {
    low_x = std::min<std::int64_t>(low_x, cellOf(all_.center[i].x()));
    low_y = std::min<std::int64_t>(low_y, cellOf(all_.center[i].y()));
  }
  sortBy([&](std::uint32_t i) {
    const auto x = static_cast<std::uint64_t>(cellOf(all_.center[i].x()) - low_x);
    return x << 32U | static_cast<std::uint64_t>(cellOf(all_.center[i].y()) - low_y);
  });
  return cluxels;
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
  std::vector<CellRow> occupied;
  for (const std::uint32_t cluxel : cluxels) {
    const CellRow cell{cellOf(all_.center[cluxel].x()), cellOf(all_.center[cluxel].y()),
                       cellOf(all_.center[cluxel].y())};
    if (occupied.empty() || occupied.back() != cell) occupied.push_back(cell);
  }
  const auto reach = static_cast<std::int32_t>(std::ceil((distance_m + 2 * margin_m_) / kCell_m));
  std::vector<perception::PrimitiveIndex> found;
  for (const CellRow& around : rowsAround(std::move(occupied), reach)) {
    const auto [cell, end] = row(around.x, around.low_y, around.high_y);
    found.insert(found.end(), primitives_.begin() + first_primitive_[cell],
                 primitives_.begin() + first_primitive_[end]);
  }
  sortNumbers(found);
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

}  // namespace cluxel::rules
