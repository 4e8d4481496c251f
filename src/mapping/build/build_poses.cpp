// SPDX-License-Identifier: Apache-2.0
// Refines or checks poses, and reports the result as notes.
#include "mapping/build/build_poses.hpp"

#include <array>
#include <cstdio>
#include <string>

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

namespace {

/// The least of the residuals that tells by itself: those of single pairs vary where leaves stand.
constexpr double kGrossResidual_m = 4 * scan::kFittingResidual_m;

/// Scans so close to each other overlap well, unless a pose is wrong or a wall lies between them.
constexpr double kNear = 1.5;

/// The names of the two scans of a pair.
std::string namesOf(const scan::ScanSet& scans, const scan::PoseRegistration& found, const scan::RegisteredPair& pair) {
  const auto name = [&](std::size_t i) { return scans.file(found.scans[i].index).path.string(); };
  return name(pair.first) + " and " + name(pair.second);
}

std::string metres(double length_m) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2f m", length_m);
  return text.data();
}

/// What measured pairs say against the poses; empty when nothing.
std::string misfit(const scan::ScanSet& scans, const scan::PoseRegistration& found) {
  const scan::RegisteredPair* worst = nullptr;
  for (const scan::RegisteredPair& pair : found.pairs)
    if (pair.outcome == scan::PairOutcome::Used && (!worst || pair.residual_before_m > worst->residual_before_m))
      worst = &pair;
  if (!worst) return {};
  const std::string of_worst = "of " + namesOf(scans, found, *worst);
  if (found.residual_before_m > scan::kFittingResidual_m)
    return "surfaces of neighbouring scans lie " + metres(found.residual_before_m) +
           " apart (median of the scans examined), those " + of_worst + " " + metres(worst->residual_before_m);
  if (worst->residual_before_m <= kGrossResidual_m) return {};
  return "surfaces " + of_worst + " lie " + metres(worst->residual_before_m) + " apart";
}

/// The pair of least overlap among those of scans near each other that no measured pairs join.
const scan::RegisteredPair* unjoined(const scan::PoseRegistration& found) {
  const scan::RegisteredPair* least = nullptr;
  for (const scan::RegisteredPair& pair : found.pairs)
    if (pair.spacing < kNear && found.scans[pair.first].group != found.scans[pair.second].group &&
        (!least || pair.overlap < least->overlap))
      least = &pair;
  return least;
}

}  // namespace

void noteDoubtfulPoses(const scan::ScanSet& scans, unsigned threads, ProgressSink& sink) {
  const std::vector<scan::PosedScan> sample = sampledNeighbours(scans);
  if (sample.empty()) return;
  const scan::ScanSet examined = scans.posed(sample);
  scan::PoseRegistration found;
  try {
    found = measurePoses(examined, {.max_compared = kCompared}, threads, sink);
  } catch (const InputError&) {
    return;
  } catch (const Error& fault) {
    return sink.note(std::string("poses are not checked: ") + fault.what());
  }
  if (const std::string why = misfit(examined, found); !why.empty())
    sink.note("poses do not fit each other: " + why + "; refine the poses before or during the build");
  if (const scan::RegisteredPair* pair = unjoined(found)) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "only %.0f %% of their surfaces meet", 100 * pair->overlap);
    sink.note("poses may be wrong, or a wall or floor lies between scans: " + namesOf(examined, found, *pair) +
              " lie near each other, but " + text.data() + "; check that the poses belong to the scans");
  }
}

}  // namespace cluxel::mapping
