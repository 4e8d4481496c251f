// SPDX-License-Identifier: Apache-2.0
// Dijkstra from all trunks at once over the crown's cluxels.
#include "reasoning/crown_parting.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <tuple>

#include "reasoning/cluxel_grid.hpp"

namespace cluxel {

namespace {

constexpr double kJumpPenalty = 2.0;
constexpr double kTop_m = 0.5;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Crown cluxels in cells as wide as the longest jump between centres, for gaps that no edge of the graph bridges.
class JumpGrid {
 public:
  JumpGrid(const SceneCluxels& all, std::span<const std::uint32_t> crown, double centres_m)
      : cell_m_(std::max(centres_m, 0.05)) {
    for (std::size_t i = 0; i < crown.size(); ++i) entries_.push_back({cellOf(all.center[crown[i]]), i});
    std::sort(entries_.begin(), entries_.end());
  }

  template <typename Visit>
  void near(const Eigen::Vector3d& p, const Visit& visit) const {
    const Cell centre = cellOf(p);
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy) {
        const Cell first{centre[0] + dx, centre[1] + dy, centre[2] - 1};
        for (auto e = std::lower_bound(entries_.begin(), entries_.end(), std::pair(first, std::size_t{0}));
             e != entries_.end() && e->first[0] == first[0] && e->first[1] == first[1] && e->first[2] <= first[2] + 2;
             ++e)
          visit(e->second);
      }
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  Cell cellOf(const Eigen::Vector3d& p) const {
    return {static_cast<std::int64_t>(std::floor(p.x() / cell_m_)), static_cast<std::int64_t>(std::floor(p.y() / cell_m_)),
            static_cast<std::int64_t>(std::floor(p.z() / cell_m_))};
  }
  double cell_m_;
  std::vector<std::pair<Cell, std::size_t>> entries_;
};

class Parting {
 public:
  Parting(const SceneCluxels& all, std::span<const std::uint32_t> crown, std::span<const CrownSource> sources)
      : all_(all), crown_(crown), sources_(sources), grid_(all, crown, longestJump(all, crown, sources)),
        taken_(crown.size(), kNoSource), best_(crown.size(), {kInfinity, kNoSource}) {
    for (const CrownSource& source : sources) tops_.push_back(topOf(all, source.trunk));
  }

  std::vector<std::uint32_t> run() {
    for (std::uint32_t s = 0; s < sources_.size(); ++s) start(s);
    while (!open_.empty()) {
      const auto [length, source, at] = open_.top();
      open_.pop();
      if (taken_[at] != kNoSource) continue;
      taken_[at] = source;
      relaxFrom(crown_[at], length, source);
    }
    return taken_;
  }

 private:
  using Way = std::tuple<double, std::uint32_t, std::size_t>;   // length, source, place in the crown

  /// Between centres: a jump is a gap between boxes.
  static double longestJump(const SceneCluxels& all, std::span<const std::uint32_t> crown,
                            std::span<const CrownSource> sources) {
    double longest = 0, widest = 0;
    for (std::uint32_t cluxel : crown) widest = std::max(widest, static_cast<double>(all.extent[cluxel].norm()));
    for (const CrownSource& source : sources) {
      longest = std::max(longest, source.jump_m);
      for (std::uint32_t cluxel : source.trunk)
        widest = std::max(widest, static_cast<double>(all.extent[cluxel].norm()));
    }
    return longest + widest;
  }

  /// Ways begin at the trunk's cluxels above the clearance; if there is none, at its highest ones.
  void start(std::uint32_t s) {
    const CrownSource& source = sources_[s];
    std::vector<std::uint32_t> from;
    double highest = -kInfinity;
    for (std::uint32_t cluxel : source.trunk) {
      highest = std::max(highest, all_.center[cluxel].z());
      if (static_cast<double>(all_.height_above_ground[cluxel]) >= source.clearance_m) from.push_back(cluxel);
    }
    if (from.empty())
      for (std::uint32_t cluxel : source.trunk)
        if (all_.center[cluxel].z() >= highest - kTop_m) from.push_back(cluxel);
    for (std::uint32_t cluxel : from) relaxFrom(cluxel, 0, s);
    if (source.start_m > source.jump_m) leapFrom(from, s);
  }

