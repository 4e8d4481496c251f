// SPDX-License-Identifier: Apache-2.0
// Tests of the four text formats of poses.
#include "scan/poses/pose_files.hpp"

#include <cmath>
#include <iomanip>
#include <numbers>
#include <random>
#include <sstream>

#include "scan/scan_fixture.hpp"
#include "scan/scan_layouts.hpp"

namespace cluxel::scan {
namespace {

using test::refusalOf;
using testing::HasSubstr;

/// A rotation by 90 degrees to the left at (1, 2, 3).
Eigen::Isometry3d quarterTurn() {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  pose.translation() = Eigen::Vector3d(1, 2, 3);
  return pose;
}

TEST(PoseFiles, ReadTheSamePoseFromEveryForm) {
  for (const char* text :
       {"0 -1 0 1 1 0 0 2 0 0 1 3\n", "0 -1 0 1 1 0 0 2 0 0 1 3 0 0 0 1\n",
        "# T\n0 -1 0 1\n1 0 0 2\n\n0 0 1 3\n0 0 0 1\n", "100.5 1 2 3 0 0 0.70710678118654752 0.70710678118654752\n"}) {
    const PoseList list = parsePoses(text, "poses.txt");
    ASSERT_EQ(list.poses.size(), 1U) << text;
    EXPECT_TRUE(list.poses[0].isApprox(quarterTurn(), 1e-12)) << text;
  }
  EXPECT_EQ(parsePoses("100.5 1 2 3 0 0 0 1\n", "a.tum").time_s, std::vector<double>{100.5});
}

TEST(PoseFiles, RefuseWhatIsNoRigidMotion) {
  EXPECT_THAT(refusalOf([] { parsePoses("1 0 0 0 0 1 0 0 0 0 1\n", "p"); }),
              HasSubstr("p:1:1: error: 11 columns are no known form"));
  EXPECT_THAT(refusalOf([] { parsePoses("2 0 0 0 0 1 0 0 0 0 1 0\n", "p"); }),
              HasSubstr("not of length 1 and at right angles"));
  EXPECT_THAT(refusalOf([] { parsePoses("-1 0 0 0 0 1 0 0 0 0 1 0\n", "p"); }), HasSubstr("mirrors space"));
  EXPECT_THAT(refusalOf([] { parsePoses("1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1\n", "p"); }),
              HasSubstr("last row that is not 0 0 0 1"));
  EXPECT_THAT(refusalOf([] { parsePoses("0 0 0 0 0 0 0 2\n", "p"); }), HasSubstr("quaternion does not have length 1"));
  EXPECT_THAT(refusalOf([] { parsePoses("1 0 0 nan 0 1 0 0 0 0 1 0\n", "p"); }), HasSubstr("not finite"));
  EXPECT_THAT(refusalOf([] { parsePoses("# none\n", "p"); }), HasSubstr("holds no poses"));
  EXPECT_THAT(refusalOf([] { parsePoses("1 0 0 0\n0 1 0 0\n", "p"); }), HasSubstr("ends inside a 4x4 matrix"));
  EXPECT_THAT(refusalOf([] { parsePoses("1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n", "p"); }),
              HasSubstr("p:2:"));
}

/// `T` with so many digits after the point, in one line.
std::string writtenWith(int digits, const Eigen::Isometry3d& T) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits);
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) text << T(row, column) << ' ';
  return text.str() + "\n";
}

TEST(Transforms, AreRotationsWhateverTheirDigits) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> number(-1, 1);
  for (int round = 0; round < 200; ++round) {
    const Eigen::Quaterniond turn(number(random), number(random), number(random), number(random));
    Eigen::Isometry3d T(turn.normalized());
    T.translation() = Eigen::Vector3d(5000 * number(random), 5000 * number(random), number(random));
    for (const int digits : {7, 9, 16}) {
      const Eigen::Isometry3d read = parseTransform(writtenWith(digits, T), "T");
      EXPECT_LE((read.linear() * read.linear().transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 5e-15);
      EXPECT_LE((read.matrix() - T.matrix()).cwiseAbs().maxCoeff(), 2 * std::pow(10, -digits) + 1e-12);
    }
    EXPECT_THAT(refusalOf([&] { parseTransform(writtenWith(3, T), "T"); }), HasSubstr("is no rotation"));
  }
}

TEST(Transforms, ThatAreExactStayAsTheyAre) {
  for (const Eigen::Isometry3d& T : {Eigen::Isometry3d::Identity(), quarterTurn()})
    EXPECT_EQ(parseTransform(writtenWith(1, T), "T").matrix(), T.matrix());
  EXPECT_EQ(parseTransform("1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1", "T").matrix(), Eigen::Matrix4d::Identity());
  EXPECT_EQ(parseTransform("1 0 0 0 0 1 0 0 0 0 1 0\n", "T").matrix(), Eigen::Matrix4d::Identity());
}

