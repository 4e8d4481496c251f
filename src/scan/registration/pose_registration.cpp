// SPDX-License-Identifier: Apache-2.0
// Coarse: generalised ICP of neighbours, from large errors. Fine: all pairs and poses together, from small ones.
#include "scan/registration/pose_registration.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "base/counted_progress.hpp"
#include "base/disjoint_sets.hpp"
#include "base/parallel.hpp"
#include "base/quantile.hpp"
#include "scan/registration/pair_evidence.hpp"
#include "scan/registration/pose_graph.hpp"
#include "scan/registration/registration_scans.hpp"
#include "scan/registration/scan_pairing.hpp"

namespace cluxel::scan {

namespace {

using Poses = std::vector<Eigen::Isometry3d>;

Eigen::Isometry3d between(const Poses& poses, const ScanPair& pair) {
  return poses[pair.first].inverse() * poses[pair.second];
}

class Registration {
 public:
  Registration(const RegistrationScans& scans, const RegistrationParams& params, unsigned threads, ProgressSink& sink)
      : scans_(&scans), params_(&params), threads_(threads), sink_(&sink) {}

  /// The evidence of the pairs under `poses`, with matches within `reach_m`.
  std::vector<PairEvidence> evidence(const std::vector<ScanPair>& pairs, const Poses& poses, double reach_m) const {
    std::vector<PairEvidence> all(pairs.size());
    const EvidenceParams params{.reach_m = reach_m, .tolerance_m = reach_m / 5};
    parallelFor(pairs.size(), threads_, [&](std::size_t k) {
      all[k] = evidenceOf(cloud(pairs[k].first), cloud(pairs[k].second), between(poses, pairs[k]), params);
    });
    return all;
  }

  /// Generalised ICP of each pair, then poses that fit all pairs with a credible result.
  Poses coarse(const std::vector<ScanPair>& pairs, const Poses& given) const {
    std::vector<std::optional<PoseConstraint>> said(pairs.size());
    CountedProgress progress(*sink_, "register", pairs.size());
    parallelFor(pairs.size(), threads_, [&](std::size_t k) {
      said[k] = aligned(pairs[k], between(given, pairs[k]));
      progress.step();
    });
    std::vector<PoseConstraint> constraints;
    for (const auto& constraint : said)
      if (constraint) constraints.push_back(*constraint);
    return solveWithoutContradictions(given, given, constraints);
  }

  /// Gauss-Newton over all pairs, with points matched anew in each round. `outcomes`: of the last round.
  Poses fine(const std::vector<ScanPair>& pairs, const Poses& given, Poses poses,
             std::vector<PairOutcome>& outcomes) const {
    constexpr std::size_t kMaxRounds = 40;
    constexpr double kFirstReach_m = 0.5, kReach_m = 0.3, kSettled_m = 0.0005;
    for (std::size_t round = 0; round < kMaxRounds; ++round) {
      sink_->progress("join", round + 1, kMaxRounds);
      const std::vector<PairEvidence> said = evidence(pairs, poses, round == 0 ? kFirstReach_m : kReach_m);
      std::vector<PoseConstraint> constraints;
      for (std::size_t k = 0; k < pairs.size(); ++k) {
        outcomes[k] = credible(said[k]);
        if (outcomes[k] == PairOutcome::Used)
          constraints.push_back(constraintOf(pairs[k], between(poses, pairs[k]), said[k]));
      }
      const Poses before = poses;
      poses = solveWithoutContradictions(given, poses, constraints);
      for (std::size_t k = 0; k < pairs.size(); ++k)
        if (outcomes[k] == PairOutcome::Used && !isAmong(constraints, pairs[k])) outcomes[k] = PairOutcome::Contradicts;
      if (farthestMove(before, poses) < kSettled_m) break;
    }
    return poses;
  }

 private:
  const SurfaceCloud& cloud(std::size_t i) const { return scans_->clouds[i]; }

  PairOutcome credible(const PairEvidence& evidence) const {
    if (evidence.overlap < params_->min_overlap) return PairOutcome::LittleOverlap;
    return evidence.residual_m > params_->max_residual_m ? PairOutcome::LargeResidual : PairOutcome::Used;
  }

