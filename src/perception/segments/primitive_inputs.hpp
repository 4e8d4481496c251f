// SPDX-License-Identifier: Apache-2.0
// What reasoning and facts read of a primitive, as a hash: a change concerns the primitives of which it differs.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "perception/segments/scene.hpp"
#include "perception/segments/summary_tile.hpp"

namespace cluxel::perception {

/// For each cluxel a hash of its seed, which names it in every scene.
std::vector<std::uint64_t> seedHashes(const SceneSeeds& seeds);

/// For each primitive a hash of its measures, its cluxels with their edges and with what each scan saw of them, its
/// relations, and the scans that saw it. It does not depend on the numbers of primitives, cluxels and scans.
/// `summaries`: of all tiles of the scene. Cost: about 50 ns a cluxel.
std::vector<std::uint64_t> inputHashes(const Scene& scene, const std::map<TileKey, SummaryTile>& summaries);

}  // namespace cluxel::perception