  /// From the trunk to crown cluxels beyond a jump.
  void leapFrom(const std::vector<std::uint32_t>& from, std::uint32_t s) {
    for (std::size_t at = 0; at < crown_.size(); ++at) {
      if ((all_.center[crown_[at]].head<2>() - tops_[s]).norm() > sources_[s].reach_m) continue;
      double shortest = std::numeric_limits<double>::infinity();
      for (std::uint32_t cluxel : from)
        if (gapBetween(all_, cluxel, crown_[at]).gap() <= sources_[s].start_m)
          shortest = std::min(shortest, (all_.center[crown_[at]] - all_.center[cluxel]).norm());
      if (std::isfinite(shortest)) relax(at, kJumpPenalty * shortest, s);
    }
  }

  void relaxFrom(std::uint32_t cluxel, double length, std::uint32_t s) {
    const Eigen::Vector3d& from = all_.center[cluxel];
    for (std::uint32_t neighbour : all_.neighbours(cluxel)) {
      const auto place = std::lower_bound(crown_.begin(), crown_.end(), neighbour);
      if (place == crown_.end() || *place != neighbour) continue;
      relax(static_cast<std::size_t>(place - crown_.begin()), length + (all_.center[neighbour] - from).norm(), s);
    }
    const double jump = sources_[s].jump_m;
    grid_.near(from, [&](std::size_t at) {
      if (taken_[at] != kNoSource || gapBetween(all_, cluxel, crown_[at]).gap() > jump) return;
      relax(at, length + kJumpPenalty * (all_.center[crown_[at]] - from).norm(), s);
    });
  }

  void relax(std::size_t at, double length, std::uint32_t s) {
    if (taken_[at] != kNoSource) return;
    const CrownSource& source = sources_[s];
    const std::uint32_t cluxel = crown_[at];
    if (static_cast<double>(all_.height_above_ground[cluxel]) < source.clearance_m) return;
    if ((all_.center[cluxel].head<2>() - tops_[s]).norm() > source.reach_m) return;
    const std::pair<double, std::uint32_t> way{length, s};
    if (way >= best_[at] || (source.may_take && !source.may_take(cluxel))) return;
    best_[at] = way;
    open_.emplace(length, s, at);
  }

  const SceneCluxels& all_;
  std::span<const std::uint32_t> crown_;
  std::span<const CrownSource> sources_;
  JumpGrid grid_;
  std::vector<Eigen::Vector2d> tops_;
  std::vector<std::uint32_t> taken_;
  std::vector<std::pair<double, std::uint32_t>> best_;   ///< the shortest way in `open_`, and whose
  std::priority_queue<Way, std::vector<Way>, std::greater<>> open_;
};

}  // namespace

Eigen::Vector2d topOf(const SceneCluxels& all, std::span<const std::uint32_t> trunk) {
  double highest = -std::numeric_limits<double>::infinity();
  for (std::uint32_t cluxel : trunk) highest = std::max(highest, all.center[cluxel].z());
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double count = 0;
  for (std::uint32_t cluxel : trunk)
    if (all.center[cluxel].z() >= highest - kTop_m) {
      sum += all.center[cluxel].head<2>();
      count += 1;
    }
  return count == 0 ? sum : Eigen::Vector2d(sum / count);
}

std::vector<std::uint32_t> partCrown(const SceneCluxels& all, std::span<const std::uint32_t> crown,
                                     std::span<const CrownSource> sources) {
  return Parting(all, crown, sources).run();
}

}  // namespace cluxel