  static PoseConstraint constraintOf(const ScanPair& pair, const Eigen::Isometry3d& T, const PairEvidence& said) {
    return {pair.first, pair.second, T * motion(said.wish), said.information};
  }

  std::optional<PoseConstraint> aligned(const ScanPair& pair, const Eigen::Isometry3d& T_given) const {
    const SurfaceCloud &target = cloud(pair.first), &source = cloud(pair.second);
    if (const auto T = pcl().alignedByGicp(target, source, T_given, params_->reach_m))
      if (const auto said = credibleConstraint(pair, T_given, *T)) return said;
    return credibleConstraint(pair, T_given, laidOnPlanes(target, source, T_given));
  }

  /// The constraint of a pair at `T`, when `T` is within reach and the surfaces coincide.
  std::optional<PoseConstraint> credibleConstraint(const ScanPair& pair, const Eigen::Isometry3d& T_given,
                                                   const Eigen::Isometry3d& T) const {
    if (smallMotion(T_given.inverse() * T).head<3>().norm() > 2 * params_->reach_m) return std::nullopt;
    const PairEvidence said = evidenceOf(cloud(pair.first), cloud(pair.second), T, {});
    if (credible(said) != PairOutcome::Used) return std::nullopt;
    return constraintOf(pair, T, said);
  }

  /// Point-to-plane ICP from a first guess, for pairs where generalised ICP stalls because rounding of its floats hides
  /// the next step of its line search. The first rounds have a wide tolerance, since the few surfaces that reveal a
  /// shift are those with large gaps.
  Eigen::Isometry3d laidOnPlanes(const SurfaceCloud& target, const SurfaceCloud& source, Eigen::Isometry3d T) const {
    constexpr int kMaxRounds = 12;
    constexpr double kSettled_m = 0.001;
    const double reach_m = std::min(params_->reach_m, SurfaceCloud::kMaxReach_m);
    for (const double tolerance_m : {reach_m, reach_m / 5}) {
      for (int round = 0; round < kMaxRounds; ++round) {
        const Vector6d wish = evidenceOf(target, source, T, {.reach_m = reach_m, .tolerance_m = tolerance_m}).wish;
        T = T * motion(wish);
        if (wish.head<3>().norm() < kSettled_m) break;
      }
    }
    return T;
  }

  static bool isAmong(const std::vector<PoseConstraint>& constraints, const ScanPair& pair) {
    return std::any_of(constraints.begin(), constraints.end(), [&](const PoseConstraint& said) {
      return said.first == pair.first && said.second == pair.second;
    });
  }

  static double farthestMove(const Poses& before, const Poses& after) {
    double farthest_m = 0;
    for (std::size_t i = 0; i < before.size(); ++i)
      farthest_m = std::max(farthest_m, (after[i].translation() - before[i].translation()).norm());
    return farthest_m;
  }

  /// The distance of the surfaces of a pair from where its constraint puts them [m].
  static double contradiction(const PoseConstraint& said, const Poses& poses) {
    const Vector6d off = smallMotion(said.T_first_second.inverse() * between(poses, {said.first, said.second}));
    return std::sqrt(std::max(0.0, off.dot(said.information * off)));
  }

  /// Removes the worst constraint until all fit. Scans without a constraint keep their given pose.
  Poses solveWithoutContradictions(const Poses& given, const Poses& start,
                                   std::vector<PoseConstraint>& constraints) const {
    for (;;) {
      const Poses poses = solvePoseGraph(given, keptWhereUnbound(given, start, constraints), constraints, {});
      const auto worst = std::max_element(constraints.begin(), constraints.end(), [&](const auto& a, const auto& b) {
        return contradiction(a, poses) < contradiction(b, poses);
      });
      if (worst == constraints.end() || contradiction(*worst, poses) <= params_->max_contradiction_m) return poses;
      constraints.erase(worst);
    }
  }

  static Poses keptWhereUnbound(const Poses& given, Poses poses, const std::vector<PoseConstraint>& constraints) {
    std::vector<bool> is_bound(given.size(), false);
    for (const PoseConstraint& said : constraints) is_bound[said.first] = is_bound[said.second] = true;
    for (std::size_t i = 0; i < given.size(); ++i)
      if (!is_bound[i]) poses[i] = given[i];
    return poses;
  }

