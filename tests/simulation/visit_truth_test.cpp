// SPDX-License-Identifier: Apache-2.0
// The points that a visit measures on things, as the truth states them, against those of the generated scans.
#include "simulation/laser/visit_truth.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "rdf/scratch_folder.hpp"
#include "simulation/campus_fixture.hpp"

namespace cluxel::simulation {
namespace {

using InstanceAndVisit = std::pair<std::int32_t, std::size_t>;

/// The points of visits.csv, of what is there.
std::map<InstanceAndVisit, std::size_t> statedPoints(const std::filesystem::path& table) {
  std::ifstream file(table);
  std::map<InstanceAndVisit, std::size_t> points;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::vector<std::string> cells;
    std::stringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
    if (cells.at(3) == "1") points[{std::stoi(cells[0]), std::stoul(cells[2])}] = std::stoul(cells.at(4));
  }
  return points;
}

TEST(VisitTruth, StatesThePointsThatScansMeasure) {
  CampusParams params = test::smallCampus(12);
  params.later_stops = 1;
  params.points_per_stop = 20'000;
  const VisitedSite site = visitSite(buildCampus(params), 2);
  const rdf::ScratchFolder folder;
  writeVisitTruth(site, folder.path(), 2);
  std::map<InstanceAndVisit, std::size_t> measured;
  for (std::size_t visit = 0; visit < 2; ++visit)
    for (const SimulatedScan& scan : test::scanAll(site.visits[visit]))
      for (const std::int32_t instance : scan.truth.instance) ++measured[{instance, visit}];

  std::size_t unseen = 0, seen = 0;
  double stated = 0, total = 0;
  for (const auto& [key, points] : statedPoints(folder.path() / "visits.csv")) {
    const std::size_t found = measured[key];
    // Beams have a width, so that a few rays measure what no middle of a ray reaches.
    if (points == 0) {
      ++unseen;
      EXPECT_LE(found, 2U) << "instance " << key.first << ", visit " << key.second;
    }
    if (points < 50) continue;
    ++seen;
    stated += static_cast<double>(points), total += static_cast<double>(found);
  }
  EXPECT_GT(total, 0.9 * stated);
  EXPECT_LT(total, 1.1 * stated);
  EXPECT_GE(unseen, 5U);
  EXPECT_GE(seen, 20U);
}

}  // namespace
}  // namespace cluxel::simulation
