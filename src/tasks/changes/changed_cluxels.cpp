// SPDX-License-Identifier: Apache-2.0
// Scans are loaded one after the other; cluxels are compared with their rays in parallel.
#include "tasks/changes/changed_cluxels.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "base/parallel.hpp"
#include "mapping/presence/ray_pass.hpp"
#include "perception/visibility/presence.hpp"
#include "perception/visibility/ray_bundle.hpp"

namespace cluxel::tasks {

namespace {

using perception::RayVerdict;
using Cluster = std::vector<std::uint32_t>;

void count(std::uint8_t& scans) {
  if (scans < 255) ++scans;
}

void look(const perception::RayBundle& bundle, const perception::SceneCluxels& cluxels, const Cluster& numbers,
          std::uint64_t scan_bit, unsigned threads, std::vector<RayFindings>& found) {
  constexpr std::size_t kChunk = 2048;
  constexpr perception::RayParams kParams;
  parallelFor((numbers.size() + kChunk - 1) / kChunk, threads, [&](std::size_t chunk) {
    const std::size_t end = std::min(numbers.size(), (chunk + 1) * kChunk);
    for (std::size_t i = chunk * kChunk; i < end; ++i) {
      const perception::PlaceVerdict place = bundle.verdictAt(cluxels.center[numbers[i]], kParams);
      if (place.verdict == RayVerdict::Hit) found[i].is_hit = true;
      if (place.verdict == RayVerdict::Hit) count(found[i].hits);
      if (place.verdict == RayVerdict::SeenThrough) count(found[i].seen_through);
      if (place.verdict == RayVerdict::SeenThrough) found[i].is_seen_through = true;
      if (place.verdict == RayVerdict::Hit && place.is_sparse) count(found[i].sparse_hits);
      if (place.verdict == RayVerdict::FewPassed) count(found[i].passed), found[i].passed_scans |= scan_bit;
    }
  });
}

class Clustering {
 public:
  Clustering(CluxelChange kind, const std::vector<CluxelChange>& changes, const CluxelFindings& findings,
             const perception::SceneCluxels& cluxels)
      : kind_(kind), changes_(changes), findings_(findings), cluxels_(cluxels) {}

  std::vector<Cluster> run() const {
    std::vector<Cluster> clusters;
    std::vector<bool> is_open(changes_.size());
    for (std::uint32_t i = 0; i < changes_.size(); ++i) is_open[i] = changes_[i] == kind_ && agrees(i);
    for (std::uint32_t start = 0; start < changes_.size(); ++start) {
      if (!is_open[start]) continue;
      Cluster cluster = connectedFrom(start, is_open);
      if (cluster.size() >= kMinCluxels && isSure(cluster)) clusters.push_back(std::move(cluster));
    }
    return clusters;
  }

 private:
  static constexpr std::size_t kMinCluxels = 5, kMany = 10;
  static constexpr double kShown = 3.5;  ///< log-odds of each cluxel of what is gone, on average
  /// Log-odds that one scan with few rays adds at most. Its rays miss a thing together when its pose is off.
  static constexpr double kMostOfScan = 2;
  static constexpr double kMinShare = 0.75, kMinShareOfMany = 0.5, kThin_m = 0.3;
  static constexpr perception::PresenceParams kPresence{};

  /// Whether most of the decided neighbours changed like the cluxel.
  bool agrees(std::uint32_t cluxel) const {
    std::size_t alike = 0, decided = 0;
    for (const std::uint32_t other : cluxels_.neighbours(cluxel)) {
      decided += changes_[other] != CluxelChange::Undecided ? 1 : 0;
      alike += changes_[other] == kind_ ? 1 : 0;
    }
    return 2 * alike > decided;
  }

  Cluster connectedFrom(std::uint32_t start, std::vector<bool>& is_open) const {
    Cluster cluster{start};
    is_open[start] = false;
    for (std::size_t next = 0; next < cluster.size(); ++next)
      for (const std::uint32_t other : cluxels_.neighbours(cluster[next])) {
        if (!is_open[other]) continue;
        is_open[other] = false;
        cluster.push_back(other);
      }
    std::sort(cluster.begin(), cluster.end());
    return cluster;
  }

  /// The cluster and the cluxels that intersect it, ascending.
  Cluster withNeighbours(const Cluster& cluster) const {
    Cluster all = cluster;
    for (const std::uint32_t cluxel : cluster)
      for (const std::uint32_t other : cluxels_.neighbours(cluxel)) all.push_back(other);
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }

  /// The findings at a cluxel while the thing was there, or was not; null for ground.
  const RayFindings* findingsAt(std::uint32_t cluxel, bool was_there) const {
    const auto at = std::lower_bound(findings_.numbers.begin(), findings_.numbers.end(), cluxel);
    if (at == findings_.numbers.end() || *at != cluxel) return nullptr;
    const auto i = static_cast<std::size_t>(at - findings_.numbers.begin());
    return was_there == (kind_ == CluxelChange::Vanished) ? &findings_.before[i] : &findings_.after[i];
  }

  bool isThin(const Cluster& cluster) const {
    Eigen::AlignedBox2d box;
    for (const std::uint32_t cluxel : cluster) {
      const Eigen::Vector2d low = cluxels_.low_corner[cluxel].head<2>();
      box.extend(low);
      box.extend(low + cluxels_.extent[cluxel].head<2>().cast<double>());
    }
    return box.sizes().minCoeff() < kThin_m;
  }