TEST(Transforms, TurnAndMoveAlone) {
  const auto refusal = [](const std::string& text) { return refusalOf([&] { parseTransform(text, "T"); }); };
  const std::string scaled = refusal("0.9996 0 0 5000 0 0.9996 0 0 0 0 1 0\n");
  EXPECT_THAT(scaled, HasSubstr("T:1:"));
  EXPECT_THAT(scaled, HasSubstr("rows have lengths 0.9996, 0.9996 and 1 and are up to 0 degrees off right angles"));
  EXPECT_THAT(scaled, HasSubstr("does not scale it; write it with at least seven digits"));
  EXPECT_THAT(refusal("1 0.001 0 0 0 1 0 0 0 0 1 0\n"), HasSubstr("up to 0.057 degrees off right angles"));
  EXPECT_THAT(refusal("1.00001 0 0 0 0 1 0 0 0 0 1 0\n"), HasSubstr("rows have lengths 1.00001, 1 and 1"));
  EXPECT_THAT(refusal("0 0 0 0 0 0 0 0 0 0 0 0\n"), HasSubstr("is no rotation"));
  EXPECT_THAT(refusal("1 0 0 0 0 -1 0 0 0 0 1 0\n"), HasSubstr("the transform mirrors space"));
  EXPECT_THAT(refusal("1 0 0 0 0 1 0 0 0 0 1 0 16 32 0 1\n"), HasSubstr("the transform has a last row"));
  EXPECT_THAT(refusal("1 0 0 nan 0 1 0 0 0 0 1 0\n"), HasSubstr("a number of the transform"));
  EXPECT_THAT(refusal("0 1 2 3 0 0 0 1\n"), HasSubstr("8 columns are no known form of a transform"));
  EXPECT_THAT(refusal("# none\n"), HasSubstr("holds no transform"));
  EXPECT_THAT(refusal("1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 0\n"), HasSubstr("more than one transform"));
  EXPECT_THAT(refusal("1 0 0 0\n0 1 0 0\n0 0 1 0\n"), HasSubstr("ends inside a 4x4 matrix"));
}

TEST(PoseFiles, TakeTheSecondLineOfAFreiburgPose) {
  const Eigen::Isometry3d pose = parseFreiburgPose("9 9 9 0 0 0\n1 2 3 0 0 1.5707963267948966\n", "p");
  EXPECT_TRUE(pose.isApprox(quarterTurn(), 1e-12));
  EXPECT_THAT(refusalOf([] { parseFreiburgPose("1 2 3 0 0 0\n", "p"); }), HasSubstr("fewer than two lines"));
}

TEST(PoseFiles, TurnYawAfterPitchAfterRoll) {
  const double right = std::numbers::pi / 2;
  const Eigen::Vector3d turned = rotationFromRpy(right, 0, right) * Eigen::Vector3d(0, 1, 0);
  EXPECT_TRUE(turned.isApprox(Eigen::Vector3d(0, 0, 1), 1e-12));
}

TEST(PoseFiles, FindTheLaserToCameraMotionByItsName) {
  const std::string text = "P0: 1 0 0 0 0 1 0 0 0 0 1 0\nTr: 0 -1 0 1 1 0 0 2 0 0 1 3\n";
  EXPECT_TRUE(parseKittiCalibration(text, "calib.txt").isApprox(quarterTurn()));
  EXPECT_THAT(refusalOf([] { parseKittiCalibration("P0: 1 2 3\n", "calib.txt"); }), HasSubstr("has no line 'Tr:'"));
}

TEST(PoseFiles, ChangeCameraPosesToThoseOfTheSensor) {
  Eigen::Isometry3d forward = Eigen::Isometry3d::Identity();
  forward.translation().z() = 2;
  Eigen::Isometry3d T_camera_sensor = Eigen::Isometry3d::Identity();
  T_camera_sensor.linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  EXPECT_TRUE(sensorPoseFromCamera(forward, T_camera_sensor).translation().isApprox(Eigen::Vector3d(2, 0, 0)));
}

TEST(NaturalOrder, ComparesRunsOfDigitsAsNumbers) {
  EXPECT_TRUE(naturalLess("scan_2.pcd", "scan_10.pcd"));
  EXPECT_FALSE(naturalLess("scan_10.pcd", "scan_2.pcd"));
  EXPECT_TRUE(naturalLess("a", "b"));
  EXPECT_TRUE(naturalLess("scan", "scan_1"));
  EXPECT_TRUE(naturalLess("a01", "a1") != naturalLess("a1", "a01"));
  EXPECT_FALSE(naturalLess("a1", "a1"));
}

TEST(Poses, ThatMayBeCutAtTheEndAreRefusedUnlessTheLastNumberIsKnown) {
  const std::string rows = "1 0 0 5\n0 1 0 6\n0 0 1 7.25\n";
  EXPECT_EQ(parsePoses(rows + "0 0 0 1", "p.txt").poses.size(), 1U);
  EXPECT_EQ(parsePoses("1 0 0 5 0 1 0 6 0 0 1 7.25\n", "p.txt").poses.size(), 1U);
  EXPECT_THAT(refusalOf([] { parsePoses("1 0 0 5 0 1 0 6 0 0 1 7.2", "p.txt"); }), HasSubstr("which may be cut"));
}

}  // namespace
}  // namespace cluxel::scan
