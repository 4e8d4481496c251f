// SPDX-License-Identifier: Apache-2.0
// Copies of a place as seen by other sensors, standing or driving.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "perception/training/virtual_drive.hpp"

namespace cluxel::perception {

using namespace scan;
namespace {

/// A wall of points 4 m away, in front of another 8 m away, over flat ground.
Scan twoWalls() {
  Scan scan;
  const auto put = [&](float x, float y, float z) {
    scan.points.x.push_back(x);
    scan.points.y.push_back(y);
    scan.points.z.push_back(z);
  };
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j) put(0.1F * static_cast<float>(i), 0.1F * static_cast<float>(j), 0.0F);
  for (const float x : {6.0F, 10.0F})
    for (int i = 0; i < 60; ++i)
      for (int j = 0; j < 60; ++j) put(x, -1.0F + 0.1F * static_cast<float>(i), 0.1F * static_cast<float>(j));
  return scan;
}

std::vector<PointTruth> truthOfTwoWalls(const Scan& scan) {
  PointTruth truth;
  truth.primitive.assign(1600, 0);
  truth.primitive.resize(scan.points.size(), 1);
  return {truth};
}

TEST(VirtualSensor, SeesTheNearWallUpToItsHighestLineAndNotTheFarOne) {
  const std::vector<Scan> scans{twoWalls()};
  const std::vector<PointTruth> truths = truthOfTwoWalls(scans[0]);
  const VirtualSensor sensor{
      .height_m = 1.5, .lowest_rad = -0.4, .highest_rad = 0.1, .lines = 10, .step_rad = 0.05, .spacing_m = 4};
  const LabelledScans copy = seenBy(scans, truths, sensor);
  ASSERT_EQ(copy.scans.size(), 1U);
  std::size_t near = 0, far = 0;
  for (std::size_t i = 0; i < copy.scans[0].points.size(); ++i) {
    if (copy.truth[0].primitive[i] != 1) continue;
    (copy.scans[0].points.x[i] < 8.0F ? near : far) += 1;
    EXPECT_LE(copy.scans[0].points.z[i], 2.6F);
  }
  EXPECT_GT(near, 100U);
  EXPECT_LT(far, near / 5);
}

TEST(VirtualSensor, ThinsToTheShareAskedFor) {
  const std::vector<Scan> scans{twoWalls()};
  PointTruth truth;
  truth.primitive.assign(scans[0].points.size(), 0);
  const LabelledScans copy = thinned(scans, std::vector<PointTruth>{truth}, 0.25, 3);
  EXPECT_NEAR(static_cast<double>(copy.scans[0].points.size()), 0.25 * static_cast<double>(scans[0].points.size()),
              150);
  EXPECT_EQ(copy.truth[0].primitive.size(), copy.scans[0].points.size());
}

/// Four scans half a metre apart, over the two walls.
VirtualDrive shortDrive() {
  return {.sensor =
              {.height_m = 1.5, .lowest_rad = -0.6, .highest_rad = 0.3, .lines = 20, .step_rad = 0.05, .spacing_m = 4},
          .scans = 4,
          .step_m = 0.5,
          .range_noise_m = 0};
}

/// Distance of a point from the nearest point of the place [m].
double offPlace(const Scan& place, const Eigen::Vector3d& p) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < place.points.size(); ++i)
    least = std::min(least, (Eigen::Vector3d(place.points.x[i], place.points.y[i], place.points.z[i]) - p).norm());
  return least;
}

TEST(VirtualDrive, ShowsThePlaceAsItIsWhenPosesDoNotDrift) {
  const std::vector<Scan> place{twoWalls()};
  const LabelledScans copy = seenAlong(place, truthOfTwoWalls(place[0]), shortDrive());
  ASSERT_EQ(copy.scans.size(), 4U);
  for (std::size_t k = 0; k < copy.scans.size(); ++k) {
    const ScanPoints& points = copy.scans[k].points;
    ASSERT_EQ(points.size(), copy.truth[k].primitive.size());
    ASSERT_GT(points.size(), 100U);
    for (std::size_t i = 0; i < points.size(); i += 10)
      EXPECT_LT(offPlace(place[0], toMap(copy.scans[k].T_map_sensor, {points.x[i], points.y[i], points.z[i]})), 1e-4);
  }
}

TEST(VirtualDrive, MovesEachScanByTheErrorOfItsPoseAndKeepsWhatTheSensorSaw) {
  const std::vector<Scan> place{twoWalls()};
  const auto truth = truthOfTwoWalls(place[0]);
  VirtualDrive drifting = shortDrive();
  drifting.drift_forward_m = 0.2;
  const LabelledScans fits = seenAlong(place, truth, shortDrive()), drifts = seenAlong(place, truth, drifting);
  ASSERT_EQ(fits.scans.size(), drifts.scans.size());
  for (std::size_t k = 0; k < fits.scans.size(); ++k) {
    EXPECT_EQ(fits.scans[k].points.x, drifts.scans[k].points.x);
    const Eigen::Isometry3d error = fits.scans[k].T_map_sensor.inverse() * drifts.scans[k].T_map_sensor;
    EXPECT_NEAR(error.translation().x(), 0.2 * static_cast<double>(k), 1e-9);
    EXPECT_NEAR(error.translation().tail<2>().norm(), 0, 1e-9);
  }
}

TEST(VirtualDrive, NoiseIsAboutAsStrongAsAskedFor) {
  const std::vector<Scan> place{twoWalls()};
  const auto truth = truthOfTwoWalls(place[0]);
  VirtualDrive noisy = shortDrive();
  noisy.range_noise_m = 0.05;
  const LabelledScans exact = seenAlong(place, truth, shortDrive()), rough = seenAlong(place, truth, noisy);
  double squares = 0;
  std::size_t count = 0;
  for (std::size_t k = 0; k < exact.scans.size(); ++k)
    for (std::size_t i = 0; i < exact.scans[k].points.size(); ++i, ++count) {
      const ScanPoints &a = exact.scans[k].points, &b = rough.scans[k].points;
      squares += (Eigen::Vector3d(a.x[i], a.y[i], a.z[i]) - Eigen::Vector3d(b.x[i], b.y[i], b.z[i])).squaredNorm();
    }
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(count)), 0.05, 0.005);
}

TEST(VirtualDrive, SeesNothingWhereNoGroundIs) {
  const std::vector<Scan> place{twoWalls()};
  PointTruth truth;
  truth.primitive.assign(place[0].points.size(), 1);
  EXPECT_TRUE(seenAlong(place, std::vector<PointTruth>{truth}, shortDrive()).scans.empty());
}

}  // namespace
}  // namespace cluxel::perception
