// SPDX-License-Identifier: Apache-2.0
// Clusters are judged by the evidence of all their cluxels together.
#include "tasks/changes/changed_cluxels.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "perception/visibility/presence.hpp"

namespace cluxel::tasks {

namespace {

using perception::RayVerdict;

class Clustering {
 public:
  Clustering(CluxelChange kind, const ChangedCluxels& all)
      : kind_(kind),
        all_(all),
        cluxels_(all.cluxels),
        has_left_(all.changes.size(), false),
        groups_(statesIn(kind, all), [this](auto cluxel, const auto& visit) {
          for (const std::uint32_t other : cluxels_.neighbours(cluxel))
            if (!has_left_[other]) visit(other);
        }) {}

  std::vector<ChangeGroup> all() const { return groups_.all(kMinCluxels); }

  std::vector<ChangeGroup> possible() const {
    std::vector<ChangeGroup> clusters = all();
    std::erase_if(clusters, [this](const ChangeGroup& cluster) {
      return !isShown(cluster, groups_.withNear(cluster), kMostSparseHits);
    });
    return clusters;
  }

  std::vector<ChangeGroup> sureOf(std::vector<ChangeGroup> clusters) {
    has_left_ = leftIn(kind_, all_);
    for (const ChangeGroup& cluster : clusters) markRestsOfLeft(cluster);
    std::vector<ChangeGroup> sure;
    for (ChangeGroup& cluster : clusters) {
      std::erase_if(cluster, [this](std::uint32_t cluxel) { return has_left_[cluxel]; });
      for (ChangeGroup& connected : groups_.connectedAmong(cluster, kMinCluxels))
        if (isSure(connected)) sure.push_back(std::move(connected));
    }
    std::sort(sure.begin(), sure.end());
    return sure;
  }

 private:
  static constexpr std::size_t kMinCluxels = 5, kMany = 10;
  static constexpr double kShown = 3.5;  ///< log-odds of each cluxel of what is gone, on average
  /// Log-odds that one scan adds at most. Its rays miss a thing together when its pose is off.
  static constexpr double kMostOfScan = 2;
  static constexpr double kWhole = 0.9, kMinShare = 0.75, kMinShareOfMany = 0.5, kThin_m = 0.3;
  static constexpr std::size_t kMinTop = 8, kLarge = 12;
  static constexpr double kMostSparseHits = 0.95;
  static constexpr double kMostAside = 0.75;  ///< share of cluxels that rays pass only aside of the thing
  static constexpr double kDense = 0.6;  ///< share of scans with few rays that hit a thing through which few rays pass
  static constexpr perception::PresenceParams kPresence{};

  static std::vector<ChangeState> statesIn(CluxelChange kind, const ChangedCluxels& all) {
    std::vector<ChangeState> states;
    for (const CluxelChange change : all.changes)
      states.push_back(change == CluxelChange::Undecided ? ChangeState::Undecided
                       : change == kind                  ? ChangeState::Changed
                                                         : ChangeState::Stable);
    return states;
  }

  static std::uint32_t lastVisit(const ScanNumbers& scans, const ChangedCluxels& all) {
    return all.visits.ofScan(scans.last());
  }

  /// Of which rays of a visit passed after the last visit that hit them.
  static std::vector<bool> leftIn(CluxelChange kind, const ChangedCluxels& all) {
    std::vector<bool> has_left(all.changes.size(), false);
    for (std::size_t i = 0; i < has_left.size(); ++i) {
      if (all.changes[i] != kind) continue;
      const RayFindings& there = kind == CluxelChange::Vanished ? all.before[i] : all.after[i];
      const ScanNumbers passed = there.allPassed();
      has_left[i] = there.isHit() && !passed.empty() && lastVisit(passed, all) > lastVisit(there.hits, all);
    }
    return has_left;
  }

  /// The findings at a cluxel while the thing was there, or was not; null for ground.
  const RayFindings* findingsAt(std::uint32_t cluxel, bool was_there) const {
    if (!all_.is_told[cluxel]) return nullptr;
    return was_there == (kind_ == CluxelChange::Vanished) ? &all_.before[cluxel] : &all_.after[cluxel];
  }

  bool isThin(const ChangeGroup& cluster) const {
    Eigen::AlignedBox2d box;
    for (const std::uint32_t cluxel : cluster) {
      const Eigen::Vector2d low = cluxels_.low_corner[cluxel].head<2>();
      box.extend(low);
      box.extend(low + cluxels_.extent[cluxel].head<2>().cast<double>());
    }
    return box.sizes().minCoeff() < kThin_m;
  }

