// SPDX-License-Identifier: Apache-2.0
// Multi-source Dijkstra: all trunks are sources, the vertices are the cluxels of the crown. Trunks that cannot take a
// common cluxel are searched from apart; from a trunk alone, what it reaches is all that matters.
#include "rules/objects/crown_splitting.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/parallel.hpp"
#include "rules/objects/crown_groups.hpp"
#include "rules/objects/jump_grid.hpp"
#include "rules/objects/known_splits.hpp"
#include "rules/objects/open_vertices.hpp"
#include "rules/propose/cluxel_grid.hpp"

namespace cluxel::rules {

namespace {

constexpr double kTop_m = 0.5;
constexpr double kRounding_m = 1e-6;  // half diagonals are rounded to floats

/// The search from one group of sources. Clearance, reach and jump differ by source, so the edges of a vertex depend on
/// the source of its path.
class GroupSearch {
 public:
  /// `number` is the group's in `places`, which are those of all cluxels of the scene.
  GroupSearch(const CrownParts& parts, const SourceGroup& group, std::uint32_t number,
              const std::vector<SearchPlace>& places)
      : all_(parts.all),
        parts_(parts),
        group_(group),
        number_(number),
        cluxels_(group.cluxels),
        places_(places),
        grid_(entriesOf(parts.all, cluxels_), longestJump()),
        best_(cluxels_.size(), kNoWay) {
    first_taker_.reserve(cluxels_.size());
    for (std::uint32_t i = 0; i < group.takers.size(); ++i)
      if (i == 0 || group.takers[i - 1] == kNoSource) first_taker_.push_back(i);
  }

  /// For each of the cluxels the source with the shortest path.
  SplitOutcome run() {
    for (std::uint32_t source = 0; source < group_.sources.size(); ++source) leave(source);
    if (isAlone())
      flood();
    else
      search();
    SplitOutcome outcome;
    outcome.reserve(best_.size());
    for (const Way& way : best_) outcome.push_back(way.source);
    return outcome;
  }

 private:
  bool isAlone() const { return group_.sources.size() == 1; }
  const CrownSource& sourceAt(std::uint32_t place) const { return parts_.sources[group_.sources[place]]; }
  /// The length of a step of a path. Without rivals lengths do not matter.
  double lengthOf(double distance_m) const { return isAlone() ? 0 : distance_m; }

  /// Edges first: what they reach needs no jump.
  void flood() {
    while (true) {
      if (!reached_.empty()) {
        const std::uint32_t at = reached_.back();
        reached_.pop_back();
        settle(at);
      } else if (!departures_.empty()) {
        const auto [cluxel, way] = departures_.back();
        departures_.pop_back();
        jumpFrom(cluxel, way);
      } else {
        return;
      }
    }
  }

  void search() {
    while (const OpenVertex* next = open_.top(best_)) {
      const std::uint32_t at = next->at;
      open_.pop();
      settle(at);
    }
  }

  static std::vector<JumpGrid::Entry> entriesOf(const perception::SceneCluxels& all,
                                                const std::vector<std::uint32_t>& cluxels) {
    std::vector<JumpGrid::Entry> entries;
    entries.reserve(cluxels.size());
    for (const std::uint32_t cluxel : cluxels) entries.push_back({all.center[cluxel], all.extent[cluxel].norm() / 2});
    return entries;
  }

  double longestJump() const {
    double longest = 0;
    for (const std::uint32_t source : group_.sources) longest = std::max(longest, parts_.sources[source].jump_m);
    return longest;
  }

  /// Paths start at the trunk's cluxels above the clearance, or at its highest ones when none is above it.
  void leave(std::uint32_t s) {
    const CrownSource& source = sourceAt(s);
    std::vector<std::uint32_t> from;
    double highest = -std::numeric_limits<double>::infinity();
    for (std::uint32_t cluxel : source.trunk) {
      highest = std::max(highest, all_.center[cluxel].z());
      if (static_cast<double>(all_.height_above_ground[cluxel]) >= source.clearance_m) from.push_back(cluxel);
    }
    if (from.empty())
      for (std::uint32_t cluxel : source.trunk)
        if (all_.center[cluxel].z() >= highest - kTop_m) from.push_back(cluxel);
    for (std::uint32_t cluxel : from) depart(cluxel, {0, s});
    if (source.start_m > source.jump_m && !from.empty()) leapFrom(from, s);
  }

  /// Ways from the trunk to crown cluxels that are farther than a jump but within start_m.
  void leapFrom(const std::vector<std::uint32_t>& from, std::uint32_t s) {
    Eigen::Vector3d low = all_.center[from.front()], high = low;
    double half_m = 0;
    for (const std::uint32_t cluxel : from) {
      low = low.cwiseMin(all_.center[cluxel]), high = high.cwiseMax(all_.center[cluxel]);
      half_m = std::max(half_m, static_cast<double>(all_.extent[cluxel].norm()) / 2);
    }
    const double start = sourceAt(s).start_m, reach = start + half_m + grid_.widestHalf_m() + kRounding_m;
    grid_.within(low.array() - reach, high.array() + reach, [&](std::uint32_t at) {
      if (!mayTake(s, at)) return;
      const Eigen::Vector3d& centre = all_.center[cluxels_[at]];
      double shortest = std::numeric_limits<double>::infinity();  // squared
      for (std::uint32_t cluxel : from)
        if (const double square = (centre - all_.center[cluxel]).squaredNorm();
            square < shortest && gapBetween(all_, cluxel, cluxels_[at]).gap() <= start)
          shortest = square;
      if (std::isfinite(shortest)) offer(at, {lengthOf(kJumpPenalty * std::sqrt(shortest)), s});
    });
  }

