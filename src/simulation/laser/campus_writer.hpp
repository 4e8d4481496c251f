// SPDX-License-Identifier: Apache-2.0
// Writes a campus as a folder of scans with poses and truth, as `cluxel simulate` does.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>

#include "cluxel/progress.hpp"
#include "simulation/site/campus.hpp"

namespace cluxel::simulation {

/// What was written, for a closing line or --json.
struct CampusSummary {
  std::size_t scans = 0, points = 0, objects = 0;  ///< objects: those with at least one point
  std::array<std::size_t, 9> objects_of_class{};   ///< the same per number in truthClassNames()

  void count(const CampusObject& object) {
    ++objects;
    ++objects_of_class[static_cast<std::size_t>(object.class_number)];
  }
};

/// Scans the campus from every stop and writes
///   scan_000.pcd ... (binary, sensor frame), poses.txt (T_map_sensor, 4x4 rows), times.txt, campus.json,
///   truth/scan_000.truth.gz ... (`primitive object instance` per point), truth/instances.csv,
///   with more than one visit also truth/events.csv and truth/visits.csv.
/// The bytes are the same for every number of threads. The folder is made when missing and must be empty,
/// else Error (InvalidArgument); Error (StoreUnavailable) when the disk refuses.
CampusSummary writeCampus(const Campus& campus, const std::filesystem::path& folder, unsigned threads,
                          ProgressSink& sink);

}  // namespace cluxel::simulation