  const RegistrationScans* scans_;
  const RegistrationParams* params_;
  unsigned threads_;
  ProgressSink* sink_;
};

/// Boxes are grown, so that those of two surfaces within `reach_m` meet.
std::vector<ScanPlace> placesOf(const RegistrationScans& scans, const Poses& poses, double reach_m) {
  std::vector<ScanPlace> places;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    ScanPlace place{.position = poses[i].translation(), .box = {}};
    for (std::size_t k = 0; k < scans.clouds[i].size(); ++k) place.box.extend(poses[i] * scans.clouds[i].point(k));
    place.box.min().array() -= reach_m / 2;
    place.box.max().array() += reach_m / 2;
    places.push_back(place);
  }
  return places;
}

/// Where most surfaces of a scan lie [m, map].
struct Middle {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();  ///< across the ground
  double reach_m = 0;                            ///< half of them lie within it; 0 for too few to tell
  double low_m = 0, high_m = 0;                  ///< nine tenths of them lie between these heights
};

Middle middleOf(const SurfaceCloud& cloud, const Eigen::Isometry3d& T_map_sensor) {
  constexpr std::size_t kFew = 200;
  Middle middle;
  if (cloud.withPlane().size() < kFew) return middle;
  std::vector<Eigen::Vector2d> places;
  std::vector<double> heights;
  for (const std::size_t i : cloud.withPlane()) {
    const Eigen::Vector3d place = T_map_sensor * cloud.point(i);
    places.emplace_back(place.head<2>());
    heights.push_back(place.z());
  }
  const auto median = [&](const auto& value) {
    std::vector<double> values;
    for (const Eigen::Vector2d& place : places) values.push_back(value(place));
    return medianOf(std::move(values));
  };
  for (const int axis : {0, 1}) middle.at[axis] = median([&](const Eigen::Vector2d& place) { return place[axis]; });
  middle.reach_m = median([&](const Eigen::Vector2d& place) { return (place - middle.at).norm(); });
  std::sort(heights.begin(), heights.end());
  middle.low_m = quantileOf(heights, 0.05), middle.high_m = quantileOf(heights, 0.95);
  return middle;
}

/// Whether at least half of the heights of one of them are heights of the other, too.
bool areLevel(const Middle& a, const Middle& b) {
  const double common_m = std::min(a.high_m, b.high_m) - std::max(a.low_m, b.low_m);
  return common_m >= std::min(a.high_m - a.low_m, b.high_m - b.low_m) / 2;
}

double spacingOf(const Middle& a, const Middle& b) {
  const double reach_m = std::min(a.reach_m, b.reach_m);
  if (reach_m <= 0 || !areLevel(a, b)) return std::numeric_limits<double>::infinity();
  return (a.at - b.at).norm() / reach_m;
}

/// The report, with scans in natural order of their paths.
PoseRegistration reported(const RegistrationScans& scans, const Poses& poses, const std::vector<ScanPair>& pairs,
                          const std::vector<PairOutcome>& outcomes, const std::vector<PairEvidence>& before,
                          const std::vector<PairEvidence>& after) {
  PoseRegistration report;
  std::vector<std::size_t> place(scans.clouds.size());
  for (const std::size_t i : scans.byPath()) {
    place[i] = report.scans.size();
    const Vector6d moved = smallMotion(scans.given[i].inverse() * poses[i]);
    report.scans.push_back({scans.index[i], poses[i], moved.head<3>().norm(), moved.tail<3>().norm(), 0, 0});
  }
  std::vector<Middle> middles;
  for (std::size_t i = 0; i < scans.clouds.size(); ++i) middles.push_back(middleOf(scans.clouds[i], scans.given[i]));
  DisjointSets groups(report.scans.size());
  std::vector<double> residuals_before, residuals_after;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const std::size_t one = place[pairs[k].first], other = place[pairs[k].second];
    const std::size_t first = std::min(one, other), second = std::max(one, other);
    const double spacing = spacingOf(middles[pairs[k].first], middles[pairs[k].second]);
    report.pairs.push_back(
        {first, second, outcomes[k], after[k].overlap, before[k].residual_m, after[k].residual_m, spacing});
    if (outcomes[k] != PairOutcome::Used) continue;
    for (const std::size_t end : {first, second}) ++report.scans[end].pairs;
    groups.join(static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(second));
    residuals_before.push_back(before[k].residual_m);
    residuals_after.push_back(after[k].residual_m);
  }
  for (std::size_t i = 0; i < report.scans.size(); ++i)
    report.scans[i].group = groups.find(static_cast<std::uint32_t>(i));
  std::sort(report.pairs.begin(), report.pairs.end(),
            [](const auto& a, const auto& b) { return std::tie(a.first, a.second) < std::tie(b.first, b.second); });
  report.residual_before_m = medianOf(residuals_before);
  report.residual_after_m = medianOf(residuals_after);
  return report;
}

