// SPDX-License-Identifier: Apache-2.0
// Properties of the features: invariance to position, yaw and (scale-free ones) size; separation of surfaces;
// robustness to density.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "cloud_fixture.hpp"
#include "perception/features/oriented_residuals.hpp"

namespace cluxel::perception {

using namespace scan;
namespace {

using testing::CloudMaker;
using testing::meanFeatures;

/// A support of an uneven shape, as residuals to its centre.
std::vector<Eigen::Vector3f> unevenResiduals() {
  CloudMaker maker(51, 0.02);
  maker.plane(40, {-0.4, -0.2, -0.1}, {0.9, 0.1, 0.2}, {0.1, 0.5, 0}).pole(15, {0.2, 0.1, 0}, 0.5, 0.05);
  std::vector<Eigen::Vector3f> residuals;
  for (const auto& p : maker.points()) residuals.push_back(p.cast<float>());
  return residuals;
}

std::vector<float> horOf(const std::vector<Eigen::Vector3f>& residuals) {
  Support support;
  support.sum.addSet(Eigen::Vector3f::Zero(), {});
  support.residual.resize(residuals.size());
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    support.residual.set(i, residuals[i].x(), residuals[i].y(), residuals[i].z());
    support.sum.addSet(residuals[i], {});
  }
  HorScratch scratch;
  std::vector<float> hor(kHorColumns);
  fillHor(support, shapeOf(covarianceOf(support.sum)), scratch, hor);
  return hor;
}

void expectNear(const std::vector<float>& a, const std::vector<float>& b, double tolerance) {
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], tolerance) << horColumns()[i];
}

TEST(Hor, IsInvariantToScale) {
  auto residuals = unevenResiduals();
  const auto before = horOf(residuals);
  for (const float scale : {0.1F, 3.7F, 40.0F}) {
    auto scaled = residuals;
    for (auto& d : scaled) d *= scale;
    expectNear(horOf(scaled), before, 1e-4);
  }
}

TEST(Hor, IsInvariantToYawAndNotToTilt) {
  const auto residuals = unevenResiduals();
  const auto before = horOf(residuals);
  for (double yaw = 0.3; yaw < 6.3; yaw += 0.7) {
    auto rotated = residuals;
    for (auto& d : rotated) d = Eigen::AngleAxisf(static_cast<float>(yaw), Eigen::Vector3f::UnitZ()) * d;
    expectNear(horOf(rotated), before, 1e-4);
  }
  auto tilted = residuals;
  for (auto& d : tilted) d = Eigen::AngleAxisf(1.2F, Eigen::Vector3f::UnitX()) * d;
  double difference = 0;
  const auto after = horOf(tilted);
  for (std::size_t i = 0; i < after.size(); ++i) difference += std::abs(after[i] - before[i]);
  EXPECT_GT(difference, 0.3);
}

TEST(Hor, BinsAreSharesThatSumToOne) {
  const auto hor = horOf(unevenResiduals());
  double sum = 0;
  for (std::size_t i = 0; i < kHorBins; ++i) {
    EXPECT_GE(hor[i], 0);
    sum += hor[i];
  }
  EXPECT_NEAR(sum, 1, 1e-5);
}

TEST(Hor, DegenerateSupportsAreDefined) {
  EXPECT_EQ(horOf({}), std::vector<float>(kHorColumns, 0.0F));
  EXPECT_EQ(horOf({{0, 0, 0}, {0, 0, 0}}), std::vector<float>(kHorColumns, 0.0F));
  const std::vector<std::vector<Eigen::Vector3f>> supports{
      {{0, 0, 1}},                                                  // one member, straight above
      {{0.1F, 0, 0}, {0.2F, 0, 0}, {-0.3F, 0, 0}},                  // collinear
      {{0.1F, 0, 0}, {0, 0.1F, 0}, {-0.1F, 0, 0}, {0, -0.1F, 0}}};  // coplanar, without a main direction
  for (const auto& residuals : supports)
    for (const float value : horOf(residuals)) EXPECT_TRUE(std::isfinite(value));
  EXPECT_FLOAT_EQ(horOf(supports[0])[kHorBins - 1], 1.0F);
}

/// Typical surfaces of the five labels, with the position to evaluate.
struct Thing {
  std::string name;
  std::vector<Eigen::Vector3d> points;
  Eigen::Vector3d centre;
};

constexpr double kAway = 5;  ///< well inside a tile

