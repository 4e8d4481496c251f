// SPDX-License-Identifier: Apache-2.0
// Generated clouds for the tests of the stages: simple surfaces with seeded noise.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "perception/pipeline.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;

/// Draws points of surfaces; the same seed gives the same points.
class CloudMaker {
 public:
  explicit CloudMaker(std::uint32_t seed, double noise_m = 0.01) : random_(seed), noise_m_(noise_m) {}

  /// `count` points of the parallelogram corner + [0,1] a + [0,1] b.
  CloudMaker& plane(std::size_t count, const Eigen::Vector3d& corner, const Eigen::Vector3d& a,
                    const Eigen::Vector3d& b);
  /// An upright cylinder's mantle.
  CloudMaker& pole(std::size_t count, const Eigen::Vector3d& foot, double height_m, double radius_m);
  /// A solid ball, as leaves fill a crown.
  CloudMaker& ball(std::size_t count, const Eigen::Vector3d& centre, double radius_m);
  /// Points at places given by a function of two numbers in [0,1].
  CloudMaker& surface(std::size_t count, const std::function<Eigen::Vector3d(double, double)>& at);

  const std::vector<Eigen::Vector3d>& points() const { return points_; }
  double unit() { return std::uniform_real_distribution<double>(0, 1)(random_); }

 private:
  void add(const Eigen::Vector3d& point);

  std::mt19937 random_;
  double noise_m_;
  std::vector<Eigen::Vector3d> points_;
};

/// A scan with these map points, seen from a sensor at the map's origin; the id is that of its content.
Scan scanOf(const std::vector<Eigen::Vector3d>& points);

/// A small street over several tiles: sloping ground, a wall, poles and a crown; crosses borders of tiles.
std::vector<Eigen::Vector3d> streetPoints(std::uint32_t seed);

/// Splits points into scans by a seeded draw.
std::vector<Scan> splitAtRandom(const std::vector<Eigen::Vector3d>& points, std::size_t scans, std::uint32_t seed);

/// The points of one scan as tiles.
std::map<TileKey, TilePoints> tilesOf(const std::vector<Scan>& scans, const ThinParams& params);

/// All outputs as bytes, tile by tile.
std::string bytesOf(const TileOutputs& tiles);

/// The stages over a few hundred points as one tile's features: rows of the own cluxels whose centre is nearer than
/// `within_m` to `centre`, averaged.
std::vector<double> meanFeatures(const std::vector<Eigen::Vector3d>& points, const PerceptionParams& params,
                                 const Eigen::Vector3d& centre, double within_m);

/// The number of a feature column; fails the test when it is missing.
std::size_t columnOf(const FeatureLayout& layout, const std::string& name);

}  // namespace cluxel::testing
