// SPDX-License-Identifier: Apache-2.0
// Tests that the districts of a city fit together, and that each is the same whichever others are made.
#include "simulation/site/city.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <map>
#include <set>
#include <sstream>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "scan/scan_set.hpp"
#include "scan/truth/truth.hpp"
#include "simulation/campus_fixture.hpp"
#include "simulation/laser/city_writer.hpp"
#include "simulation/site/site_plan.hpp"

namespace cluxel::simulation {

using namespace scan;
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d, Eigen::Vector3d;

CityParams smallCity(std::size_t columns, std::size_t rows) {
  CityParams params{.district = test::smallCampus(3), .columns = columns, .rows = rows};
  params.district.stops = 3;
  params.district.points_per_stop = 6'000;
  return params;
}

/// A temporary folder that is removed after the test.
class CityFolder : public testing::Test {
 protected:
  CityFolder()
      : folder_(fs::temp_directory_path() /
                (std::string("cluxel_city_") + testing::UnitTest::GetInstance()->current_test_info()->name() + "_" +
                 std::to_string(::getpid()))) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~CityFolder() override { fs::remove_all(folder_); }

  CampusSummary write(const std::string& name, const CityParams& params, const DistrictRange& range,
                      unsigned threads = 1) {
    return writeCity(City(params), range, folder_ / name, threads, sink_);
  }
  std::map<std::string, std::string> bytesOf(const std::string& name) const {
    std::map<std::string, std::string> bytes;
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / name))
      if (entry.is_regular_file()) bytes[fs::relative(entry.path(), folder_ / name).string()] = readFile(entry.path());
    return bytes;
  }
  /// Points of each instance in the truth files of a city.
  std::map<int, std::size_t> pointsOfInstances(const std::string& name) {
    std::map<int, std::size_t> points;
    for (const auto& entry : fs::directory_iterator(folder_ / name)) {
      if (entry.path().filename() == "truth") continue;
      const ScanSet set = ScanSet::open({entry.path()}, {}, sink_);
      for (std::size_t i = 0; i < set.size(); ++i) {
        const auto file = truthFileOf(folder_ / name / "truth", set.file(i).path);
        for (const int id : truthFromFile(file.value(), set.load(i).points.size()).instance)
          if (id >= 0) ++points[id];
      }
    }
    return points;
  }

  fs::path folder_;
  ProgressSink sink_;
};

TEST_F(CityFolder, ADistrictHasTheSameFilesAloneAndWithinTheCityAndWithTwoThreads) {
  const CityParams params = smallCity(2, 2);
  write("all", params, {0, 3});
  write("alone", params, {2, 2}, 2);
  const auto all = bytesOf("all"), alone = bytesOf("alone");
  EXPECT_EQ(all.size(), 4U * (2 * 3 + 3) + 1);
  EXPECT_EQ(alone.size(), 2U * 3 + 3 + 1);
  for (const auto& [name, bytes] : alone) EXPECT_TRUE(name == "truth/instances.csv" || all.at(name) == bytes) << name;
  EXPECT_NE(all.at("district_0000/scan_0000_000.pcd"), all.at("district_0001/scan_0001_000.pcd"));
}

TEST_F(CityFolder, TheTableHasOneRowForEachInstanceWithTheTruthsPoints) {
  const CampusSummary summary = write("city", smallCity(2, 3), {0, 5});
  std::istringstream table(readFile(folder_ / "city" / "truth" / "instances.csv"));
  std::string line;
  std::getline(table, line);
  std::map<int, std::size_t> listed;
  int last = -1;
  while (std::getline(table, line)) {
    std::istringstream row(line);
    std::string id, object, count;
    std::getline(row, id, ',');
    std::getline(row, object, ',');
    std::getline(row, count, ',');
    EXPECT_GT(std::stoi(id), last) << "rows are sorted, none comes twice";
    last = std::stoi(id);
    listed[last] = std::stoul(count);
  }
  EXPECT_EQ(listed, pointsOfInstances("city"));
  EXPECT_EQ(summary.objects, listed.size());
  EXPECT_EQ(summary.scans, 18U);
}

