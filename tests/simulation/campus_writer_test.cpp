// SPDX-License-Identifier: Apache-2.0
// The output of `cluxel simulate`: identical bytes in every run, and readable by the module scan.
#include "simulation/laser/campus_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "scan/scan_set.hpp"
#include "scan/truth/truth.hpp"
#include "simulation/campus_fixture.hpp"
#include "test_paths.hpp"

namespace cluxel::simulation {

using namespace scan;
namespace {

namespace fs = std::filesystem;

/// A temporary folder that is removed after the test.
class CampusWriter : public testing::Test {
 protected:
  CampusWriter()
      : folder_(fs::temp_directory_path() /
                (std::string("cluxel_campus_") + testing::UnitTest::GetInstance()->current_test_info()->name() + "_" +
                 std::to_string(::getpid()))) {
    fs::remove_all(folder_);
  }
  ~CampusWriter() override { fs::remove_all(folder_); }

  static CampusParams params() {
    CampusParams params = test::smallCampus(7);
    params.points_per_stop = 15'000;
    return params;
  }
  CampusSummary write(const std::string& name, unsigned threads, const CampusParams& params) {
    return writeCampus(buildCampus(params), folder_ / name, threads, sink_);
  }
  std::map<std::string, std::string> bytesOf(const std::string& name) const {
    std::map<std::string, std::string> bytes;
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / name))
      if (entry.is_regular_file()) bytes[fs::relative(entry.path(), folder_ / name).string()] = readFile(entry.path());
    return bytes;
  }

  fs::path folder_;
  ProgressSink sink_;
};

TEST_F(CampusWriter, WritesTheSameBytesWithOneAndTwoThreadsAndAgain) {
  fs::create_directories(folder_);
  write("one", 1, params());
  write("two", 2, params());
  write("again", 2, params());
  EXPECT_EQ(bytesOf("one").size(), 4U * 2 + 4);
  EXPECT_EQ(bytesOf("one"), bytesOf("two"));
  EXPECT_EQ(bytesOf("two"), bytesOf("again"));
}

/// The maximum distance between two poses with the same number [m].
double farthest(const ScanSet& a, const ScanSet& b) {
  double farthest_m = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    farthest_m =
        std::max(farthest_m, (a.file(i).T_map_sensor.translation() - b.file(i).T_map_sensor.translation()).norm());
  return farthest_m;
}

TEST_F(CampusWriter, PosesThatDriftStandBesideTheTrueOnesAndThePointsAreTheSame) {
  CampusParams drifting = params();
  drifting.laser = LaserKind::Spinning;
  drifting.stop_distance_m = 1;
  CampusParams right = drifting;
  drifting.drift_m = 0.1;
  write("drifting", 1, drifting);
  write("right", 1, right);
  const ScanSet stated = ScanSet::open({folder_ / "drifting"}, {}, sink_),
                truth = ScanSet::open({folder_ / "right"}, {}, sink_);
  const ScanSet beside = ScanSet::open({folder_ / "drifting"}, {.poses = folder_ / "drifting/true_poses.txt"}, sink_);
  EXPECT_EQ(farthest(beside, truth), 0);
  EXPECT_EQ(stated.file(0).T_map_sensor.matrix(), truth.file(0).T_map_sensor.matrix()) << "the first one is right";
  EXPECT_GT(farthest(stated, truth), 0.5 * 3 * 0.1);
  EXPECT_LT(farthest(stated, truth), 2 * 3 * 0.1);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(stated.load(i).id, truth.load(i).id);
  EXPECT_EQ(bytesOf("drifting").at("truth/instances.csv"), bytesOf("right").at("truth/instances.csv"));
  EXPECT_FALSE(fs::exists(folder_ / "right/true_poses.txt"));
}

TEST_F(CampusWriter, ASpinningLaserSeesInRings) {
  CampusParams spinning = params();
  spinning.laser = LaserKind::Spinning;
  spinning.range_sigma_m = 0;
  write("rings", 1, spinning);
  const Scan scan = ScanSet::open({folder_ / "rings"}, {}, sink_).load(0);
  std::set<long> rings;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const double across = std::hypot(scan.points.x[i], scan.points.y[i]);
    const double ring = (std::atan2(scan.points.z[i], across) * 180 / M_PI + 24.8) / 26.8 * 63;
    EXPECT_NEAR(ring, std::round(ring), 0.01);
    rings.insert(std::lround(ring));
  }
  EXPECT_GE(rings.size(), 50U);
  EXPECT_LE(*rings.rbegin(), 63);
  EXPECT_GE(*rings.begin(), 0);
}

TEST_F(CampusWriter, AnotherSeedGivesOtherScans) {
  CampusParams other = params();
  other.seed = 8;
  write("seven", 1, params());
  write("eight", 1, other);
  EXPECT_NE(bytesOf("seven").at("scan_000.pcd"), bytesOf("eight").at("scan_000.pcd"));
}

