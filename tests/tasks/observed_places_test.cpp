// SPDX-License-Identifier: Apache-2.0
// Which places count as observed, against what is true of generated sites.
#include "tasks/inventory/observed_places.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "base/file_bytes.hpp"
#include "mapping/regions/ground_heights.hpp"
#include "mapping/regions/tile_objects.hpp"
#include "mapping/stored_grid.hpp"
#include "tasks/ask/inventory_task.hpp"
#include "tasks/box_visits.hpp"
#include "tasks/campus_map_fixture.hpp"

namespace cluxel::tasks {
namespace {

constexpr double kView_m = 25;

/// The campus of CampusMap, made again for its truth.
const Campus& campusOfMap() {
  static const Campus campus = buildCampus({.seed = 3, .stops = 4, .size_m = 60, .points_per_stop = 40'000});
  return campus;
}

enum class Sight { Free, Hidden, Partly };

/// Whether straight lines from the sensor to the lowest metre at a place, and beside it, are free. Nothing is hidden by
/// leaves, through which rays pass.
Sight sightOfPlace(const Campus& campus, const Laser& laser, const Eigen::Vector3d& sensor,
                   const Eigen::Vector3d& foot) {
  int free = 0, hidden = 0, lines = 0;
  const Eigen::Vector3d across = (foot - sensor).cross(Eigen::Vector3d::UnitZ()).normalized();
  for (const double beside_m : {-0.7, -0.5, -0.3, -0.15, 0.0, 0.15, 0.3, 0.5, 0.7})
    for (const double above_m : {-0.3, -0.1, 0.1, 0.3, 0.5, 0.7, 0.9, 1.1, 1.3, 1.5, 1.7}) {
      const Eigen::Vector3d way = foot + Eigen::Vector3d(0, 0, above_m) + beside_m * across - sensor;
      const auto hit = laser.cast(sensor, way.normalized());
      ++lines;
      hidden += hit && campus.meshes[hit->mesh].transparency == 0 && hit->range_m < way.norm() - 1 ? 1 : 0;
      free += above_m < 0.25 || !hit || hit->range_m > way.norm() + 0.5 ? 1 : 0;
    }
  return free == lines ? Sight::Free : hidden == lines ? Sight::Hidden : Sight::Partly;
}

/// Rays of the truth's own laser tell, without the map, its scans or their noise.
TEST(QuestionsOfACampus, PlacesAreObservedWhereTheTruthHasFreeSight) {
  constexpr double surely_m = 15;  // there the scans have three rays or more
  const MapReader& map = CampusMap::shared().map();
  const Campus& campus = campusOfMap();
  const Laser laser(campus);
  std::mt19937 random(8);
  std::uniform_real_distribution<double> anywhere(-40, 40);
  std::vector<AskedPlace> places;
  for (int i = 0; i < 800; ++i) places.push_back({{anywhere(random), anywhere(random)}, 1});
  const std::vector<bool> is_observed = observedPlaces(map, places, kView_m);
  std::map<std::string, std::size_t> counts;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Eigen::Vector2d at = places[i].at;
    const Eigen::Vector3d foot(at.x(), at.y(), campus.terrain.heightAt(at.x(), at.y()));
    bool is_free = false, is_hidden = true;
    for (const Eigen::Isometry3d& stop : campus.stops) {
      const double distance_m = (stop.translation() - foot).head<2>().norm();
      if (distance_m > kView_m + 0.1) continue;
      const Sight sight = sightOfPlace(campus, laser, stop.translation(), foot);
      is_free = is_free || (sight == Sight::Free && distance_m > 2 && distance_m < surely_m);
      is_hidden = is_hidden && sight == Sight::Hidden;
    }
    EXPECT_TRUE(!is_free || is_observed[i]) << "nothing hides " << at.transpose();
    EXPECT_TRUE(!is_hidden || !is_observed[i]) << at.transpose() << " is hidden or far away";
    ++counts[is_free ? "free" : is_hidden ? "hidden" : "partly"];
  }
  EXPECT_GT(counts["free"], 60U);
  EXPECT_GT(counts["hidden"], 60U);
}

TEST(QuestionsOfACampus, MeasuredPlacesAreObserved) {
  const MapReader& map = CampusMap::shared().map();
  std::vector<AskedPlace> places;
  for (const Cloud& cloud : map.clouds()) {
    const scan::Scan scan = map.scanOf(cloud.id);
    for (std::size_t i = 0; i < scan.points.size(); i += 997) {
      const Eigen::Vector3d p = scan::toMap(scan.T_map_sensor, {scan.points.x[i], scan.points.y[i], scan.points.z[i]});
      const double range_m = (p - scan.T_map_sensor.translation()).head<2>().norm();
      const auto height_m = groundHeightsAt(map, std::vector{Eigen::Vector2d(p.head<2>())})[0];
      if (range_m < kView_m && height_m && std::abs(p.z() - *height_m) < 0.1) places.push_back({p.head<2>(), 1});
    }
  }
  ASSERT_GT(places.size(), 40U);
  const std::vector<bool> is_observed = observedPlaces(map, places, kView_m);
  EXPECT_EQ(std::count(is_observed.begin(), is_observed.end(), false), 0);
}

TEST(QuestionsOfACampus, GroundHeightsAreThoseOfTheGround) {
  const MapReader& map = CampusMap::shared().map();
  const auto ground = mapping::groundOfTiles(map);
  const TileGrid grid = mapping::storedGrid(map.transaction());
  std::vector<Eigen::Vector2d> places{{5000, 5000}, {1e300, 0}, {0, -1e300}};
  for (const auto& [tile, heights] : ground)
    for (const double share : {0.01, 0.37, 0.99})
      places.emplace_back(grid.cornerOf(tile).head<2>() + kTileSize_m * Eigen::Vector2d(share, 1 - share));
  const auto found = groundHeightsAt(map, places);
  for (std::size_t i = 0; i < places.size(); ++i) {
    ASSERT_EQ(found[i].has_value(), i >= 3) << i;
    if (i < 3) continue;
    const TileKey tile = grid.tileOf({places[i].x(), places[i].y(), 0});
    const Eigen::Vector2d local = places[i] - grid.cornerOf(tile).head<2>();
    EXPECT_EQ(*found[i], grid.corner().z() + groundHeightAt(ringIn(ground, tile), local.x(), local.y()));
  }
  const TileKey east = ground.rbegin()->first;
  const Eigen::Vector2d beyond = grid.cornerOf(east).head<2>() + Eigen::Vector2d(kTileSize_m + 3, 8);
  const auto outside = groundHeightsAt(map, std::vector{beyond})[0];
  ASSERT_TRUE(outside);
  EXPECT_NEAR(*outside, *groundHeightsAt(map, std::vector<Eigen::Vector2d>{beyond - Eigen::Vector2d(3.01, 0)})[0], 0.5);
}

/// Two houses and a wall of 1.2 m before one of them; a bin stands on the first visit only, a cabin on both.
class PlacesBesideAHouse : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const Box house = boxFrom({-6, 8, 0}, {6, 14, 6}), other = boxFrom({-6, -16, 0}, {6, -12, 6});
    const Box wall = boxFrom({-6, -6.3, 0}, {6, -6, 1.2});
    const Box bin = boxFrom({7.6, 2.6, 0}, {8.4, 3.4, 1.1}), cabin = boxFrom({-10, 2, 0}, {-8, 4, 2});
    const std::vector<Eigen::Vector3d> sensors{{-2, 0, 1.8}, {3, 0.5, 1.8}};
    folder = new rdf::ScratchFolder;
    writeVisits({{{house, other, wall, bin, cabin}, sensors}, {{house, other, wall, cabin}, sensors}},
                folder->path() / "scans");
    buildMap(scansOf({folder->path() / "scans"}), shippedInputs(), folder->path() / "map.clx", {}, silence());
  }
  static void TearDownTestSuite() { delete folder; }