std::vector<Thing> thingsOf(std::size_t density) {
  std::vector<Thing> things;
  const Eigen::Vector3d c(kAway, kAway, 1.5);
  things.push_back(
      {"plane", CloudMaker(61).plane(2000 * density, c - Eigen::Vector3d(2, 2, 0), {4, 0, 0}, {0, 4, 0}).points(), c});
  things.push_back(
      {"wall", CloudMaker(62).plane(1500 * density, c - Eigen::Vector3d(2, 0, 1.5), {4, 0, 0}, {0, 0, 3}).points(), c});
  things.push_back({"pole", CloudMaker(63).pole(400 * density, c - Eigen::Vector3d(0, 0, 2), 4, 0.1).points(), c});
  things.push_back({"ball", CloudMaker(64).ball(3000 * density, c, 1).points(), c});
  return things;
}

double distance(const std::vector<double>& a, const std::vector<double>& b, const std::vector<std::size_t>& columns) {
  double sum = 0;
  for (const auto i : columns) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

std::vector<std::size_t> columnsWith(const std::string& prefix) {
  std::vector<std::size_t> found;
  const FeatureLayout layout = featureLayout({});
  for (std::size_t i = 0; i < layout.columns.size(); ++i)
    if (layout.columns[i].starts_with(prefix)) found.push_back(i);
  return found;
}

TEST(Features, TellPlaneWallPoleAndBallApartAndForgiveFourTimesTheDensity) {
  const auto sparse = thingsOf(1), dense = thingsOf(4);
  std::vector<std::vector<double>> rows, dense_rows;
  for (const auto& thing : sparse) rows.push_back(meanFeatures(thing.points, {}, thing.centre, 0.7));
  for (const auto& thing : dense) dense_rows.push_back(meanFeatures(thing.points, {}, thing.centre, 0.7));
  for (const std::string prefix : {"hor.", "shape."}) {
    const auto columns = columnsWith(prefix);
    for (std::size_t a = 0; a < rows.size(); ++a)
      for (std::size_t b = 0; b < rows.size(); ++b) {
        if (a == b) continue;
        EXPECT_GT(distance(rows[a], rows[b], columns), 0.25) << prefix << sparse[a].name << sparse[b].name;
        EXPECT_LT(distance(rows[a], dense_rows[a], columns), 0.6 * distance(rows[a], dense_rows[b], columns))
            << prefix << sparse[a].name << " when dense is nearer to " << sparse[b].name;
      }
  }
}

TEST(Features, HaveTheirPhysicalMeaning) {
  const FeatureLayout layout = featureLayout({});
  const auto things = thingsOf(2);
  const auto value = [&](std::size_t thing, const std::string& column) {
    return meanFeatures(things[thing].points, {}, things[thing].centre, 0.5)[testing::columnOf(layout, column)];
  };
  EXPECT_GT(value(0, "shape.ring2_normal_up"), 0.95);
  EXPECT_LT(value(1, "shape.ring2_normal_up"), 0.1);
  EXPECT_GT(value(2, "shape.ring2_axis_up"), 0.95);
  EXPECT_GT(value(2, "shape.ring2_linearity"), 0.8);
  EXPECT_GT(value(3, "shape.ring2_scattering"), 0.25);
  EXPECT_LT(value(0, "hor.to_level"), 0.15);
  EXPECT_GT(value(2, "metric.stack_1m5_run_below"), 1.0);
  EXPECT_NEAR(value(2, "metric.stack_1m5_top"), 4.0, 0.3);
}

TEST(Features, AreInvariantToSmallMovesAndToYaw) {
  for (const auto& thing : thingsOf(2)) {
    const auto before = meanFeatures(thing.points, {}, thing.centre, 0.7);
    const auto columns = columnsWith("hor.");
    for (const double yaw : {0.4, 1.1, 2.5}) {
      const Eigen::Vector3d move(0.23 * yaw, -0.31, 0.17);
      const Eigen::AngleAxisd turn(yaw, Eigen::Vector3d::UnitZ());
      auto moved = thing.points;
      for (auto& p : moved) p = turn * (p - thing.centre) + thing.centre + move;
      const auto after = meanFeatures(moved, {}, thing.centre + move, 0.7);
      EXPECT_LT(distance(before, after, columns), 0.12) << thing.name << " rotated by " << yaw;
    }
  }
}

}  // namespace
}  // namespace cluxel::perception
