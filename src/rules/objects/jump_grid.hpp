// SPDX-License-Identifier: Apache-2.0
// A grid over the cluxels of a crown. It finds pairs across gaps that no edge of the cluxel graph bridges.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

namespace cluxel::rules {

inline constexpr double kJumpPenalty = 2.0;  ///< the length of a path over a gap, as a multiple of its own

/// Cluxels that a search has not settled yet, in columns ordered by height. Each cluxel has the length of the shortest
/// path to it that is known: most of those near by cannot be reached on a shorter one, and are left out by fours.
class JumpGrid {
 public:
  struct Entry {
    Eigen::Vector3d centre;
    float half_m = 0;  ///< half of the box's diagonal
  };
  /// From the end of a path of some length to what is around it.
  struct Jump {
    Eigen::Vector3d from;
    double reach_m = 0;  ///< to the near end of the other's half diagonal
    double length_m = 0;
  };

  /// The cluxels are numbered as the entries. `jump_m` is the largest gap that is looked for.
  JumpGrid(const std::vector<Entry>& entries, double jump_m) : places_(entries.size()) {
    if (!entries.empty()) origin_ = entries.front().centre;
    double farthest = 0;
    for (const Entry& entry : entries) {
      widest_half_m_ = std::max(widest_half_m_, static_cast<double>(entry.half_m));
      farthest = std::max(farthest, (entry.centre - origin_).cwiseAbs().maxCoeff());
    }
    cell_m_ = std::max(jump_m + 2 * widest_half_m_, 0.05);
    rounding_m_ = static_cast<float>(1e-4 + 8 * static_cast<double>(std::numeric_limits<float>::epsilon()) * farthest);
    std::vector<std::tuple<std::int64_t, std::int64_t, float, std::uint32_t>> order;
    order.reserve(entries.size());
    for (std::uint32_t at = 0; at < entries.size(); ++at) {
      const Eigen::Vector3d& centre = entries[at].centre;
      order.emplace_back(cellOf(centre.x()), cellOf(centre.y()), placeOf(centre).z(), at);
    }
    std::sort(order.begin(), order.end());
    for (std::vector<float>* numbers : {&x_, &y_, &z_, &half_m_}) numbers->resize(entries.size() + kTogether, 0);
    length_m_.resize(entries.size() + kTogether, kGone);
    at_.resize(entries.size() + kTogether);
    for (std::uint32_t i = 0; i < order.size(); ++i) {
      const auto& [x, y, z, at] = order[i];
      if (columns_.empty() || columns_.back().x != x || columns_.back().y != y) startColumn(x, y, i);
      columns_.back().end = i + 1;
      const Eigen::Vector3f place = placeOf(entries[at].centre);
      x_[i] = place.x(), y_[i] = place.y(), z_[i] = place.z(), half_m_[i] = entries[at].half_m, at_[i] = at;
      length_m_[i] = std::numeric_limits<float>::infinity();
      places_[at] = {static_cast<std::uint32_t>(columns_.size() - 1), i};
    }
    rows_.push_back(static_cast<std::uint32_t>(columns_.size()));
  }

  /// Calls `visit` for every cluxel with its centre in the box, and for some beside it.
  template <typename Visit>
  void within(const Eigen::Vector3d& low, const Eigen::Vector3d& high, const Visit& visit) const {
    forEachSlice(low, high, [&](std::uint32_t i, std::uint32_t end, float high_z) {
      for (; i < end && z_[i] <= high_z; ++i)
        if (length_m_[i] != kGone) visit(at_[i]);
    });
  }

  /// Calls `visit` for every cluxel that the jump reaches on a shorter path, and for some others.
  template <typename Visit>
  void nearer(const Jump& jump, const Visit& visit) const {
    const Eigen::Vector3f from = placeOf(jump.from);
    const float reach = static_cast<float>(jump.reach_m) + rounding_m_, length = roundedDown(jump.length_m);
    const double outer_m = jump.reach_m + widest_half_m_;
    forEachSlice(jump.from.array() - outer_m, jump.from.array() + outer_m,
                 [&](std::uint32_t i, std::uint32_t end, float high_z) {
                   for (; i < end && z_[i] <= high_z; i += kTogether) {
                     const Four shorter =
                         (four(length_m_, i) - length) / static_cast<float>(kJumpPenalty) + rounding_m_;
                     const Four limit = shorter.min(four(half_m_, i) + reach).max(0);
                     const Four inside = limit.square() - (four(x_, i) - from.x()).square() -
                                         (four(y_, i) - from.y()).square() - (four(z_, i) - from.z()).square();
                     if (inside.maxCoeff() > 0)
                       for (std::uint32_t k = 0; k < kTogether; ++k)
                         if (inside[k] > 0) visit(at_[i + k]);
                   }
                 });
  }