  /// The status of each entry by its id.
  static std::map<std::string, std::string> statuses(const std::string& lines, const RegisterParams& params) {
    const MapReader map(folder->path() / "map.clx");
    const auto file = folder->path() / "register.csv";
    writeFile(file, "id,class,x,y,height\n" + lines);
    const auto entries = readRegister(file, map.inputs(), ontologyViewOf(map.quads()));
    std::map<std::string, std::string> found;
    for (const TaskRow& row : registerAnswer(map, {}, entries, params).rows)
      if (const auto* id = std::get_if<std::string>(&row.cells[1])) found[*id] = std::get<std::string>(row.cells[0]);
    return found;
  }

  inline static rdf::ScratchFolder* folder = nullptr;
};

TEST_F(PlacesBesideAHouse, TellWhatIsMissingFromWhatIsHidden) {
  const std::string lines =
      "left,UtilityPole,8,3,\n"       // the bin stood there
      "never,UtilityPole,10,-3,\n"    // rays pass
      "stands,UtilityPole,-8,3,\n"    // in the edge of the cabin
      "behind,UtilityPole,0,17,\n"    // behind the house
      "inside,UtilityPole,0,11,\n"    // in it
      "low,UtilityPole,0,-7.5,0.6\n"  // behind the wall
      "high,UtilityPole,0,-7.5,4\n"   // looks over it
      "far,UtilityPole,-27.2,0,\n";   // measured, but not from near enough
  const std::map<std::string, std::string> expected{{"left", "missing in the map"},   {"never", "missing in the map"},
                                                    {"stands", "missing in the map"}, {"behind", "not observed"},
                                                    {"inside", "not observed"},       {"low", "not observed"},
                                                    {"high", "missing in the map"},   {"far", "not observed"}};
  EXPECT_EQ(statuses(lines, {.within_m = 0.5}), expected);
  EXPECT_EQ(statuses("far,UtilityPole,-27.2,0,\n", {.within_m = 0.5, .view_m = 35}).at("far"), "missing in the map");
  EXPECT_EQ(statuses("left,UtilityPole,8,3,\n", {.within_m = 0.5, .view_m = 4}).at("left"), "not observed");
}

TEST(Register, HeightsAreThoseOfTheEntryThenOfItsClassInTheMap) {
  const auto thing = [](double height_m) {
    RegisterItem item;
    item.thing.height_m = height_m;
    item.classes = {"Lamp"};
    return item;
  };
  const std::vector<RegisterItem> items{thing(4), thing(kNotMeasured), thing(9), thing(5)};
  const std::vector<RegisterEntry> entries{
      {"1", "Lamp", {0, 0}, 7.0}, {"2", "Lamp", {0, 0}, {}}, {"3", "Bin", {0, 0}, {}}};
  EXPECT_EQ(heightsOf(entries, items), (std::vector<double>{7, 5, 1}));
}

/// Scans without poses tell of the places around their points.
TEST(ObservedPlaces, OfScansWithoutPosesAreThoseBesideTheirPoints) {
  const rdf::ScratchFolder folder;
  std::string points;
  for (double x = 0; x < 12; x += 0.2)
    for (double y = 0; y < 12; y += 0.2) points += std::to_string(x) + " " + std::to_string(y) + " 0.0\n";
  writeFile(folder.path() / "plane.xyz", points);
  buildMap(scansOf({folder.path() / "plane.xyz"}), shippedInputs(), folder.path() / "map.clx", {}, silence());
  const MapReader map(folder.path() / "map.clx");
  ASSERT_FALSE(map.clouds().front().has_pose);
  EXPECT_EQ(observedPlaces(map, {{{6, 6}, 1}, {{12.5, 6}, 1}, {{14.5, 6}, 1}}, kView_m),
            (std::vector<bool>{true, true, false}));
}

}  // namespace
}  // namespace cluxel::tasks
