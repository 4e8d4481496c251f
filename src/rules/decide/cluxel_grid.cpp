// SPDX-License-Identifier: Apache-2.0
// A sorted array of cells instead of a hash table, so that the order of visits depends on the cluxels only.
#include "rules/decide/cluxel_grid.hpp"

#include <algorithm>
#include <cmath>

namespace cluxel::rules {

namespace {

constexpr double kCell_m = 1.0;

std::int32_t cellOf(double coordinate_m) {
  return static_cast<std::int32_t>(std::floor(coordinate_m / kCell_m));
}

}  // namespace

double CluxelGap::gap() const {
  return std::sqrt(horizontal * horizontal + vertical * vertical);
}

CluxelGap gapBetween(const perception::SceneCluxels& all, std::uint32_t a, std::uint32_t b) {
  const Eigen::Vector3d half = (all.extent[a] + all.extent[b]).cast<double>() / 2;
  const Eigen::Vector3d apart = ((all.center[a] - all.center[b]).cwiseAbs() - half).cwiseMax(0);
  return {std::sqrt(apart.x() * apart.x() + apart.y() * apart.y()), apart.z()};
}

CluxelGrid::CluxelGrid(const perception::SceneCluxels& all) : all_(all) {
  entries_.reserve(all.size());
  for (std::uint32_t i = 0; i < all.size(); ++i) {
    entries_.push_back({cellOf(all.center[i].x()), cellOf(all.center[i].y()), i});
    margin_m_ = std::max(margin_m_, static_cast<double>(std::max(all.extent[i].x(), all.extent[i].y())) / 2);
  }
  std::sort(entries_.begin(), entries_.end());
}

void CluxelGrid::near(std::uint32_t cluxel, double distance_m, const std::function<void(std::uint32_t)>& visit) const {
  const Eigen::Vector3d& centre = all_.center[cluxel];
  const double own = static_cast<double>(all_.extent[cluxel].head<2>().maxCoeff()) / 2;
  const double reach = distance_m + margin_m_ + own;
  const std::int32_t low_y = cellOf(centre.y() - reach), high_y = cellOf(centre.y() + reach);
  for (std::int32_t x = cellOf(centre.x() - reach); x <= cellOf(centre.x() + reach); ++x) {
    auto entry = std::lower_bound(entries_.begin(), entries_.end(), Entry{x, low_y, 0});
    for (; entry != entries_.end() && entry->x == x && entry->y <= high_y; ++entry) visit(entry->cluxel);
  }
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
      auto entry = std::lower_bound(entries_.begin(), entries_.end(), Entry{x, cy - reach, 0});
      for (; entry != entries_.end() && entry->x == x && entry->y <= cy + reach; ++entry)
        if (found.empty() || found.back() != all_.primitive[entry->cluxel])
          found.push_back(all_.primitive[entry->cluxel]);
    }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

}  // namespace cluxel::rules