  /// Half of the largest diagonal [m].
  double widestHalf_m() const { return widest_half_m_; }

  /// A path of this length leads to the cluxel.
  void reach(std::uint32_t at, double length_m) {
    if (places_[at].entry != kNowhere) length_m_[places_[at].entry] = roundedUp(length_m);
  }
  void remove(std::uint32_t at) {
    const std::uint32_t entry = std::exchange(places_[at].entry, kNowhere);
    if (entry == kNowhere) return;
    length_m_[entry] = kGone;
    Column& column = columns_[places_[at].column];
    if (2 * ++column.gone > column.end - column.begin) tidy(column);
  }

 private:
  struct Column {
    std::int64_t x = 0, y = 0;
    std::uint32_t begin = 0, end = 0;  ///< of its entries
    std::uint32_t gone = 0;            ///< of these, those that were removed
  };
  struct Place {
    std::uint32_t column = 0, entry = 0;
  };
  static constexpr std::uint32_t kTogether = 4;
  using Four = Eigen::Array<float, kTogether, 1>;
  static constexpr std::uint32_t kNowhere = static_cast<std::uint32_t>(-1);
  static constexpr float kGone = -std::numeric_limits<float>::infinity();

  static Eigen::Map<const Four> four(const std::vector<float>& numbers, std::uint32_t first) {
    return Eigen::Map<const Four>(numbers.data() + first);
  }
  static float roundedDown(double length_m) { return static_cast<float>(length_m * (1 - 1e-6)); }
  static float roundedUp(double length_m) { return static_cast<float>(length_m * (1 + 1e-6)); }
  Eigen::Vector3f placeOf(const Eigen::Vector3d& place) const { return (place - origin_).cast<float>(); }
  std::int64_t cellOf(double coordinate_m) const {
    return static_cast<std::int64_t>(std::floor(coordinate_m / cell_m_));
  }
  void startColumn(std::int64_t x, std::int64_t y, std::uint32_t next) {
    if (columns_.empty()) first_x_ = x;
    while (rows_.size() <= static_cast<std::size_t>(x - first_x_))
      rows_.push_back(static_cast<std::uint32_t>(columns_.size()));
    columns_.push_back({x, y, next, next});
  }

  /// Calls `look(first, end, high_z)` with the entries of each column that the box meets; the first is no lower than
  /// the box.
  template <typename Look>
  void forEachSlice(const Eigen::Vector3d& low, const Eigen::Vector3d& high, const Look& look) const {
    const float low_z = placeOf(low).z() - rounding_m_, high_z = placeOf(high).z() + rounding_m_;
    const std::int64_t last_x = cellOf(high.x()), first_y = cellOf(low.y()), last_y = cellOf(high.y());
    for (std::int64_t x = cellOf(low.x()); x <= last_x; ++x)
      for (auto [column, end] = columnsFrom(x, first_y); column != end && column->y <= last_y; ++column) {
        const auto begin = z_.begin();
        const auto first = std::lower_bound(begin + column->begin, begin + column->end, low_z);
        look(static_cast<std::uint32_t>(first - begin), column->end, high_z);
      }
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

  /// Drops the removed entries of a column.
  void tidy(Column& column) {
    std::uint32_t next = column.begin;
    for (std::uint32_t i = column.begin; i < column.end; ++i) {
      if (length_m_[i] == kGone) continue;
      for (std::vector<float>* numbers : {&x_, &y_, &z_, &half_m_, &length_m_}) (*numbers)[next] = (*numbers)[i];
      at_[next] = at_[i];
      places_[at_[next]].entry = next;
      ++next;
    }
    std::fill(length_m_.begin() + next, length_m_.begin() + column.end, kGone);
    column.end = next, column.gone = 0;
  }

  double widest_half_m_ = 0, cell_m_ = 0;
  float rounding_m_ = 0;  ///< bound of the error of places
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  std::int64_t first_x_ = 0;
  std::vector<std::uint32_t> rows_;       ///< the first column of each x from first_x_ on; then their number
  std::vector<Column> columns_;           ///< ordered by x, then y
  std::vector<float> x_, y_, z_;          ///< of each entry, relative to origin_; some entries more than there are
  std::vector<float> half_m_, length_m_;  ///< kGone: removed
  std::vector<std::uint32_t> at_;
  std::vector<Place> places_;  ///< of each cluxel
};

}  // namespace cluxel::rules
