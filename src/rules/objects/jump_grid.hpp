// SPDX-License-Identifier: Apache-2.0
// A grid over the cluxels of a crown. It finds pairs across gaps that no edge of the cluxel graph bridges.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

namespace cluxel::rules {

/// Cluxels that a search has not settled yet, in columns ordered by height.
class JumpGrid {
 public:
  struct Entry {
    Eigen::Vector3d centre;
    double half_m = 0;     ///< half of the box's diagonal
    std::uint32_t at = 0;  ///< the cluxel's number in the search
  };

  /// `jump_m` is the largest gap that is looked for.
  JumpGrid(std::vector<Entry> entries, double jump_m) {
    for (const Entry& entry : entries) widest_half_m_ = std::max(widest_half_m_, entry.half_m);
    cell_m_ = std::max(jump_m / 2 + widest_half_m_, 0.05);
    std::vector<std::tuple<std::int64_t, std::int64_t, double, std::uint32_t>> order;
    order.reserve(entries.size());
    for (std::uint32_t i = 0; i < entries.size(); ++i) {
      const Eigen::Vector3d& centre = entries[i].centre;
      order.emplace_back(cellOf(centre.x()), cellOf(centre.y()), centre.z(), i);
    }
    std::sort(order.begin(), order.end());
    entries_.reserve(order.size());
    for (const auto& [x, y, z, i] : order) {
      const auto next = static_cast<std::uint32_t>(entries_.size());
      if (columns_.empty() || columns_.back().x != x || columns_.back().y != y) startColumn(x, y, next);
      columns_.back().end = next + 1;
      entries_.push_back(entries[i]);
    }
    rows_.push_back(static_cast<std::uint32_t>(columns_.size()));
  }

  /// Calls `visit` for every cluxel with its centre in the box, and for some beside it.
  template <typename Visit>
  void within(const Eigen::Vector3d& low, const Eigen::Vector3d& high, const Visit& visit) const {
    const std::int64_t last_x = cellOf(high.x()), first_y = cellOf(low.y()), last_y = cellOf(high.y());
    for (std::int64_t x = cellOf(low.x()); x <= last_x; ++x)
      for (auto [column, end] = columnsFrom(x, first_y); column != end && column->y <= last_y; ++column)
        for (auto entry = firstAbove(*column, low.z());
             entry != entries_.begin() + column->end && entry->centre.z() <= high.z(); ++entry)
          visit(*entry);
  }
  /// Half of the largest diagonal [m].
  double widestHalf_m() const { return widest_half_m_; }

  void remove(const Eigen::Vector3d& centre, std::uint32_t at) {
    const std::int64_t x = cellOf(centre.x()), y = cellOf(centre.y());
    Column& column = columns_[static_cast<std::size_t>(columnsFrom(x, y).first - columns_.cbegin())];
    const auto first = entries_.begin() + (firstAbove(column, centre.z()) - entries_.cbegin());
    const auto end = entries_.begin() + column.end;
    const auto entry = std::find_if(first, end, [at](const Entry& known) { return known.at == at; });
    if (entry == end) return;
    std::move(entry + 1, end, entry);
    --column.end;
  }

 private:
  struct Column {
    std::int64_t x = 0, y = 0;
    std::uint32_t begin = 0, end = 0;  ///< in entries_
  };

  std::int64_t cellOf(double coordinate_m) const {
    return static_cast<std::int64_t>(std::floor(coordinate_m / cell_m_));
  }
  void startColumn(std::int64_t x, std::int64_t y, std::uint32_t next) {
    if (columns_.empty()) first_x_ = x;
    while (rows_.size() <= static_cast<std::size_t>(x - first_x_))
      rows_.push_back(static_cast<std::uint32_t>(columns_.size()));
    columns_.push_back({x, y, next, next});
  }
  using Columns = std::vector<Column>::const_iterator;
  /// The columns of row `x` from `y` on, and the end of the row.
  std::pair<Columns, Columns> columnsFrom(std::int64_t x, std::int64_t y) const {
    if (x < first_x_ || x - first_x_ + 1 >= static_cast<std::int64_t>(rows_.size()))
      return {columns_.end(), columns_.end()};
    const auto row = static_cast<std::size_t>(x - first_x_);
    const Columns begin = columns_.begin() + rows_[row], end = columns_.begin() + rows_[row + 1];
    return {std::lower_bound(begin, end, y, [](const Column& column, std::int64_t low) { return column.y < low; }),
            end};
  }
  std::vector<Entry>::const_iterator firstAbove(const Column& column, double z) const {
    return std::lower_bound(entries_.begin() + column.begin, entries_.begin() + column.end, z,
                            [](const Entry& entry, double low) { return entry.centre.z() < low; });
  }

  double widest_half_m_ = 0, cell_m_ = 0;
  std::int64_t first_x_ = 0;
  std::vector<std::uint32_t> rows_;  ///< the first column of each x from first_x_ on; then their number
  std::vector<Column> columns_;      ///< ordered by x, then y
  std::vector<Entry> entries_;
};

}  // namespace cluxel::rules
