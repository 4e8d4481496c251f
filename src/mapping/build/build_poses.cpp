// SPDX-License-Identifier: Apache-2.0
// Refines or checks poses, and reports the result as notes.
#include "mapping/build/build_poses.hpp"

#include <array>
#include <cstdio>

#include "cluxel/error.hpp"
#include "scan/registration/pose_registration.hpp"

namespace cluxel::mapping {

scan::ScanSet withRefinedPoses(const scan::ScanSet& scans, unsigned threads, ProgressSink& sink) {
  const scan::PoseRegistration refined = registerPoses(scans, {}, threads, sink);
  std::size_t used = 0, kept = 0;
  for (const scan::RegisteredPair& pair : refined.pairs) used += pair.outcome == scan::PairOutcome::Used ? 1 : 0;
  for (const scan::RefinedScan& scan : refined.scans) kept += scan.pairs == 0 ? 1 : 0;
  std::array<char, 256> text{};
  std::snprintf(
      text.data(), text.size(),
      "poses refined: %zu of %zu pairs of scans used, median residual %.3f m before, %.3f m after; %zu of %zu "
      "scans keep their pose",
      used, refined.pairs.size(), refined.residual_before_m, refined.residual_after_m, kept, refined.scans.size());
  sink.note(text.data());
  return scans.posed(refined.poses());
}

/// Points of a scan: enough for a median, and planes of all take as long as a tenth of a small build.
constexpr std::size_t kCompared = 6000;

void noteDoubtfulPoses(const scan::ScanSet& scans, unsigned threads, ProgressSink& sink) {
  const std::vector<scan::PosedScan> sample = sampledNeighbours(scans);
  if (sample.empty()) return;
  double residual_m = 0;
  try {
    residual_m = measurePoses(scans.posed(sample), {.max_compared = kCompared}, threads, sink).residual_before_m;
  } catch (const Error&) {
    return;
  }
  if (residual_m <= scan::kFittingResidual_m) return;
  std::array<char, 256> text{};
  std::snprintf(
      text.data(), text.size(),
      "poses do not fit each other: surfaces of neighbouring scans lie %.2f m apart (median of the scans examined); "
      "refine the poses before or during the build",
      residual_m);
  sink.note(text.data());
}

}  // namespace cluxel::mapping
