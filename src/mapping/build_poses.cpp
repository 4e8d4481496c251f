// SPDX-License-Identifier: Apache-2.0
// Notes about poses, in words.
#include "mapping/build_poses.hpp"

#include <array>
#include <cstdio>

#include "cluxel/base/diagnostic.hpp"
#include "cluxel/scan/pose_registration.hpp"

namespace cluxel {

ScanSet withMendedPoses(const ScanSet& scans, unsigned threads, ProgressSink& sink) {
  const PoseRegistration mended = registerPoses(scans, {}, threads, sink);
  std::size_t used = 0, kept = 0;
  for (const RegisteredPair& pair : mended.pairs) used += pair.outcome == PairOutcome::Used ? 1 : 0;
  for (const MendedScan& scan : mended.scans) kept += scan.pairs == 0 ? 1 : 0;
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(),
                "poses mended: %zu of %zu pairs of scans used, median residual %.3f m before, %.3f m after; %zu of %zu "
                "scans keep their pose",
                used, mended.pairs.size(), mended.residual_before_m, mended.residual_after_m, kept,
                mended.scans.size());
  sink.note(text.data());
  return scans.posed(mended.poses());
}

void noteDoubtfulPoses(const ScanSet& scans, unsigned threads, ProgressSink& sink) {
  const std::vector<PosedScan> sample = sampledNeighbours(scans);
  if (sample.empty()) return;
  double residual_m = 0;
  try {
    residual_m = measurePoses(scans.posed(sample), {}, threads, sink).residual_before_m;
  } catch (const Error&) {
    return;
  }
  if (residual_m <= kFittingResidual_m) return;
  std::array<char, 256> text{};
  std::snprintf(
      text.data(), text.size(),
      "poses do not fit each other: surfaces of neighbouring scans lie %.2f m apart, in the median of those looked at; "
      "--register mends them",
      residual_m);
  sink.note(text.data());
}

}  // namespace cluxel
