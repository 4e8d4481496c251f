// SPDX-License-Identifier: Apache-2.0
// The terrain as a formula: an inclined plane and three waves.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>

namespace cluxel::simulation {

struct Terrain {
  struct Wave {
    Eigen::Vector2d wave_number = Eigen::Vector2d::Zero();  ///< [rad/m]
    double amplitude_m = 0, phase_rad = 0;
  };
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();  ///< rise per metre along x and y
  std::array<Wave, 3> waves;

  /// Height of the terrain [m, map], without kerbs and the roughness of grass.
  double heightAt(double x, double y) const {
    double height = slope.x() * x + slope.y() * y;
    for (const Wave& wave : waves)
      height += wave.amplitude_m * std::sin(wave.wave_number.x() * x + wave.wave_number.y() * y + wave.phase_rad);
    return height;
  }
  /// The maximum slope (rise per metre).
  double steepest() const {
    double sum = slope.norm();
    for (const Wave& wave : waves) sum += wave.amplitude_m * wave.wave_number.norm();
    return sum;
  }
};

}  // namespace cluxel::simulation
