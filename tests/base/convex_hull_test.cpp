// SPDX-License-Identifier: Apache-2.0
// Hulls and smallest boxes against brute force.
#include "base/convex_hull.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace cluxel {
namespace {

using Points = std::vector<Eigen::Vector2d>;

double turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

Points randomPoints(std::mt19937& random, std::size_t count, bool on_grid) {
  std::uniform_real_distribution<double> place(-5, 5);
  Points points;
  for (std::size_t i = 0; i < count; ++i) {
    Eigen::Vector2d p(place(random), place(random));
    if (on_grid) p = p.array().round();
    points.push_back(p);
  }
  return points;
}

/// A point is a corner if an edge of the brute-force hull ends in it. An edge is a pair with all points on its left,
/// and none farther out on its line.
bool isEdge(const Points& points, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  if (a == b) return false;
  for (const Eigen::Vector2d& p : points) {
    const double side = turn(a, b, p);
    if (side < 0) return false;
    const double along = (p - a).dot(b - a);
    if (side == 0 && (along < 0 || along > (b - a).squaredNorm())) return false;
  }
  return true;
}

TEST(ConvexHull, HasTheEdgesThatBruteForceFinds) {
  std::mt19937 random(3);
  for (int round = 0; round < 200; ++round) {
    const Points points = randomPoints(random, 3 + round % 20, round % 2 == 0);
    const Points hull = convexHull(points);
    std::size_t corners = 0;
    for (std::size_t i = 0; hull.size() >= 3 && i < hull.size(); ++i)
      corners += isEdge(points, hull[i], hull[(i + 1) % hull.size()]) ? 1 : 0;
    EXPECT_EQ(corners, hull.size() >= 3 ? hull.size() : 0) << "round " << round;
    for (std::size_t i = 0; hull.size() >= 3 && i < hull.size(); ++i)
      EXPECT_GT(turn(hull[i], hull[(i + 1) % hull.size()], hull[(i + 2) % hull.size()]), 0) << "a point on an edge";
  }
}

/// Points in a box, in a disc, on a circle and along a line, far from the origin: what lies inside is dropped first.
Points cloudOf(std::mt19937& random, int kind) {
  std::uniform_real_distribution<double> unit(-1, 1);
  Points points;
  while (points.size() < 400) {
    Eigen::Vector2d p(unit(random), unit(random));
    if (kind == 1 && p.norm() > 1) continue;
    if (kind == 2) p.normalize();
    if (kind == 3) p.y() = 0.3 * p.x() + 1e-9 * p.y();
    points.push_back(Eigen::Vector2d(443000, 4477000) + 8 * p);
  }
  return points;
}

TEST(ConvexHull, OfManyPointsHasAllOfThemInside) {
  std::mt19937 random(9);
  for (int round = 0; round < 40; ++round) {
    const Points points = cloudOf(random, round % 4);
    const Points hull = convexHull(points);
    ASSERT_GE(hull.size(), 2U) << "round " << round;
    for (std::size_t i = 0; i < hull.size(); ++i) {
      const Eigen::Vector2d side = (hull[(i + 1) % hull.size()] - hull[i]).normalized();
      for (const Eigen::Vector2d& p : points)
        ASSERT_GT(side.x() * (p - hull[i]).y() - side.y() * (p - hull[i]).x(), -2e-9) << "round " << round;
    }
    if (round % 4 == 2) {
      EXPECT_EQ(hull.size(), points.size()) << "every point of a circle is a corner";
    }
  }
}

TEST(ConvexHull, OfTheOuterPointsOfPiecesIsThatOfAllPointsToTheLastBit) {
  std::mt19937 random(11);
  for (int round = 0; round < 60; ++round) {
    const Points points = round % 5 == 4 ? randomPoints(random, 400, true) : cloudOf(random, round % 5);
    Points outer;
    for (std::size_t first = 0; first < points.size();) {
      const std::size_t count = std::min<std::size_t>(1 + random() % 300, points.size() - first);
      const auto begin = points.begin() + static_cast<std::ptrdiff_t>(first);
      const Points piece = outerPoints({begin, begin + static_cast<std::ptrdiff_t>(count)});
      outer.insert(outer.end(), piece.begin(), piece.end());
      first += count;
    }
    EXPECT_EQ(convexHull(outer), convexHull(points)) << "round " << round;
    EXPECT_EQ(convexHull(outerPoints(points)), convexHull(points)) << "round " << round;
    if (round % 5 == 0) {
      EXPECT_LT(outerPoints(points).size(), 40U) << "points inside were kept";
    }
  }
}

TEST(ConvexHull, TakesFewAndEqualAndCollinearPoints) {
  EXPECT_TRUE(convexHull({}).empty());
  EXPECT_EQ(convexHull({{1, 2}, {1, 2}, {1, 2}}), (Points{{1, 2}}));
  EXPECT_EQ(convexHull({{2, 2}, {0, 0}, {1, 1}, {3, 3}}), (Points{{0, 0}, {3, 3}}));
}

TEST(SmallestBox, IsNeverLargerThanABoxAtAnyAngleAndHoldsAllPoints) {
  std::mt19937 random(4);
  for (int round = 0; round < 100; ++round) {
    const Points points = randomPoints(random, 3 + round % 30, false);
    const FootprintBox box = smallestBox(convexHull(points));
    EXPECT_GE(box.length_m, box.width_m);
    EXPECT_GE(box.yaw_rad, -std::numbers::pi / 2);
    EXPECT_LT(box.yaw_rad, std::numbers::pi / 2);
    const Eigen::Rotation2Dd back(-box.yaw_rad);
    for (const Eigen::Vector2d& p : points) {
      const Eigen::Vector2d local = back * (p - box.center);
      EXPECT_LE(std::abs(local.x()), box.length_m / 2 + 1e-6);
      EXPECT_LE(std::abs(local.y()), box.width_m / 2 + 1e-6);
    }
    for (int degrees = 0; degrees < 90; ++degrees) {
      const Eigen::Rotation2Dd rotated(degrees * std::numbers::pi / 180);
      Eigen::AlignedBox2d around;
      for (const Eigen::Vector2d& p : points) around.extend(Eigen::Vector2d(rotated * p));
      EXPECT_GE(around.volume(), box.length_m * box.width_m - 1e-9) << degrees;
    }
  }
}

TEST(SmallestBox, OfALineHasItsLengthAndNoWidth) {
  const FootprintBox box = smallestBox(convexHull({{0, 0}, {3, 4}}));
  EXPECT_NEAR(box.length_m, 5, 1e-12);
  EXPECT_NEAR(box.width_m, 0, 1e-12);
  EXPECT_NEAR(box.yaw_rad, std::atan2(4, 3), 1e-7);
  EXPECT_EQ(smallestBox({}).length_m, 0);
}

}  // namespace
}  // namespace cluxel