  /// The scans that tell nothing of the thing while it was there, because it was away meanwhile.
  ScanNumbers scansWithoutIt(const ChangeGroup& cluster, const ChangeGroup& around) const {
    ScanNumbers hits, without;
    for (const std::uint32_t cluxel : around)
      if (const RayFindings* there = findingsAt(cluxel, true)) hits |= there->hits;
    std::map<std::uint32_t, std::size_t> seen_through;
    for (const std::uint32_t cluxel : cluster)
      findingsAt(cluxel, true)->seen_through.forEach([&](std::uint32_t scan) { ++seen_through[scan]; });
    for (const auto& [scan, cluxels] : seen_through)
      if (cluxels >= kMinCluxels && !hits.contains(scan)) without.insert(scan);
    addScansOfVisitsWithoutIt(cluster, around, without);
    return without;
  }

  /// What the visits of the time with the thing found.
  VisitVotes votesWithIt(const ChangeGroup& cluster) const {
    PlaceVotes votes(all_.visits, cluster.size());
    for (const std::uint32_t cluxel : cluster) {
      const RayFindings& there = *findingsAt(cluxel, true);
      votes.addPlace(there.hits, there.allPassed());
    }
    return votes.take();
  }

  /// Later visits may not have seen all of a thing that left. So the cluxels of a cluster that one visit hit last are
  /// judged together: when they were away in the end, all of them have left.
  void markRestsOfLeft(const ChangeGroup& cluster) {
    std::map<std::uint32_t, ChangeGroup> by_last_visit;
    for (const std::uint32_t cluxel : cluster)
      if (const RayFindings& there = *findingsAt(cluxel, true); there.isHit())
        by_last_visit[lastVisit(there.hits, all_)].push_back(cluxel);
    for (const auto& [visit, things] : by_last_visit)
      if (isAwayAtEnd(votesWithIt(things)))
        for (const std::uint32_t cluxel : things) has_left_[cluxel] = true;
  }

  void addScansOfVisitsWithoutIt(const ChangeGroup& cluster, const ChangeGroup& around, ScanNumbers& without) const {
    const std::vector<std::uint32_t> visits = visitsWithoutIt(votesWithIt(cluster));
    if (visits.empty()) return;
    for (const std::uint32_t cluxel : around)
      if (const RayFindings* there = findingsAt(cluxel, true))
        there->allPassed().forEach([&](std::uint32_t scan) {
          if (std::binary_search(visits.begin(), visits.end(), all_.visits.ofScan(scan))) without.insert(scan);
        });
  }

  /// The chance that few rays hit the thing while it was there.
  double sparseHits(const ChangeGroup& cluster, const ChangeGroup& around, const ScanNumbers& without) const {
    double hits = isThin(cluster) ? 0.5 : 2, passed = isThin(cluster) ? 2 : 0.5;
    for (const std::uint32_t cluxel : around)
      if (const RayFindings* there = findingsAt(cluxel, true)) {
        hits += static_cast<double>(there->sparse_hits.size());
        passed += static_cast<double>(there->passed.sizeWithout(without));
      }
    return std::min(hits / (hits + passed), kMostSparseHits);
  }

  /// Whether the thing lets so many rays through while it is there that scans without a hit do not show that it is
  /// gone. Rays find gaps in a crown: one scan sees through many places of it.
  bool isPermeable(const ChangeGroup& cluster, const ChangeGroup& around, const ScanNumbers& without) const {
    double hits = 2, seen_through = 0.1;
    for (const std::uint32_t cluxel : around)
      if (const RayFindings* there = findingsAt(cluxel, true)) {
        hits += static_cast<double>(there->hits.size());
        seen_through += static_cast<double>(there->seen_through.sizeWithout(without));
      }
    const double each = std::log(seen_through / (hits + seen_through) / (1 - kPresence.hit_when_gone));
    double log_odds = 0;
    for (const std::uint32_t cluxel : cluster) {
      const RayFindings& gone = *findingsAt(cluxel, false);
      log_odds += std::min(each, 0.0) * static_cast<double>(gone.seen_through.size() + gone.passed.size());
    }
    return log_odds > -kShown * static_cast<double>(cluster.size());
  }

  /// Whether the rays that pass all go along the edge of something: of a roof or a wall that the sensor sees edge-on,
  /// nearly as many end before each place as pass it.
  bool isAtEdge(const ChangeGroup& cluster) const {
    double passing = 0, stopped = 0;
    for (const std::uint32_t cluxel : cluster) {
      const RayFindings& gone = *findingsAt(cluxel, false);
      passing += static_cast<double>(gone.passing_rays), stopped += static_cast<double>(gone.stopped_rays);
    }
    return stopped > kMostStopped * passing;
  }

  /// Whether hardly any ray that passes would have ended at the thing: rays pass close above a roof that the sensor
  /// sees edge-on, whether it is there or not.
  bool isPassedAside(const ChangeGroup& cluster) const {
    const auto aside = std::count_if(cluster.begin(), cluster.end(), [this](std::uint32_t cluxel) {
      const RayFindings& gone = *findingsAt(cluxel, false);
      return gone.seen_through.size() + gone.passed.size() <= gone.aside;
    });
    return static_cast<double>(aside) > kMostAside * static_cast<double>(cluster.size());
  }

