// SPDX-License-Identifier: Apache-2.0
// Builds a map file from scans, batch by batch; every commit is the exact map of the scans so far.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

#include "cluxel/base/progress.hpp"
#include "cluxel/mapping/map_inputs.hpp"
#include "cluxel/scan/scan_set.hpp"

namespace cluxel {

struct BuildParams {
  unsigned threads = 1;
  std::uint64_t batch_points = 20'000'000;  ///< a batch of scans is committed when it holds this many points
  bool force = false;                       ///< replaces a finished map
  bool mend_poses = false;       ///< registers the scans first (registerPoses()); else poses that do not fit are noted
  bool drop_statements = false;  ///< with `force`: the operator's statements of the old map go with it
};

struct BuildReport {
  std::size_t scans = 0, tiles = 0, cluxels = 0, primitives = 0, objects = 0;
  std::uint64_t points = 0, quads = 0;
  std::size_t scans_already_there = 0;  ///< of an unfinished build that went on
};

/// Builds `file` from `scans`, under a BuildLock. A finished map, or a store that no build has made, is an Error
/// (Usage) unless `force`; an unfinished one of the same inputs goes on where it stopped, when all its scans are among
/// those given. With `force` the new map is made in FILE.building and takes the old one's place by a rename: there is
/// always one of them. The operator's statements are nobody's to compute again: the new map takes over those that the
/// old one has at the end, unless they are to be dropped. Throws InputError for faulty scans, rules, ontology or model:
/// nothing is written then.
BuildReport buildMap(const ScanSet& scans, const MapInputs& inputs, const std::filesystem::path& file,
                     const BuildParams& params, ProgressSink& sink);

}  // namespace cluxel
