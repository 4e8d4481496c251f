// SPDX-License-Identifier: Apache-2.0
// The points that a visit measures on things, as the truth states them, against those of the generated scans.
#include "simulation/laser/visit_truth.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <set>
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
  params.visits = 2, params.later_stops = 1;
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

TEST(VisitTruth, CountsWhatIsLeftOfBushesThatWereCut) {
  CampusParams params = test::smallCampus(7);
  params.size_m = 60;
  const VisitedSite site = visitSite(buildCampus(params), 3);
  const rdf::ScratchFolder folder;
  writeVisitTruth(site, folder.path(), 2);
  auto stated = statedPoints(folder.path() / "visits.csv");
  std::map<InstanceAndVisit, std::size_t> measured;
  for (std::size_t visit = 0; visit < site.visits.size(); ++visit)
    for (const SimulatedScan& scan : test::scanAll(site.visits[visit]))
      for (const std::int32_t instance : scan.truth.instance) ++measured[{instance, visit}];
  std::size_t bushes = 0;
  for (const SiteEvent& event : site.events) {
    if (event.kind != SiteEventKind::Cut) continue;
    for (std::size_t visit = 0; visit < site.visits.size(); ++visit) {
      const auto found = static_cast<double>(measured[{event.instance, visit}]);
      const auto expected = static_cast<double>(stated[{event.instance, visit}]);
      EXPECT_NEAR(expected, found, 15 + 0.25 * found) << "bush " << event.instance << ", visit " << visit;
    }
    ++bushes;
  }
  EXPECT_GT(bushes, 1U);
}

/// The points that the second visit measures on things that its vans hide, by instance.
std::map<std::int32_t, std::size_t> pointsOnHiddenThings(const VisitedSite& site,
                                                         const std::set<std::int32_t>& hidden) {
  std::map<std::int32_t, std::size_t> points;
  for (const SimulatedScan& scan : test::scanAll(site.visits[1]))
    for (const std::int32_t instance : scan.truth.instance)
      if (hidden.contains(instance)) ++points[instance];
  return points;
}

TEST(VisitTruth, VansHideWhatStandsBehindThem) {
  CampusParams params = test::smallCampus(41);
  params.size_m = 100;
  params.stops = 12;
  VisitedSite site = visitSite(buildCampus(params), 2);
  std::set<std::int32_t> hidden, vans;
  for (const SiteEvent& event : site.events)
    if (event.kind == SiteEventKind::Hidden) hidden.insert(event.instance), vans.insert(event.new_instance);
  ASSERT_GE(hidden.size(), 3U);
  const auto sumOf = [](const std::map<std::int32_t, std::size_t>& points) {
    std::size_t sum = 0;
    for (const auto& [instance, count] : points) sum += count;
    return sum;
  };
  const std::size_t behind_vans = sumOf(pointsOnHiddenThings(site, hidden));
  std::erase_if(site.visits[1].meshes, [&](const CampusMesh& mesh) { return vans.contains(mesh.instance); });
  const std::size_t in_the_open = sumOf(pointsOnHiddenThings(site, hidden));
  EXPECT_GT(in_the_open, 200U);
  EXPECT_LT(behind_vans, in_the_open / 3);
}

}  // namespace
}  // namespace cluxel::simulation
