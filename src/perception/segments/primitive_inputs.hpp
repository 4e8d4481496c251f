// SPDX-License-Identifier: Apache-2.0
// What reasoning and facts read of a primitive, as a hash: a change concerns the primitives of which it differs.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "perception/segments/scene.hpp"
#include "perception/segments/summary_tile.hpp"

namespace cluxel::perception {

/// For each cluxel a hash of its seed, which names it in every scene.
std::vector<std::uint64_t> seedHashes(const SceneSeeds& seeds);

/// Hashes of primitives, each of its measures, its cluxels with their edges and with what each scan saw of them, its
/// relations, and the scans that saw it. They do not depend on the numbers of primitives, cluxels and scans.
class PrimitiveInputs {
 public:
  /// `summaries`: of all tiles of the scene. Both must outlive it.
  PrimitiveInputs(const Scene& scene, const std::map<TileKey, SummaryTile>& summaries);
  ~PrimitiveInputs();
  PrimitiveInputs(const PrimitiveInputs&) = delete;
  PrimitiveInputs& operator=(const PrimitiveInputs&) = delete;

  /// Cost: about 50 ns a cluxel.
  std::uint64_t hashOf(PrimitiveIndex primitive);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The hashes of all primitives.
std::vector<std::uint64_t> inputHashes(const Scene& scene, const std::map<TileKey, SummaryTile>& summaries);

}  // namespace cluxel::perception
