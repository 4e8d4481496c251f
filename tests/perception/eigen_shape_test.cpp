// SPDX-License-Identifier: Apache-2.0
// Eigenvalues and directions against Eigen's iterative solver in double, also for nearly equal eigenvalues.
#include "perception/features/eigen_shape.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <random>

namespace cluxel::perception {

using namespace scan;
namespace {

Covariance entriesOf(const Eigen::Matrix3d& m) {
  return {m(0, 0), m(0, 1), m(0, 2), m(1, 1), m(1, 2), m(2, 2)};
}

/// A covariance with these eigenvalues, rotated at random.
Eigen::Matrix3d rotated(std::mt19937& random, const Eigen::Vector3d& values) {
  std::normal_distribution<double> normal;
  const Eigen::Matrix3d turn = Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
                                   .normalized()
                                   .toRotationMatrix();
  return turn * values.asDiagonal() * turn.transpose();
}

void expectSolved(const Eigen::Matrix3d& m, const EigenShape& shape) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> exact(m);
  const double trace = m.trace();
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(shape.value[i], exact.eigenvalues()[2 - static_cast<int>(i)], 1e-6 * trace);
  EXPECT_GE(shape.value[0], shape.value[1]);
  EXPECT_GE(shape.value[1], shape.value[2]);
  EXPECT_NEAR(shape.axis.norm(), 1.0, 1e-5);
  // The residual of the eigenvector equation is small even where two eigenvalues are equal and vectors are not unique.
  EXPECT_LE((m * shape.axis - shape.value[0] * shape.axis).norm(), 2e-6 * trace);
  if (shape.normal.isZero()) {
    EXPECT_LE(shape.value[1], kOnALine * shape.value[0]);
    return;
  }
  EXPECT_NEAR(shape.normal.norm(), 1.0, 1e-5);
  EXPECT_LE((m * shape.normal - shape.value[2] * shape.normal).norm(), 2e-6 * trace);
}

TEST(EigenShape, SolvesSetsOfAllForms) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> share(0, 1);
  for (int trial = 0; trial < 5000; ++trial) {
    const double l1 = std::pow(10.0, -7.0 + 8.0 * share(random)), l2 = l1 * share(random);
    const Eigen::Matrix3d m = rotated(random, {l1, l2, l2 * share(random)});
    expectSolved(m, shapeOf(entriesOf(m)));
  }
}

TEST(EigenShape, SolvesFlatThinAndRoundSets) {
  std::mt19937 random(2);
  const std::vector<Eigen::Vector3d> forms{{1, 1, 1},        {1, 1, 0},       {1, 0, 0},     {1, 1, 0.5},
                                           {1, 0.5, 0.5},    {1, 1e-4, 1e-5}, {1, 1, 1e-7},  {1, 0.9999, 0.5},
                                           {1, 0.5, 0.4999}, {1, 1e-3, 0},    {1, 0.75, 0.5}};
  for (const auto& form : forms) {
    expectSolved(form.asDiagonal(), shapeOf(entriesOf(form.asDiagonal())));
    for (int trial = 0; trial < 200; ++trial) {
      const Eigen::Matrix3d m = rotated(random, form);
      expectSolved(m, shapeOf(entriesOf(m)));
    }
  }
}

TEST(EigenShape, FindsTheSameBitsAloneAndInCompany) {
  std::mt19937 random(3);
  std::array<Covariance, 4> four;
  for (auto& entries : four) entries = entriesOf(rotated(random, {3, 2, 1}));
  const auto together = shapesOf(four);
  for (std::size_t i = 0; i < four.size(); ++i) {
    const EigenShape alone = shapeOf(four[i]);
    EXPECT_EQ(alone.value, together[i].value);
    EXPECT_EQ(alone.axis, together[i].axis);
    EXPECT_EQ(alone.normal, together[i].normal);
  }
}

TEST(EigenShape, SeesNoShapeInAPointAndNoNormalOnALine) {
  const EigenShape point = shapeOf(Covariance{1e-12, 0, 0, 0, 0, 0});
  EXPECT_EQ(point.value[0], 0.0);
  EXPECT_TRUE(point.axis.isZero());
  const EigenShape line = shapeOf(Covariance{0, 0, 0, 0, 0, 0.25});
  EXPECT_NEAR(line.value[0], 0.25, 1e-6);
  EXPECT_NEAR(std::abs(line.axis.z()), 1.0, 1e-6);
  EXPECT_TRUE(line.normal.isZero());
}

}  // namespace
}  // namespace cluxel::perception
