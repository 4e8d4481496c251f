// SPDX-License-Identifier: Apache-2.0
// A counting sort into cell stacks, then by height. A search visits nine stacks.
#include "scan/registration/nearest_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cluxel::scan {

NearestGrid::NearestGrid(const std::vector<Eigen::Vector3f>& points, double max_reach_m) : cell_m_(max_reach_m) {
  if (points.empty()) return;
  Eigen::Vector2d high = points.front().head<2>().cast<double>();
  low_ = high;
  for (const Eigen::Vector3f& p : points) {
    low_ = low_.cwiseMin(p.head<2>().cast<double>());
    high = high.cwiseMax(p.head<2>().cast<double>());
  }
  constexpr double kMaxColumns = 4e6;
  const auto columnsFor = [&] { return ((high - low_) / cell_m_).array().floor() + 1; };
  while (columnsFor().prod() > kMaxColumns) cell_m_ *= 2;
  columns_x_ = static_cast<std::int64_t>(columnsFor().x());
  columns_y_ = static_cast<std::int64_t>(columnsFor().y());
  const auto columnOf = [&](const Eigen::Vector3f& p) {
    const auto x = static_cast<std::int64_t>((static_cast<double>(p.x()) - low_.x()) / cell_m_);
    const auto y = static_cast<std::int64_t>((static_cast<double>(p.y()) - low_.y()) / cell_m_);
    return static_cast<std::size_t>(std::min(y, columns_y_ - 1) * columns_x_ + std::min(x, columns_x_ - 1));
  };
  first_.assign(static_cast<std::size_t>(columns_x_ * columns_y_) + 1, 0);
  for (const Eigen::Vector3f& p : points) ++first_[columnOf(p) + 1];
  for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
  entries_.resize(points.size());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::size_t i = 0; i < points.size(); ++i)
    entries_[next[columnOf(points[i])]++] = {points[i].z(), points[i].x(), points[i].y(),
                                             static_cast<std::uint32_t>(i)};
  for (std::size_t c = 0; c + 1 < first_.size(); ++c)
    std::stable_sort(entries_.begin() + first_[c], entries_.begin() + first_[c + 1],
                     [](const Entry& a, const Entry& b) { return a.z < b.z; });
}

std::optional<std::size_t> NearestGrid::nearest(const Eigen::Vector3d& p, double reach_m) const {
  if (entries_.empty()) return std::nullopt;
  const auto column = [&](double value, double low) {
    return static_cast<std::int64_t>(std::floor((value - low) / cell_m_));
  };
  const std::int64_t x = column(p.x(), low_.x()), y = column(p.y(), low_.y());
  const auto lowest_z = static_cast<float>(p.z() - reach_m), highest_z = static_cast<float>(p.z() + reach_m);
  double best_m2 = reach_m * reach_m;
  std::uint32_t best = std::numeric_limits<std::uint32_t>::max();
  for (std::int64_t cy = std::max<std::int64_t>(y - 1, 0); cy <= std::min(y + 1, columns_y_ - 1); ++cy) {
    for (std::int64_t cx = std::max<std::int64_t>(x - 1, 0); cx <= std::min(x + 1, columns_x_ - 1); ++cx) {
      const auto c = static_cast<std::size_t>(cy * columns_x_ + cx);
      const auto end = entries_.begin() + first_[c + 1];
      auto at = std::lower_bound(entries_.begin() + first_[c], end, lowest_z,
                                 [](const Entry& e, float z) { return e.z < z; });
      for (; at != end && at->z <= highest_z; ++at) {
        const double m2 = (Eigen::Vector3d(at->x, at->y, at->z) - p).squaredNorm();
        if (m2 < best_m2 || (m2 == best_m2 && at->index < best)) {
          best_m2 = m2;
          best = at->index;
        }
      }
    }
  }
  if (best == std::numeric_limits<std::uint32_t>::max()) return std::nullopt;
  return best;
}

}  // namespace cluxel::scan
