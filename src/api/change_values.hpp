// SPDX-License-Identifier: Apache-2.0
// Options and reports of changes as values of the facade.
#pragma once

#include "cluxel/change.hpp"
#include "mapping/change/map_editor.hpp"
#include "mapping/change/map_merge.hpp"

namespace cluxel {

/// One per processor for 0.
unsigned threadCountOf(unsigned threads);
/// Throws Error (InvalidArgument) for a batch of no points.
mapping::ChangeParams changeParams(const ChangeOptions& options);
/// Throws Error (InvalidArgument) when the matrix is no rigid motion.
Eigen::Isometry3d poseOf(const CloudPose& pose);
struct MergeRequest {
  std::vector<mapping::MapToMerge> maps;
  mapping::MergeParams params;
};
/// Throws Error (InvalidArgument) as changeParams(), and for a transform and a map to be used that do not fit.
MergeRequest mergeRequestOf(const std::vector<std::filesystem::path>& maps, const MergeOptions& options);
MapChanges changesOf(const mapping::ChangeReport& report);

}  // namespace cluxel
