// SPDX-License-Identifier: Apache-2.0
// The end of a merge.
#pragma once

#include <filesystem>

#include "cluxel/progress.hpp"

namespace cluxel::mapping {

/// Moves the map `merged` to `target`, which may be a map. Waits up to 10 minutes, and notes it, while another process
/// writes, copies or opens the target; then throws rdf::MapBusy.
void replaceByMerged(const std::filesystem::path& merged, const std::filesystem::path& target, ProgressSink& sink);

}  // namespace cluxel::mapping
