// SPDX-License-Identifier: Apache-2.0
// Where sensors stood, told by poses and told by the origins of rays: maps of the same rays tell the same.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "mapping/clouds/ray_starts.hpp"
#include "mapping/small_campus.hpp"
#include "sparql/query_engine.hpp"
#include "tasks/search/search_field.hpp"
#include "tasks/search/search_tour.hpp"
#include "tasks/view/view_values.hpp"

namespace cluxel::tasks {

using namespace mapping;

namespace {

using Places = std::vector<Eigen::Vector3d>;

constexpr double kEqual_m = 1e-3;

/// The scans of two stops in maps that differ in what tells where the sensor stood.
class RayOrigins : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = new ScratchFolder;
    const SmallCampus campus({.seed = 5, .stops = 2, .size_m = 50, .points_per_stop = 6000});
    std::vector<Scan> posed, shifted, unposed{{}, {}};
    Scan joined;
    for (std::size_t i = 0; i < campus.scans().size(); ++i) {
      const Scan& scan = campus.scans()[i].scan;
      sensors.emplace_back(scan.T_map_sensor.translation());
      posed.push_back(scan);
      posed.back().points.origin.clear();
      shifted.push_back(seenFrom(posed.back(), {64, 32, 0}));
      addInMapFrame(posed.back(), unposed[i]);
      addInMapFrame(posed.back(), joined);
    }
    write("posed", posed), write("shifted", shifted), write("unposed", unposed), write("joined", {joined});
    for (Scan& scan : unposed) scan.points.origin.clear();
    Scan first = posed.front();
    first.T_map_sensor.setIdentity(), first.has_pose = false;
    first.points.origin.assign(first.points.size(), Eigen::Vector3f::Zero());
    write("first", {first});
    write("unknown", unposed);
  }
  static void TearDownTestSuite() {
    delete folder;
    sensors.clear();
  }

  static MapReader mapOf(const std::string& name) { return MapReader(folder->path() / (name + ".clx")); }
  static Places startsIn(const std::string& name) {
    const MapReader map = mapOf(name);
    Places starts;
    for (const Cloud& cloud : map.clouds())
      for (const Eigen::Vector3d& start : rayStartsOf(map.transaction(), cloud)) starts.push_back(start);
    return starts;
  }
  /// The numbers of the SELECT query's rows.
  static Places placesBy(const MapReader& map, const std::string& query) {
    const sparql::ResultTable table =
        sparql::evaluateQuery(map.quads(), "PREFIX clx: <" + std::string(vocabulary::kClx) + "> " + query).table;
    Places places(table.row_count);
    for (std::size_t row = 0; row < table.row_count; ++row)
      for (const int axis : {0, 1, 2}) places[row][axis] = std::stod(table.at(row, axis)->text);
    return places;
  }
  /// Whether both have the same places in any order.
  static bool areAlike(const Places& some, const Places& others) {
    const auto is_among = [&](const Eigen::Vector3d& place) {
      return std::any_of(others.begin(), others.end(),
                         [&](const Eigen::Vector3d& other) { return (other - place).norm() < kEqual_m; });
    };
    return some.size() == others.size() && std::all_of(some.begin(), some.end(), is_among);
  }
  /// Per cell of the map of poses, what another map knows.
  static LargeArray<float> knownIn(const std::string& name) {
    static const MapReader posed = mapOf("posed");
    static const TerrainGrid terrain = terrainOf(posed);
    static const SightGrid sight = sightOf(posed, terrain, std::vector<bool>(posed.objects().size()), 1.2);
    return knownShare(mapOf(name), terrain, sight, {.view_m = 5});
  }

  static inline ScratchFolder* folder = nullptr;
  static inline Places sensors;

