// SPDX-License-Identifier: Apache-2.0
// Multi-source Dijkstra: all trunks are sources, the vertices are the cluxels of the crown. Trunks that cannot take a
// common cluxel are searched from apart; from a trunk alone, what it reaches is all that matters. A jump is mostly
// longer than the path along the edges: long jumps are looked for late, when most of their ends are settled.
#include "rules/objects/crown_splitting.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <deque>
#include <limits>
#include <queue>

#include "base/parallel.hpp"
#include "rules/objects/crown_groups.hpp"
#include "rules/objects/jump_grid.hpp"
#include "rules/objects/known_splits.hpp"
#include "rules/propose/cluxel_grid.hpp"

namespace cluxel::rules {

namespace {

constexpr double kJumpPenalty = 2.0;
constexpr double kTop_m = 0.5;
constexpr double kRounding_m = 1e-6;  // half diagonals are rounded to floats

/// Length of a path and the number of its source. Shorter paths come first; of equal ones, the smaller source number.
struct Way {
  double length = 0;
  std::uint32_t source = 0;
  auto operator<=>(const Way&) const = default;
};
constexpr Way kNoWay{std::numeric_limits<double>::infinity(), kNoSource};

/// The search from one group of sources. Clearance, reach and jump differ by source, so the edges of a vertex depend on
/// the source of its path.
class GroupSearch {
 public:
  /// `cluxels` are those that some source of the group reaches; `places` are those of all cluxels of the scene.
  GroupSearch(const CrownParts& parts, std::uint32_t group, const std::vector<std::uint32_t>& sources,
              const std::vector<std::uint32_t>& cluxels, const std::vector<SearchPlace>& places)
      : all_(parts.all),
        parts_(parts),
        group_(group),
        group_sources_(sources),
        cluxels_(cluxels),
        places_(places),
        grid_(entriesOf(parts.all, cluxels), longestJump()),
        best_(cluxels.size(), kNoWay) {}

  /// The shortest path to each of the cluxels.
  std::vector<Way> run() {
    for (const std::uint32_t source : group_sources_) leave(source);
    if (isAlone())
      flood();
    else
      search();
    return std::move(best_);
  }

 private:
  bool isAlone() const { return group_sources_.size() == 1; }
  /// The length of a step of a path. Without rivals lengths do not matter.
  double lengthOf(double distance_m) const { return isAlone() ? 0 : distance_m; }

  /// Edges first: what they reach needs no jump.
  void flood() {
    std::deque<Departure>& jumps = rings_.front();
    while (true) {
      if (!reached_.empty()) {
        const std::uint32_t at = reached_.back();
        reached_.pop_back();
        settle(at);
      } else if (!jumps.empty()) {
        const Departure departure = jumps.back();
        jumps.pop_back();
        jumpFrom(departure, kRings_m.size() - 1);
      } else {
        return;
      }
    }
  }

  void search() {
    while (true) {
      std::deque<Departure>* jumps = nextJumps();
      // Of equal lengths the jumps come first: they may lead to the vertex that would be settled.
      if (jumps != nullptr && (open_.empty() || jumps->front().ready_m <= open_.top().way.length)) {
        const Departure departure = jumps->front();
        jumps->pop_front();
        jumpFrom(departure, static_cast<std::size_t>(jumps - rings_.data()));
      } else if (!open_.empty()) {
        const Open next = open_.top();
        open_.pop();
        if (next.way == best_[next.at]) settle(next.at);
      } else {
        return;
      }
    }
  }

  struct Open {
    Way way;
    std::uint32_t at = 0;
    bool operator<(const Open& other) const { return way > other.way; }  // the shortest on top
  };
  /// A cluxel from which jumps of one ring of distances are not looked for yet.
  struct Departure {
    double ready_m = 0;  ///< no shorter path leads over such a jump
    std::uint32_t cluxel = 0;
    Way way;
  };
  /// The smallest distance of the jumps of each ring [m]; a ring ends where the next begins.
  static constexpr std::array<double, 2> kRings_m{0, 0.4};

  static std::vector<JumpGrid::Entry> entriesOf(const perception::SceneCluxels& all,
                                                const std::vector<std::uint32_t>& cluxels) {
    std::vector<JumpGrid::Entry> entries;
    entries.reserve(cluxels.size());
    for (std::uint32_t i = 0; i < cluxels.size(); ++i)
      entries.push_back({all.center[cluxels[i]], static_cast<double>(all.extent[cluxels[i]].norm()) / 2, i});
    return entries;
  }

  double longestJump() const {
    double longest = 0;
    for (const std::uint32_t source : group_sources_) longest = std::max(longest, parts_.sources[source].jump_m);
    return longest;
  }

  /// The ring with the shortest path that is ready; null when there is none. Paths enter a ring in ascending order.
  std::deque<Departure>* nextJumps() {
    std::deque<Departure>* next = nullptr;
    for (std::deque<Departure>& ring : rings_)
      if (!ring.empty() && (next == nullptr || ring.front().ready_m < next->front().ready_m)) next = &ring;
    return next;
  }

