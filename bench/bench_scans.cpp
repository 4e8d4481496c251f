// SPDX-License-Identifier: Apache-2.0
// Loads Oakland or generates a campus.
#include "bench_scans.hpp"

#include <cstdio>
#include <cstdlib>

#include "scan/scan_set.hpp"
#include "simulation/laser/laser.hpp"
#include "simulation/site/campus.hpp"

namespace cluxel::bench {

namespace {

std::vector<scan::Scan> loadScans(const std::vector<std::filesystem::path>& inputs) {
  ProgressSink sink;
  const scan::ScanSet set = scan::ScanSet::open(inputs, {}, sink);
  std::vector<scan::Scan> scans;
  for (std::size_t i = 0; i < set.size(); ++i) scans.push_back(set.load(i));
  return scans;
}

std::vector<scan::Scan> generatedScans() {
  const simulation::Campus campus = simulation::buildCampus({.seed = 1, .stops = 6});
  const simulation::Laser laser(campus);
  std::vector<scan::Scan> scans;
  for (std::size_t stop = 0; stop < campus.stops.size(); ++stop) scans.push_back(laser.scanAt(stop).scan);
  return scans;
}

}  // namespace

std::filesystem::path sourceFolder() {
  return CLUXEL_SOURCE_DIR;
}

std::vector<scan::Scan> scansFor(const std::vector<std::filesystem::path>& inputs) {
  if (!inputs.empty()) return loadScans(inputs);
  const std::filesystem::path source = sourceFolder();
  const char* given = std::getenv("CLUXEL_DATA");
  const auto oakland = (given != nullptr ? std::filesystem::path(given) : source / "../shared/data") / "oakland3d";
  if (std::filesystem::exists(oakland)) {
    std::printf("Oakland 3-D, part 2: ");
    return loadScans({oakland});
  }
  std::printf("outside data absent, a generated campus instead: ");
  return generatedScans();
}

}  // namespace cluxel::bench
