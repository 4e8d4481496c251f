// SPDX-License-Identifier: Apache-2.0
// Refines the given poses of scans by registering overlapping scans, or measures how well they fit.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "cluxel/progress.hpp"
#include "scan/scan_set.hpp"

namespace cluxel::scan {

struct RegistrationParams {
  /// Of each scan about so many points are compared, half of them above the ground; all of a scan that has fewer.
  std::size_t max_compared = std::numeric_limits<std::size_t>::max();
  double reach_m = 1.0;          ///< how wrong the poses of neighbouring scans may be to each other
  double voxel_m = 0.3;          ///< scans are thinned to one point per cube of this edge
  double min_overlap = 0.3;      ///< share of points with a neighbour in the other scan, below which a pair is left out
  double max_residual_m = 0.10;  ///< of a pair after registration, above which it is left out
  double max_contradiction_m =
      0.05;  ///< mean distance of a pair's surfaces from where the pair wants them, above which too
};

enum class PairOutcome { Used, LittleOverlap, LargeResidual, Contradicts };
const char* nameOf(PairOutcome outcome);

/// Two scans near each other, `first` before `second` in PoseRegistration::scans.
struct RegisteredPair {
  std::size_t first = 0, second = 0;
  PairOutcome outcome = PairOutcome::Used;
  double overlap = 0;            ///< in [0, 1], with the refined poses
  double residual_before_m = 0;  ///< median distance of points of one scan to planes of the other, of the surfaces ...
  double residual_after_m = 0;   ///< ... that face the direction in which the two disagree most
  /// How far apart the scans lie under the given poses, across the ground: the distance of their middles by that within
  /// which half of the points of a scan lie, the smaller of the two. Infinite where few points tell, and where the
  /// scans lie at other heights, as on two floors of a house.
  double spacing = std::numeric_limits<double>::infinity();
};

struct RefinedScan {
  std::size_t index = 0;  ///< in the ScanSet
  Eigen::Isometry3d T_map_sensor = Eigen::Isometry3d::Identity();
  double shift_m = 0, turn_rad = 0;  ///< from the given pose
  std::size_t pairs = 0;             ///< used ones; 0: the pose is the given one, to the last bit
  std::size_t group = 0;             ///< the first scan that used pairs join it to; groups lie to each other as given
};

struct PoseRegistration {
  std::vector<RefinedScan> scans;  ///< in natural order of their paths; a scan given twice once
  std::vector<RegisteredPair> pairs;
  double residual_before_m = 0;  ///< median over the pairs used
  double residual_after_m = 0;

  std::vector<PosedScan> poses() const;  ///< of the scans, in their order
};

/// Registers neighbouring scans by generalised ICP, then all poses together (docs/decisions/0005-registration.md). The
/// result is independent of the order of the scans and the number of threads. Directions that surfaces do not determine
/// keep the given poses. Throws InputError for a scan without a pose, or given with two. Cost: some 0.6 s a scan on one
/// core; the points of one scan a thread, and thinned points of all, are in memory.
PoseRegistration registerPoses(const ScanSet& scans, const RegistrationParams& params, unsigned threads,
                               ProgressSink& sink);

/// Only measures: pairs with their residual under the given poses, which stay (`residual_after_m` equals `..before_m`).
PoseRegistration measurePoses(const ScanSet& scans, const RegistrationParams& params, unsigned threads,
                              ProgressSink& sink);

/// Up to three pairs of near scans spread over those with a pose, to be measured where all would take too long. Empty
/// when fewer than two have one.
std::vector<PosedScan> sampledNeighbours(const ScanSet& scans);

/// Scans whose surfaces lie further apart have poses that do not fit each other.
inline constexpr double kFittingResidual_m = 0.05;

}  // namespace cluxel::scan