 private:
  /// The same rays with the pose `aside` of where they start, in the frame of the sensor.
  static Scan seenFrom(Scan scan, const Eigen::Vector3f& aside) {
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      scan.points.x[i] += aside.x(), scan.points.y[i] += aside.y(), scan.points.z[i] += aside.z();
      scan.points.origin.push_back(aside);
    }
    scan.T_map_sensor.translate(-aside.cast<double>());
    return scan;
  }
  static void addInMapFrame(const Scan& scan, Scan& all) {
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      const Eigen::Vector3d at = toMap(scan.T_map_sensor, {scan.points.x[i], scan.points.y[i], scan.points.z[i]});
      all.points.x.push_back(static_cast<float>(at.x()));
      all.points.y.push_back(static_cast<float>(at.y()));
      all.points.z.push_back(static_cast<float>(at.z()));
      all.points.origin.emplace_back(scan.T_map_sensor.translation().cast<float>());
    }
  }
  static void write(const std::string& name, const std::vector<Scan>& scans) {
    std::ofstream manifest(folder->path() / (name + ".yaml"));
    manifest << "scans:\n";
    for (std::size_t i = 0; i < scans.size(); ++i) {
      const std::string file = name + std::to_string(i) + ".pcd";
      writeScanFile(scans[i], folder->path() / file);
      manifest << "  - {path: " << file << ", time_s: " << 1600000000 + 100 * i << "}\n";
    }
    manifest.close();
    buildMap(scansOf({folder->path() / (name + ".yaml")}), shippedInputs(), folder->path() / (name + ".clx"), {},
             silence());
  }
};

TEST_F(RayOrigins, TellWhereRaysStart) {
  for (const char* name : {"posed", "shifted", "unposed", "joined"})
    EXPECT_TRUE(areAlike(startsIn(name), sensors)) << name;
  EXPECT_TRUE(areAlike(startsIn("first"), {Eigen::Vector3d::Zero()})) << "the sensor defines the frame";
  EXPECT_TRUE(startsIn("unknown").empty());
}

TEST_F(RayOrigins, TellWhereTheSensorStoodAtLast) {
  for (const char* name : {"posed", "shifted", "unposed", "joined"})
    EXPECT_LT((lastStop(mapOf(name)) - sensors.back().head<2>()).norm(), kEqual_m) << name;
  EXPECT_THROW(lastStop(mapOf("unknown")), Error);
}

TEST_F(RayOrigins, TellWhatTheMapKnows) {
  const LargeArray<float> known = knownIn("posed");
  EXPECT_GT(std::count(known.begin(), known.end(), 0.0F), 100) << "not all was seen";
  EXPECT_GT(std::count_if(known.begin(), known.end(), [](float share) { return share > 0.5F; }), 100);
  for (const char* name : {"shifted", "unposed", "joined"}) {
    const LargeArray<float> other = knownIn(name);
    std::size_t different = 0;
    for (std::size_t i = 0; i < known.size(); ++i) different += std::abs(known[i] - other[i]) > 0.01F ? 1 : 0;
    EXPECT_LE(different, known.size() / 500) << name << ": more than rounding of points makes";
  }
}

TEST_F(RayOrigins, FactsAndTheViewTellThePlaceOfTheSensor) {
  const std::string query = "SELECT ?x ?y ?z { ?cloud a clx:Cloud ; clx:x ?x ; clx:y ?y ; clx:z ?z }";
  for (const char* name : {"posed", "shifted", "unposed"}) {
    const MapReader map = mapOf(name);
    EXPECT_TRUE(areAlike(placesBy(map, query), sensors)) << name;
    Places shown;
    const auto page = nlohmann::json::parse(mapValuesJson(map, {}, 0, {}, {}));
    for (const auto& cloud : page.at("clouds"))
      shown.emplace_back(cloud.at("position").get<std::vector<double>>().data());
    EXPECT_TRUE(areAlike(shown, sensors)) << name;
  }
  EXPECT_TRUE(areAlike(placesBy(mapOf("first"), query), {Eigen::Vector3d::Zero()}));
  for (const char* name : {"joined", "unknown"}) EXPECT_TRUE(placesBy(mapOf(name), query).empty()) << name;
}

}  // namespace
}  // namespace cluxel::tasks
