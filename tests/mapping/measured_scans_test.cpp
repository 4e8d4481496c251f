// SPDX-License-Identifier: Apache-2.0
// What a map holds follows from what was measured: not from clocks.
#include <gtest/gtest.h>

#include <functional>
#include <iomanip>
#include <regex>
#include <set>
#include <sstream>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "mapping/clouds/scan_store.hpp"
#include "mapping/small_campus.hpp"

namespace cluxel::mapping {

using namespace scan;
using namespace simulation;
using namespace rdf;
namespace {

namespace fs = std::filesystem;

class MeasuredScans : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    campus = new SmallCampus({.seed = 3, .stops = 3, .size_m = 50, .points_per_stop = 12'000});
    inputs = new MapInputs(shippedInputs());
  }
  static void TearDownTestSuite() {
    delete campus;
    delete inputs;
  }

  /// A manifest of the campus with the given head, and with a time and the pose of each scan.
  fs::path manifest(const std::string& head, double first_time_s) const {
    std::ostringstream text;
    text << std::setprecision(17) << head << "scans:\n";
    for (std::size_t i = 0; i < campus->files().size(); ++i) {
      const Eigen::Matrix4d pose = campus->scans()[i].scan.T_map_sensor.matrix();
      text << "  - path: " << campus->files()[i].string() << "\n    time_s: " << first_time_s + 2.5 * double(i)
           << "\n    pose: {matrix: [";
      for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) text << (row + column > 0 ? ", " : "") << pose(row, column);
      text << "]}\n";
    }
    const fs::path file = folder.path() / "manifest.yaml";
    writeFile(file, text.str());
    return file;
  }
  fs::path built(const fs::path& scans) const {
    const fs::path map = folder.path() / ("map" + std::to_string(count++) + ".clx");
    buildMap(scansOf({scans}), *inputs, map, {}, silence());
    return map;
  }

  ScratchFolder folder;
  mutable int count = 0;
  static inline SmallCampus* campus = nullptr;
  static inline MapInputs* inputs = nullptr;
};

/// The lines of a text with "T" for each time, sorted.
std::multiset<std::string> withoutTimes(const std::string& text) {
  static const std::regex time("\"[-0-9T:.Z]*\"\\^\\^<http://www.w3.org/2001/XMLSchema#dateTime>");
  std::istringstream lines(text);
  std::multiset<std::string> rest;
  for (std::string line; std::getline(lines, line);)
    rest.insert(line.find("dateTime") == std::string::npos ? line : std::regex_replace(line, time, "T"));
  return rest;
}

TEST_F(MeasuredScans, AShiftedClockChangesNothingButTheTimes) {
  const std::string then = canonicalText(built(manifest("", 1.6e9))),
                    later = canonicalText(built(manifest("", 1.6e9 + 7)));
  EXPECT_NE(then, later) << "the times are facts";
  EXPECT_TRUE(withoutTimes(then) == withoutTimes(later));
  EXPECT_NE(then.find("resultTime"), std::string::npos);
}

TEST_F(MeasuredScans, OfTwoThatAreAlikeTheLaterTimeStaysInAnyOrder) {
  Scan scan = campus->scans()[0].scan;
  for (const std::vector<std::optional<double>>& times :
       {std::vector<std::optional<double>>{5.0, 9.0}, {9.0, 5.0}, {std::nullopt, 9.0}, {9.0, std::nullopt}}) {
    const auto environment = Environment::temporary();
    WriteTransaction transaction = environment->write();
    for (const auto& time_s : times) {
      scan.time_s = time_s;
      scan.id = contentIdOf(scan);
      storeScan(transaction, scan);
    }
    const std::vector<Cloud> clouds = storedClouds(transaction);
    ASSERT_EQ(clouds.size(), 1U);
    EXPECT_EQ(clouds[0].time_s, 9.0);
  }
}

TEST_F(MeasuredScans, AFinerTimeOfAnEarlierVersionIsTheSameTime) {
  const auto environment = Environment::temporary();
  WriteTransaction transaction = environment->write();
  Scan scan = campus->scans()[0].scan;
  scan.id = contentIdOf(scan);
  for (const double time_s : {1700086400.1234567, 1700086400.123457}) {
    scan.time_s = time_s;
    storeScan(transaction, scan);
    EXPECT_EQ(storedClouds(transaction).at(0).time_s, 1700086400.1234567);
  }
  scan.time_s = 1700086400.123458;
  storeScan(transaction, scan);
  EXPECT_EQ(storedClouds(transaction).at(0).time_s, 1700086400.123458);
}

TEST_F(MeasuredScans, OfTwoThatAreAlikeButForTimeAndPoseTheSecondIsRefused) {
  const auto environment = Environment::temporary();
  WriteTransaction transaction = environment->write();
  Scan scan = campus->scans()[0].scan;
  scan.time_s = 1;
  storeScan(transaction, scan);
  scan.time_s = 2;
  scan.T_map_sensor.translation().x() += 1;
  scan.id = contentIdOf(scan);
  EXPECT_THROW(storeScan(transaction, scan), InputError);
}

/// The error of storing points at (x(i), y(i), z(i)).
std::string refusalOf(int count, const std::function<Eigen::Vector3f(int)>& at) {
  Scan scan;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3f p = at(i);
    scan.points.x.push_back(p.x());
    scan.points.y.push_back(p.y());
    scan.points.z.push_back(p.z());
  }
  scan.source = "odd.xyz";
  const auto environment = Environment::temporary();
  WriteTransaction transaction = environment->write();
  try {
    storeScan(transaction, scan);
  } catch (const InputError& error) {
    return error.what();
  }
  return "stored";
}

TEST(ImplausibleScan, OfPointsScatteredOverThousandsOfTilesIsRefused) {
  const auto dust = [](int i) { return Eigen::Vector3f(float(i % 50) * 20, float(i / 50) * 20, 1); };
  const std::string refusal = refusalOf(2500, dust);
  EXPECT_NE(refusal.find("odd.xyz: error: its 2500 points lie in 2"), std::string::npos) << refusal;
  EXPECT_EQ(refusalOf(600, dust), "stored") << "few tiles";
}

TEST(ImplausibleScan, OfAColumnThatIsKilometresHighIsRefusedAndStrayPointsAreNot) {
  const auto column = [](int i) { return Eigen::Vector3f(1, 1, float(i)); };
  const std::string refusal = refusalOf(19000, column);
  EXPECT_NE(refusal.find("points in one tile of 16 m lie more than 2 km above or below"), std::string::npos) << refusal;
  const auto ground_with_strays = [](int i) {
    return Eigen::Vector3f(float(i % 150) * 0.1F, float(i / 150) * 0.1F, i % 50 == 0 ? 5000.0F : 0.0F);
  };
  EXPECT_EQ(refusalOf(19000, ground_with_strays), "stored");
}

}  // namespace
}  // namespace cluxel::mapping
