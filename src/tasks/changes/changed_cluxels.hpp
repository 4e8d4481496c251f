// SPDX-License-Identifier: Apache-2.0
// Which cluxels vanished or appeared between two groups of scans, and the clusters that they form.
#pragma once

#include <cstdint>
#include <vector>

#include "mapping/map_reader.hpp"

namespace cluxel::tasks {

/// What the rays of a group of scans found at a cluxel.
struct RayFindings {
  bool is_hit = false;
  bool is_seen_through = false;              ///< by several rays of one scan
  std::uint8_t sparse_hits = 0, passed = 0;  ///< scans of which so few rays came near that they may miss a thin thing

  /// Rays passed the place, and none ended there.
  bool isEmpty() const { return !is_hit && (is_seen_through || passed > 0); }
};

struct CluxelFindings {
  std::vector<std::uint32_t> numbers;      ///< cluxels of the scene, ascending
  std::vector<RayFindings> before, after;  ///< parallel to `numbers`
};

/// Compares the rays of the timed scans before `since_s`, and of those from it on, with the cluxels in `wanted`. Cost:
/// about half a microsecond for each cluxel and scan within its range.
CluxelFindings findingsAt(const mapping::MapReader& map, double since_s, const std::vector<bool>& wanted,
                          unsigned threads);

enum class CluxelChange : std::uint8_t {
  Undecided,  ///< not covered before or after
  Stable,     ///< hit before and after
  Vanished,   ///< hit before and empty after
  Appeared,   ///< empty before and hit after
};
/// By cluxel of the scene.
std::vector<CluxelChange> changesOf(const CluxelFindings& findings, std::size_t cluxel_count);

/// Connected clusters of cluxels that changed alike, each ascending, in the order of their first cluxel. They are left
/// out when the rays may have missed a thing that is still there: when of the decided cluxels in and around a cluster
/// fewer than 70 % changed like it, or when the log-odds of "there" are above -6. A place that several rays saw through
/// counts log(0.2 / 0.95). One that few rays passed counts log((1 - p) / 0.95); p is the share of hits among such
/// places of the cluster and around it while the thing was there, with a prior that takes things less than 0.3 m wide
/// for easily missed.
std::vector<std::vector<std::uint32_t>> clustersOf(CluxelChange kind, const std::vector<CluxelChange>& changes,
                                                   const CluxelFindings& findings,
                                                   const perception::SceneCluxels& cluxels);

}  // namespace cluxel::tasks