  /// The shortest path to the vertex is known. The search for jumps leaves it out from now on.
  void settle(std::uint32_t at) {
    grid_.remove(at);
    depart(cluxels_[at], best_[at]);
  }

  /// Follows the edges of the cluxel graph, and jumps; from a source alone the jumps are only noted.
  void depart(std::uint32_t cluxel, const Way& way) {
    const Eigen::Vector3d& from = all_.center[cluxel];
    for (std::uint32_t neighbour : all_.neighbours(cluxel)) {
      const auto [group, to] = places_[neighbour];
      if (group == number_ && way < best_[to])
        offer(to, {way.length + lengthOf((all_.center[neighbour] - from).norm()), way.source});
    }
    if (isAlone())
      departures_.emplace_back(cluxel, way);
    else
      jumpFrom(cluxel, way);
  }

  /// Jumps over gaps. Vertices that have a shorter path are skipped.
  void jumpFrom(std::uint32_t cluxel, const Way& way) {
    const double jump = sourceAt(way.source).jump_m;
    const double reach = jump + static_cast<double>(all_.extent[cluxel].norm()) / 2 + kRounding_m;
    const Eigen::Vector3d& from = all_.center[cluxel];
    grid_.nearer({from, reach, way.length}, [&](std::uint32_t at) {
      const double distance = (all_.center[cluxels_[at]] - from).norm();
      const Way longer{way.length + lengthOf(kJumpPenalty * distance), way.source};
      if (longer < best_[at] && gapBetween(all_, cluxel, cluxels_[at]).gap() <= jump) offer(at, longer);
    });
  }

  bool mayTake(std::uint32_t source, std::uint32_t at) const {
    auto taker = group_.takers.begin() + first_taker_[at];
    while (*taker < source) ++taker;  // the last is kNoSource
    return *taker == source;
  }

  void offer(std::uint32_t to, const Way& way) {
    if (!(way < best_[to]) || !mayTake(way.source, to)) return;
    best_[to] = way;
    grid_.reach(to, way.length);
    if (isAlone())
      reached_.push_back(to);
    else
      open_.push({way, to});
  }

  const perception::SceneCluxels& all_;
  const CrownParts& parts_;
  const SourceGroup& group_;
  std::uint32_t number_;
  const std::vector<std::uint32_t>& cluxels_;
  const std::vector<SearchPlace>& places_;
  JumpGrid grid_;
  std::vector<std::uint32_t> first_taker_;  ///< of each cluxel, in the group's takers
  std::vector<Way> best_;
  OpenVertices open_;
  std::vector<std::uint32_t> reached_;                     ///< of a source alone
  std::vector<std::pair<std::uint32_t, Way>> departures_;  ///< of a source alone: cluxels to jump from
};

bool fits(const SplitOutcome& outcome, const SourceGroup& group) {
  return outcome.size() == group.cluxels.size() &&
         std::all_of(outcome.begin(), outcome.end(),
                     [&](std::uint32_t source) { return source == kNoSource || source < group.sources.size(); });
}

}  // namespace

Eigen::Vector2d topOf(const perception::SceneCluxels& all, std::span<const std::uint32_t> trunk) {
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

std::vector<std::uint32_t> splitCrown(const perception::SceneCluxels& all, std::span<const std::uint32_t> crown,
                                      std::span<const CrownSource> sources, unsigned threads, KnownSplits* known) {
  CrownParts parts{all, sources, {}};
  for (const CrownSource& source : sources) parts.tops.push_back(topOf(all, source.trunk));
  const std::vector<SourceGroup> groups = groupsOf(parts, crown);
  std::vector<SearchPlace> places(all.size());
  for (std::uint32_t g = 0; g < groups.size(); ++g)
    for (std::uint32_t i = 0; i < groups[g].cluxels.size(); ++i) places[groups[g].cluxels[i]] = {g, i};
  struct Split {
    ContentHash cause;
    SplitOutcome outcome;
    bool is_reused = false;
  };
  std::vector<Split> splits(groups.size());
  parallelFor(groups.size(), threads, [&](std::size_t g) {
    const SourceGroup& group = groups[g];
    Split& split = splits[g];
    const auto number = static_cast<std::uint32_t>(g);
    if (known != nullptr) {
      split.cause = causeOf(parts, group, number, places);
      if (const SplitOutcome* earlier = known->find(split.cause); earlier != nullptr && fits(*earlier, group)) {
        split.outcome = *earlier;
        split.is_reused = true;
        return;
      }
    }
    split.outcome = GroupSearch(parts, group, number, places).run();
  });
  std::vector<std::uint32_t> taken(crown.size(), kNoSource);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const SourceGroup& group = groups[g];
    Split& split = splits[g];
    for (std::size_t i = 0; i < group.cluxels.size(); ++i)
      if (split.outcome[i] != kNoSource) taken[group.positions[i]] = group.sources[split.outcome[i]];
    if (known != nullptr && !group.cluxels.empty()) known->note(split.cause, std::move(split.outcome), split.is_reused);
  }
  return taken;
}

}  // namespace cluxel::rules