  /// The chance that few rays hit the thing while it was there.
  double sparseHits(const Cluster& cluster, const Cluster& around) const {
    double hits = isThin(cluster) ? 0.5 : 2, passed = isThin(cluster) ? 2 : 0.5;
    for (const std::uint32_t cluxel : around)
      if (const RayFindings* there = findingsAt(cluxel, true)) hits += there->sparse_hits, passed += there->passed;
    return std::min(hits / (hits + passed), 0.95);
  }

  /// Whether the thing lets so many rays through while it is there that scans without a hit do not show that it is
  /// gone. Rays find gaps in a crown: one scan sees through many places of it.
  bool isPermeable(const Cluster& cluster, const Cluster& around) const {
    double hits = 2, seen_through = 0.1;
    for (const std::uint32_t cluxel : around)
      if (const RayFindings* there = findingsAt(cluxel, true)) hits += there->hits, seen_through += there->seen_through;
    const double each = std::log(seen_through / (hits + seen_through) / (1 - kPresence.hit_when_gone));
    double log_odds = 0;
    for (const std::uint32_t cluxel : cluster) {
      const RayFindings& gone = *findingsAt(cluxel, false);
      log_odds += std::min(each, 0.0) * (gone.seen_through + gone.passed);
    }
    return log_odds > -kShown * static_cast<double>(cluster.size());
  }

  /// The share of the decided cluxels in and around a cluster that changed like it.
  double shareAlike(const Cluster& around) const {
    double alike = 0, decided = 0;
    for (const std::uint32_t cluxel : around) {
      decided += changes_[cluxel] != CluxelChange::Undecided ? 1 : 0;
      alike += changes_[cluxel] == kind_ ? 1 : 0;
    }
    return alike / decided;
  }

  bool isSure(const Cluster& cluster) const {
    std::size_t dense = 0;
    for (const std::uint32_t cluxel : cluster) dense += findingsAt(cluxel, false)->is_seen_through ? 1 : 0;
    const Cluster around = withNeighbours(cluster);
    const double share = shareAlike(around);
    if (isPermeable(cluster, around)) return false;
    if (dense >= kMinCluxels && share >= kMinShare) return true;
    if (dense >= kMany && share >= kMinShareOfMany) return true;
    return cluster.size() >= kMany && share >= kMinShare && !isThin(cluster) && isSureFromFewRays(cluster, around);
  }

  bool isSureFromFewRays(const Cluster& cluster, const Cluster& around) const {
    const double each = std::log((1 - sparseHits(cluster, around)) / (1 - kPresence.hit_when_gone));
    std::array<double, kScanBits> of_scan{};
    for (const std::uint32_t cluxel : cluster)
      for (std::uint64_t rest = findingsAt(cluxel, false)->passed_scans; rest != 0; rest &= rest - 1)
        of_scan[static_cast<std::size_t>(std::countr_zero(rest))] += std::min(each, 0.0);
    double log_odds = 0;
    for (const double sum : of_scan) log_odds += std::max(sum, -kMostOfScan);
    return log_odds <= -kPresence.decided;
  }

  CluxelChange kind_;
  const std::vector<CluxelChange>& changes_;
  const CluxelFindings& findings_;
  const perception::SceneCluxels& cluxels_;
};

}  // namespace

CluxelFindings findingsAt(const mapping::MapReader& map, double since_s, const std::vector<bool>& wanted,
                          unsigned threads) {
  CluxelFindings findings;
  for (std::uint32_t i = 0; i < wanted.size(); ++i)
    if (wanted[i]) findings.numbers.push_back(i);
  findings.before.resize(findings.numbers.size()), findings.after.resize(findings.numbers.size());
  const std::vector<mapping::Cloud> clouds = map.clouds();
  std::size_t number = 0;
  for (const mapping::Cloud* cloud : mapping::timedClouds(clouds)) {
    const std::uint64_t bit = std::uint64_t{1} << (number++ % kScanBits);
    perception::forEachRayBundle(map.scanOf(cloud->id), [&](const perception::RayBundle& bundle) {
      look(bundle, map.scene().cluxels, findings.numbers, bit, threads,
           *cloud->time_s < since_s ? findings.before : findings.after);
    });
  }
  return findings;
}

std::vector<CluxelChange> changesOf(const CluxelFindings& findings, std::size_t cluxel_count) {
  std::vector<CluxelChange> changes(cluxel_count, CluxelChange::Undecided);
  for (std::size_t i = 0; i < findings.numbers.size(); ++i) {
    const RayFindings &before = findings.before[i], &after = findings.after[i];
    CluxelChange& change = changes[findings.numbers[i]];
    if (before.is_hit && after.is_hit) change = CluxelChange::Stable;
    if (before.is_hit && after.isEmpty()) change = CluxelChange::Vanished;
    if (before.isEmpty() && after.is_hit) change = CluxelChange::Appeared;
  }
  return changes;
}

std::vector<Cluster> clustersOf(CluxelChange kind, const std::vector<CluxelChange>& changes,
                                const CluxelFindings& findings, const perception::SceneCluxels& cluxels) {
  return Clustering(kind, changes, findings, cluxels).run();
}

}  // namespace cluxel::tasks
