// SPDX-License-Identifier: Apache-2.0
// Looks up the sources around each cluxel in a coarse grid, and joins those that meet at a cluxel.
#include "rules/objects/crown_groups.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "base/disjoint_sets.hpp"

namespace cluxel::rules {

namespace {

constexpr double kSlack_m = 1e-6;  // of rounded cells

/// The sources near a place: those of which the disc around the top meets its cell.
class SourceCells {
 public:
  explicit SourceCells(const CrownParts& parts) : parts_(parts) {
    for (const CrownSource& source : parts.sources) cell_m_ = std::max(cell_m_, source.reach_m);
    for (std::uint32_t s = 0; s < parts.sources.size(); ++s) {
      const double reach = parts.sources[s].reach_m + kSlack_m;
      const Eigen::Vector2d& top = parts.tops[s];
      for (std::int32_t x = cellOf(top.x() - reach); x <= cellOf(top.x() + reach); ++x)
        for (std::int32_t y = cellOf(top.y() - reach); y <= cellOf(top.y() + reach); ++y)
          cells_[keyOf(x, y)].push_back(s);
    }
  }

  /// Calls `visit` for every source that may take the cluxel.
  template <typename Visit>
  void forEachTaker(std::uint32_t cluxel, const Visit& visit) const {
    const Eigen::Vector3d& centre = parts_.all.center[cluxel];
    const auto cell = cells_.find(keyOf(cellOf(centre.x()), cellOf(centre.y())));
    if (cell == cells_.end()) return;
    for (const std::uint32_t source : cell->second)
      if (parts_.mayTake(source, cluxel)) visit(source);
  }

 private:
  std::int32_t cellOf(double coordinate_m) const {
    return static_cast<std::int32_t>(std::floor(coordinate_m / cell_m_));
  }
  static std::uint64_t keyOf(std::int32_t x, std::int32_t y) {
    return std::uint64_t{static_cast<std::uint32_t>(x)} << 32U | static_cast<std::uint32_t>(y);
  }

  const CrownParts& parts_;
  double cell_m_ = 0.5;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

}  // namespace

std::vector<SourceGroup> groupsOf(const CrownParts& parts, std::span<const std::uint32_t> crown) {
  const SourceCells cells(parts);
  DisjointSets sets(parts.sources.size());
  std::vector<std::uint32_t> takers, first(crown.size() + 1, 0);
  for (std::size_t i = 0; i < crown.size(); ++i) {
    cells.forEachTaker(crown[i], [&](std::uint32_t source) { takers.push_back(source); });
    for (std::size_t t = first[i]; t < takers.size(); ++t) sets.join(takers[first[i]], takers[t]);
    first[i + 1] = static_cast<std::uint32_t>(takers.size());
  }
  const std::vector<std::uint32_t> number = sets.numbers();
  std::vector<SourceGroup> groups;
  std::vector<std::uint32_t> place(number.size());  // of each source in its group
  for (std::uint32_t s = 0; s < number.size(); ++s) {
    if (number[s] == groups.size()) groups.emplace_back();
    place[s] = static_cast<std::uint32_t>(groups[number[s]].sources.size());
    groups[number[s]].sources.push_back(s);
  }
  for (std::uint32_t i = 0; i < crown.size(); ++i) {
    if (first[i] == first[i + 1]) continue;
    SourceGroup& group = groups[number[takers[first[i]]]];
    group.cluxels.push_back(crown[i]);
    group.positions.push_back(i);
    for (std::uint32_t t = first[i]; t < first[i + 1]; ++t) group.takers.push_back(place[takers[t]]);
    group.takers.push_back(kNoSource);
  }
  return groups;
}

}  // namespace cluxel::rules