TEST_F(CampusWriter, ScansComeBackAsTheyWereTaken) {
  const Campus campus = buildCampus(params());
  const CampusSummary summary = writeCampus(campus, folder_ / "out", 2, sink_);
  const ScanSet set = ScanSet::open({folder_ / "out"}, {}, sink_);
  ASSERT_EQ(set.size(), 4U);
  EXPECT_EQ(summary.scans, 4U);
  const Laser laser(campus);
  std::size_t points = 0;
  for (std::size_t stop = 0; stop < set.size(); ++stop) {
    const SimulatedScan taken = laser.scanAt(stop);
    const Scan read = set.load(stop);
    EXPECT_EQ(read.id, taken.scan.id);
    EXPECT_EQ(read.points.x, taken.scan.points.x);
    EXPECT_EQ(read.points.label, taken.scan.points.label);
    EXPECT_EQ(read.points.intensity, taken.scan.points.intensity);
    EXPECT_TRUE(read.has_pose);
    EXPECT_EQ(read.T_map_sensor.matrix(), campus.stops[stop].matrix());
    points += read.points.size();
  }
  EXPECT_EQ(summary.points, points);
}

TEST_F(CampusWriter, TruthFilesFitTheScansAndTheLabelMap) {
  write("out", 2, params());
  const ScanSet set = ScanSet::open({folder_ / "out"}, {}, sink_);
  const LabelMap map = LabelMap::load(test::sourceFolder() / "labels/campus.yaml");
  for (std::size_t stop = 0; stop < set.size(); ++stop) {
    const Scan scan = set.load(stop);
    const auto file = truthFileOf(folder_ / "out" / "truth", set.file(stop).path);
    ASSERT_TRUE(file);
    const PointTruth truth = truthFromFile(*file, scan.points.size());
    const PointTruth by_labels = truthFromLabels(scan, map);
    EXPECT_EQ(truth.primitive, by_labels.primitive);
    EXPECT_EQ(truth.object_class, by_labels.object_class);
    for (std::size_t i = 0; i < truth.instance.size(); ++i) ASSERT_EQ(truth.instance[i] < 0, truth.object_class[i] < 0);
  }
}

TEST_F(CampusWriter, TheInstanceTableCountsThePointsOfTheTruthFiles) {
  write("out", 1, params());
  const ScanSet set = ScanSet::open({folder_ / "out"}, {}, sink_);
  std::map<int, std::size_t> points;
  for (std::size_t stop = 0; stop < set.size(); ++stop) {
    const auto file = truthFileOf(folder_ / "out" / "truth", set.file(stop).path);
    for (const int id : truthFromFile(*file, set.load(stop).points.size()).instance)
      if (id >= 0) ++points[id];
  }
  std::istringstream table(readFile(folder_ / "out" / "truth" / "instances.csv"));
  std::string line;
  std::getline(table, line);
  EXPECT_EQ(line,
            "id,object,n,cx,cy,cz,xmin,ymin,zmin,xmax,ymax,zmax,height,extent_long,extent_short,chunks,fine_labels,"
            "ambiguous,flags");
  std::map<int, std::size_t> listed;
  while (std::getline(table, line)) {
    std::istringstream row(line);
    std::string id, object, count;
    std::getline(row, id, ',');
    std::getline(row, object, ',');
    std::getline(row, count, ',');
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), 18) << line;
    listed[std::stoi(id)] = std::stoul(count);
  }
  EXPECT_EQ(listed, points);
  const auto ambiguous = ambiguousInstances(folder_ / "out" / "truth");
  EXPECT_TRUE(std::binary_search(ambiguous.begin(), ambiguous.end(), 0)) << "the ground counts neither way";
  EXPECT_LT(ambiguous.size(), listed.size());
}

TEST_F(CampusWriter, TheDescriptionNamesEveryObjectWithItsSurfaces) {
  write("out", 1, params());
  const Campus campus = buildCampus(params());
  const auto json = nlohmann::json::parse(readFile(folder_ / "out" / "campus.json"));
  ASSERT_EQ(json.at("objects").size(), campus.objects.size());
  for (std::size_t i = 0; i < campus.objects.size(); ++i) {
    EXPECT_EQ(json["objects"][i].at("kind"), campus.objects[i].kind);
    EXPECT_FALSE(json["objects"][i].at("surfaces").empty());
  }
  EXPECT_EQ(json.at("parameters").at("seed"), 7);
}

TEST_F(CampusWriter, RefusesAFolderThatIsNotEmpty) {
  fs::create_directories(folder_ / "out");
  writeFile(folder_ / "out" / "mine.txt", "precious");
  try {
    write("out", 1, params());
    FAIL() << "wrote into a folder in use";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::InvalidArgument);
    EXPECT_THAT(error.what(), testing::HasSubstr("is not an empty folder"));
  }
  EXPECT_EQ(bytesOf("out").size(), 1U);
}

TEST(DefaultCampus, HasBetween150And200ThousandPointsPerStop) {
  const Campus campus = buildCampus({});
  const Laser laser(campus);
  for (const std::size_t stop : {0, 3, 6, 9, 11}) {
    const std::size_t points = laser.scanAt(stop).scan.points.size();
    EXPECT_GE(points, 150'000U) << "stop " << stop;
    EXPECT_LE(points, 200'000U) << "stop " << stop;
  }
}

}  // namespace
}  // namespace cluxel::simulation
