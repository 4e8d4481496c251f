// SPDX-License-Identifier: Apache-2.0
// Writes a city as folders of scans, one district after the other, as `cluxel simulate --city` does.
#pragma once

#include <cstddef>
#include <filesystem>

#include "cluxel/progress.hpp"
#include "simulation/laser/campus_writer.hpp"
#include "simulation/site/city.hpp"

namespace cluxel::simulation {

/// Districts by number, both ends included.
struct DistrictRange {
  std::size_t first = 0, last = 0;
};

/// Scans these districts and writes for each
///   district_0000/scan_0000_000.pcd ... (numbers of district and stop), poses.txt, times.txt, campus.json,
///   truth/district_0000/scan_0000_000.truth.gz ...,
/// and truth/instances.csv for all. Instances are numbered over the city. The files of a district are the same
/// whichever other districts are written, and for every number of threads. Memory: one district and what lies around
/// it, and rows of instances that later scans may add to. Errors as of writeCampus; InvalidArgument for a range that
/// the city does not have.
CampusSummary writeCity(const City& city, const DistrictRange& range, const std::filesystem::path& folder,
                        unsigned threads, ProgressSink& sink);

}  // namespace cluxel::simulation
