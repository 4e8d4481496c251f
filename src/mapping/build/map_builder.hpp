// SPDX-License-Identifier: Apache-2.0
// Builds a map file from scans, batch by batch. After every commit, readers see the exact map of the scans so far.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "cluxel/progress.hpp"
#include "cluxel/term.hpp"
#include "mapping/build/batch_size.hpp"
#include "mapping/build/tile_stages.hpp"
#include "mapping/map_inputs.hpp"
#include "scan/scan_set.hpp"

namespace cluxel::mapping {

struct BuildParams {
  unsigned threads = 1;
  std::uint64_t batch_points = kBatchPoints;  ///< a batch of scans is committed when it holds this many points
  std::uint64_t stage_points = kStagePoints;  ///< batches of more than 1.5 times as many go through the stages in bands
  bool force = false;                         ///< replace a finished map
  bool refine_poses = false;  ///< register the scans first (registerPoses()); otherwise poses that do not fit are noted
  bool drop_statements = false;       ///< with `force`: drop the operator's statements of the old map
  std::vector<Quad> statements = {};  ///< of graph `operator`, added to those that are kept
};

struct BuildReport {
  std::size_t scans = 0, tiles = 0, cluxels = 0, primitives = 0, objects = 0;
  std::uint64_t points = 0, quads = 0;
  std::size_t scans_already_there = 0;  ///< of the unfinished build that was continued, or given twice
  std::vector<scan::ScanId> given;      ///< the scans that were given, in their order
};

/// Builds `file` from `scans`, under a BuildLock. Throws Error (InvalidArgument) for a finished map, or a store that no
/// build has made, unless `force`. An unfinished build of the same inputs is continued when all its scans are among
/// those given. With `force` the new map is built in FILE.building and replaces the old one by a rename, so that there
/// is always a complete map. The operator's statements cannot be recomputed: they are copied from the old map at the
/// end, unless they are to be dropped. A scan that is given more than once counts once, with its latest time, and is
/// noted. Throws InputError for faulty scans, rules, ontology or model; nothing is written then.
BuildReport buildMap(const scan::ScanSet& scans, const MapInputs& inputs, const std::filesystem::path& file,
                     const BuildParams& params, ProgressSink& sink);

}  // namespace cluxel::mapping