TEST_F(CityFolder, ScansOfTwoDistrictsPutASharedObjectAtOnePlace) {
  CityParams exact = smallCity(2, 1);
  exact.district = test::withoutNoise(exact.district);
  const City city(exact);
  write("city", exact, {0, 1});
  std::map<int, std::set<std::size_t>> seen_from;
  for (std::size_t number = 0; number < 2; ++number) {
    const District district = city.district(number);
    const ScanSet set = ScanSet::open({folder_ / "city" / ("district_000" + std::to_string(number))}, {}, sink_);
    for (std::size_t i = 0; i < set.size(); ++i) {
      const Scan scan = set.load(i);
      const auto file = truthFileOf(folder_ / "city" / "truth", set.file(i).path);
      const PointTruth truth = truthFromFile(file.value(), scan.points.size());
      for (std::size_t p = 0; p < scan.points.size(); ++p) {
        if (truth.instance[p] < 0) continue;
        seen_from[truth.instance[p]].insert(number);
        const Vector3d p_district = toMap(scan.T_map_sensor, {scan.points.x[p], scan.points.y[p], scan.points.z[p]}) -
                                    district.place.origin_map;
        ASSERT_LT(district.objects.at(truth.instance[p]).box.exteriorDistance(p_district), 0.001);
      }
    }
  }
  const auto shared = std::count_if(seen_from.begin(), seen_from.end(), [](const auto& seen) {
    return seen.first % 100'000 != 0 && seen.second.size() == 2;
  });
  EXPECT_GT(shared, 3) << "objects that scans of both districts see";
}

TEST(City, DistrictsKeepToTheirSquaresButForCrownsThatHangOver) {
  const City city(smallCity(4, 2));
  for (std::size_t number = 0; number < city.size(); ++number) {
    const District district = city.district(number);
    const double half = district.campus.params.size_m / 2 + SitePlan::kMargin_m;
    for (const CampusMesh& mesh : district.campus.meshes) {
      const bool is_crown = mesh.label == SurfaceLabel::TreeTop || mesh.label == SurfaceLabel::TreeBranch;
      for (const Eigen::Vector3f& vertex : mesh.vertices) {
        const Vector2d plan =
            Eigen::Rotation2Dd(-district.campus.heading_rad) * Vector2d(vertex.cast<double>().head<2>());
        ASSERT_LT(plan.cwiseAbs().maxCoeff(), half + (is_crown ? kMaxOverhang_m : 0.01)) << infoOf(mesh.label).name;
      }
    }
  }
}

TEST(City, TheTerrainGoesOnAcrossABorder) {
  const City city(smallCity(3, 2));
  const District a = city.district(1), b = city.district(5);
  for (const Vector2d& place : {Vector2d(70, -20), Vector2d(0, 0), Vector2d(-31, 118)}) {
    const Vector2d in_a = place - a.place.origin_map.head<2>(), in_b = place - b.place.origin_map.head<2>();
    EXPECT_NEAR(a.place.origin_map.z() + a.campus.terrain.heightAt(in_a.x(), in_a.y()),
                b.place.origin_map.z() + b.campus.terrain.heightAt(in_b.x(), in_b.y()), 1e-9);
  }
}

TEST(City, NoScanSeesADistrictThatIsSaidToBeUnseen) {
  CityParams params = smallCity(5, 3);
  params.district.max_range_m = 110;
  const City city(params);
  bool reaches_far = false;
  for (const std::size_t number : {0, 2, 7, 14}) {
    for (const auto& [id, object] : city.district(number).objects) {
      const auto home = static_cast<std::size_t>(id) / 100'000;
      ASSERT_GE(city.lastToSee(home), number);
      reaches_far |= home % 5 + 1 < number % 5;  // stops begin in the west
    }
  }
  EXPECT_TRUE(reaches_far) << "with this range scans see over the next district";
}

TEST(City, RefusesWhatItCannotBe) {
  const auto messageOf = [](const CityParams& params) -> std::string {
    try {
      const City city(params);
      city.district(city.size());
      return "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::InvalidArgument);
      return error.what();
    }
  };
  EXPECT_THAT(messageOf(smallCity(0, 2)), testing::HasSubstr("0 columns of districts: choose 1 to 100"));
  EXPECT_THAT(messageOf(smallCity(2, 101)), testing::HasSubstr("101 rows"));
  EXPECT_THAT(messageOf(smallCity(2, 2)), testing::HasSubstr("there is no district 4"));
  CityParams visited = smallCity(1, 1);
  visited.district.visits = 2;
  EXPECT_THAT(messageOf(visited), testing::HasSubstr("visited once"));
  visited.district.visits = 1, visited.district.pose_error_m = 0.05;
  EXPECT_THAT(messageOf(visited), testing::HasSubstr("visited once"));
}

TEST_F(CityFolder, RefusesDistrictsThatAreNotThere) {
  for (const DistrictRange& range : {DistrictRange{0, 4}, DistrictRange{2, 1}}) {
    try {
      write("none", smallCity(2, 2), range);
      FAIL() << "wrote " << range.first << ".." << range.last;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::InvalidArgument);
      EXPECT_THAT(error.what(), testing::HasSubstr("numbered 0..3"));
    }
    EXPECT_FALSE(fs::exists(folder_ / "none"));
  }
}

}  // namespace
}  // namespace cluxel::simulation