  bool isSure(const ChangeGroup& cluster) const {
    const ChangeGroup around = groups_.withNear(cluster);
    const ScanNumbers without = scansWithoutIt(cluster, around);
    return !isAtEdge(cluster) && !isPassedAside(cluster) && !isPermeable(cluster, around, without) &&
           isShown(cluster, around, sparseHits(cluster, around, without));
  }

  /// Whether the rays of the time without the thing show that it is gone. With more `sparse_hits` they show no less.
  bool isShown(const ChangeGroup& cluster, const ChangeGroup& around, double sparse_hits) const {
    std::size_t seen_through = 0;
    for (const std::uint32_t cluxel : cluster) seen_through += findingsAt(cluxel, false)->seen_through.empty() ? 0 : 1;
    const double share = groups_.shareOfChanged(around), log_odds = logOddsOfScans(cluster, sparse_hits);
    const bool scans_agree = log_odds <= -kPresence.decided;
    if (share >= kWhole) return scans_agree || seen_through >= kMinCluxels || isLarge(cluster, sparse_hits, log_odds);
    if (!scans_agree) return false;
    return (seen_through >= kMinCluxels && share >= kMinShare) || (seen_through >= kMany && share >= kMinShareOfMany) ||
           isTop(cluster);
  }

  /// Whether all of something is gone from some height upwards: what was cut, while a crown has leaves beside a gap.
  bool isTop(const ChangeGroup& cluster) const {
    const auto height = [this](std::uint32_t cluxel) { return cluxels_.center[cluxel].z(); };
    return cluster.size() >= kMinTop && groups_.shareOfChangedAbove(cluster, height) >= kWhole;
  }

  /// Whether a thing is so large and dense that two scans do not miss it: their poses are not off alike.
  static bool isLarge(const ChangeGroup& cluster, double sparse_hits, double log_odds) {
    return cluster.size() >= kLarge && sparse_hits >= kDense && log_odds <= -2 * kMostOfScan;
  }

  /// Log-odds of "there" from the scans that passed the thing, however many of its cluxels each of them passed.
  double logOddsOfScans(const ChangeGroup& cluster, double sparse_hits) const {
    const double each = std::log((1 - sparse_hits) / (1 - kPresence.hit_when_gone));
    std::map<std::uint32_t, double> of_scan;
    for (const std::uint32_t cluxel : cluster) {
      const RayFindings& gone = *findingsAt(cluxel, false);
      gone.allPassed().forEach([&](std::uint32_t scan) { of_scan[scan] += std::min(each, 0.0); });
    }
    double log_odds = 0;
    for (const auto& [scan, sum] : of_scan) log_odds += std::max(sum, -kMostOfScan);
    return log_odds;
  }

  CluxelChange kind_;
  const ChangedCluxels& all_;
  const perception::SceneCluxels& cluxels_;
  std::vector<bool> has_left_;  ///< by cluxel: it is not near to any; known once clusters are judged
  ChangeGroups groups_;
};

}  // namespace

void RayFindings::add(const perception::PlaceVerdict& found, std::uint32_t scan) {
  if (found.verdict == RayVerdict::Hit) hits.insert(scan);
  if (found.verdict == RayVerdict::Hit && found.is_sparse) sparse_hits.insert(scan);
  if (found.verdict == RayVerdict::SeenThrough) seen_through.insert(scan);
  if (found.verdict == RayVerdict::FewPassed) passed.insert(scan);
  if (found.verdict == RayVerdict::SeenThrough || found.verdict == RayVerdict::FewPassed)
    passing_rays += found.rays.passed, stopped_rays += found.stopped, aside += found.is_aside ? 1 : 0;
}

CluxelChange changeOf(const RayFindings& before, const RayFindings& after) {
  if (before.isHit() && after.isHit()) return CluxelChange::Stable;
  if (before.isHit() && after.isEmpty()) return CluxelChange::Vanished;
  if (before.isEmpty() && after.isHit()) return CluxelChange::Appeared;
  return CluxelChange::Undecided;
}

std::vector<ChangeGroup> clustersOf(CluxelChange kind, const ChangedCluxels& all) {
  Clustering clustering(kind, all);
  return clustering.sureOf(clustering.all());
}

std::vector<ChangeGroup> clustersAmong(std::vector<ChangeGroup> possible, CluxelChange kind,
                                       const ChangedCluxels& all) {
  return Clustering(kind, all).sureOf(std::move(possible));
}

std::vector<ChangeGroup> possibleClusters(CluxelChange kind, const ChangedCluxels& all) {
  return Clustering(kind, all).possible();
}

}  // namespace cluxel::tasks