constexpr double kMaxPairDistance_m = 40;  // between scans of a wider pair
constexpr double kReportReach_m = 0.5;

}  // namespace

const char* nameOf(PairOutcome outcome) {
  constexpr std::array names{"used", "too little overlap", "residual too large", "contradicts its neighbours"};
  return names[static_cast<std::size_t>(outcome)];
}

std::vector<PosedScan> PoseRegistration::poses() const {
  std::vector<PosedScan> posed;
  for (const RefinedScan& scan : scans) posed.push_back({scan.index, scan.T_map_sensor});
  return posed;
}

PoseRegistration registerPoses(const ScanSet& set, const RegistrationParams& params, unsigned threads,
                               ProgressSink& sink) {
  const RegistrationScans scans = loadForRegistration(set, params, threads, sink);
  const Registration registration(scans, params, threads, sink);
  const Poses coarse = registration.coarse(nearestPairs(placesOf(scans, scans.given, params.reach_m)), scans.given);
  const std::vector<ScanPair> pairs = widerPairs(placesOf(scans, coarse, params.reach_m), kMaxPairDistance_m);
  std::vector<PairOutcome> outcomes(pairs.size(), PairOutcome::Used);
  const Poses poses = registration.fine(pairs, scans.given, coarse, outcomes);
  return reported(scans, poses, pairs, outcomes, registration.evidence(pairs, scans.given, kReportReach_m),
                  registration.evidence(pairs, poses, kReportReach_m));
}

PoseRegistration measurePoses(const ScanSet& set, const RegistrationParams& params, unsigned threads,
                              ProgressSink& sink) {
  const RegistrationScans scans = loadForRegistration(set, params, threads, sink);
  const Registration registration(scans, params, threads, sink);
  const std::vector<ScanPair> pairs = nearestPairs(placesOf(scans, scans.given, params.reach_m));
  const std::vector<PairEvidence> said = registration.evidence(pairs, scans.given, kReportReach_m);
  std::vector<PairOutcome> outcomes;
  for (const PairEvidence& pair : said)
    outcomes.push_back(pair.overlap < params.min_overlap ? PairOutcome::LittleOverlap : PairOutcome::Used);
  return reported(scans, scans.given, pairs, outcomes, said, said);
}

std::vector<PosedScan> sampledNeighbours(const ScanSet& scans) {
  constexpr std::size_t kPairs = 3;
  std::vector<std::size_t> with_pose;
  for (std::size_t i = 0; i < scans.size(); ++i)
    if (scans.file(i).has_pose) with_pose.push_back(i);
  const std::size_t count = with_pose.size();
  std::set<std::size_t> chosen;
  for (std::size_t k = 0; k < kPairs && count > 1; ++k) {
    const std::size_t i = with_pose[k * (count - 1) / (kPairs - 1)];
    const Eigen::Vector3d at = scans.file(i).T_map_sensor.translation();
    const auto distance_m = [&](std::size_t other) {
      return other == i ? std::numeric_limits<double>::infinity()
                        : (scans.file(other).T_map_sensor.translation() - at).norm();
    };
    chosen.insert({i, *std::min_element(with_pose.begin(), with_pose.end(),
                                        [&](std::size_t a, std::size_t b) { return distance_m(a) < distance_m(b); })});
  }
  std::vector<PosedScan> posed;
  for (const std::size_t i : chosen) posed.push_back({i, scans.file(i).T_map_sensor});
  return posed;
}

}  // namespace cluxel::scan