  /// Paths start at the trunk's cluxels above the clearance, or at its highest ones when none is above it.
  void leave(std::uint32_t s) {
    const CrownSource& source = parts_.sources[s];
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
    const double start = parts_.sources[s].start_m, reach = start + half_m + grid_.widestHalf_m() + kRounding_m;
    grid_.within(low.array() - reach, high.array() + reach, [&](const JumpGrid::Entry& entry) {
      if (parts_.isBeyond(entry.centre, s)) return;
      double shortest = std::numeric_limits<double>::infinity();
      for (std::uint32_t cluxel : from)
        if (const double distance = (entry.centre - all_.center[cluxel]).norm();
            distance < shortest && gapBetween(all_, cluxel, cluxels_[entry.at]).gap() <= start)
          shortest = distance;
      if (std::isfinite(shortest)) offer(entry.at, {lengthOf(kJumpPenalty * shortest), s});
    });
  }

  /// The shortest path to the vertex is known. The search for jumps leaves it out from now on.
  void settle(std::uint32_t at) {
    grid_.remove(all_.center[cluxels_[at]], at);
    depart(cluxels_[at], best_[at]);
  }

  /// Follows the edges of the cluxel graph, and notes the jumps.
  void depart(std::uint32_t cluxel, const Way& way) {
    const Eigen::Vector3d& from = all_.center[cluxel];
    for (std::uint32_t neighbour : all_.neighbours(cluxel)) {
      const auto [group, to] = places_[neighbour];
      if (group == group_ && best_[to] > way)
        offer(to, {way.length + lengthOf((all_.center[neighbour] - from).norm()), way.source});
    }
    const double reach = isAlone() ? 0 : reachOf(cluxel, way.source) + grid_.widestHalf_m();
    for (std::size_t ring = 0; ring < kRings_m.size() && kRings_m[ring] <= reach; ++ring)
      rings_[ring].push_back({way.length + kJumpPenalty * kRings_m[ring], cluxel, way});
  }

  /// The largest distance from the cluxel's centre to the near end of another one's half diagonal.
  double reachOf(std::uint32_t cluxel, std::uint32_t source) const {
    return parts_.sources[source].jump_m + static_cast<double>(all_.extent[cluxel].norm()) / 2 + kRounding_m;
  }

  /// Jumps over gaps to the vertices of a ring. Those that have a shorter path are skipped.
  void jumpFrom(const Departure& departure, std::size_t ring) {
    const std::uint32_t cluxel = departure.cluxel;
    const Way& way = departure.way;
    const double jump = parts_.sources[way.source].jump_m, reach = reachOf(cluxel, way.source);
    double outer = reach + grid_.widestHalf_m();
    if (ring + 1 < kRings_m.size()) outer = std::min(outer, kRings_m[ring + 1]);
    const Eigen::Vector3d& from = all_.center[cluxel];
    grid_.within(from.array() - outer, from.array() + outer, [&](const JumpGrid::Entry& other) {
      // Most pairs are too far apart, or have a shorter path: both are known before the gap is measured.
      const double square = (other.centre - from).squaredNorm();
      if (square > (reach + other.half_m) * (reach + other.half_m)) return;
      if (best_[other.at].length < way.length) return;
      const Way longer{way.length + lengthOf(kJumpPenalty * (other.centre - from).norm()), way.source};
      if (best_[other.at] > longer && gapBetween(all_, cluxel, cluxels_[other.at]).gap() <= jump)
        offer(other.at, longer);
    });
  }

  void offer(std::uint32_t to, const Way& way) {
    if (best_[to] <= way || !parts_.mayTake(way.source, cluxels_[to])) return;
    best_[to] = way;
    if (isAlone())
      reached_.push_back(to);
    else
      open_.push({way, to});
  }

  const perception::SceneCluxels& all_;
  const CrownParts& parts_;
  std::uint32_t group_;
  const std::vector<std::uint32_t>&group_sources_, &cluxels_;
  const std::vector<SearchPlace>& places_;
  JumpGrid grid_;
  std::vector<Way> best_;
  std::priority_queue<Open> open_;
  std::vector<std::uint32_t> reached_;  ///< of a source alone
  std::array<std::deque<Departure>, kRings_m.size()> rings_;
};

/// The place of a source in its group; kNoSource for none.
std::uint32_t placeIn(const SourceGroup& group, std::uint32_t source) {
  if (source == kNoSource) return kNoSource;
  const auto found = std::lower_bound(group.sources.begin(), group.sources.end(), source);
  return static_cast<std::uint32_t>(found - group.sources.begin());
}

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
    for (const Way& way : GroupSearch(parts, number, group.sources, group.cluxels, places).run())
      split.outcome.push_back(placeIn(group, way.source));
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
