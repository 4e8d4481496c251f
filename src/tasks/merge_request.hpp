// SPDX-License-Identifier: Apache-2.0
// What callers say of a merge: the transform between two maps, and the map whose ontology, rules and model are used.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "mapping/change/map_merge.hpp"

namespace cluxel::tasks {

/// A transform from the second map to the first that was measured. Throws Error (InvalidArgument) unless there are two
/// maps.
void setTransform(std::vector<mapping::MapToMerge>& maps, const Eigen::Isometry3d& T_first_second);

/// The number of the map that is `file`, whatever its name. Throws Error (InvalidArgument) when none is.
std::size_t numberAmong(const std::vector<mapping::MapToMerge>& maps, const std::filesystem::path& file);

}  // namespace cluxel::tasks
