// SPDX-License-Identifier: Apache-2.0
// Our reading of the histogram of oriented residuals (HOR, paper section 3.1): directions from a cluxel to its support.
// A wall spreads them over all elevations in two azimuths, the ground over all azimuths at one elevation.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "perception/features/eigen_shape.hpp"
#include "perception/simd_vector.hpp"

namespace cluxel::perception {

/// Vectors as a structure of arrays, padded with zeros to a multiple of four.
struct Residuals {
  std::vector<float> x, y, z;
  void resize(std::size_t size) {
    count_ = size;
    const std::size_t whole = (size + kLanes - 1) / kLanes * kLanes;
    for (auto* values : {&x, &y, &z}) {
      if (values->size() < whole) values->resize(2 * whole);
      std::fill(values->begin() + static_cast<std::ptrdiff_t>(size),
                values->begin() + static_cast<std::ptrdiff_t>(whole), 0.0F);
    }
  }
  void set(std::size_t i, float dx, float dy, float dz) {
    x[i] = dx;
    y[i] = dy;
    z[i] = dz;
  }
  std::size_t size() const { return count_; }
  bool empty() const { return count_ == 0; }

 private:
  std::size_t count_ = 0;
};

/// The 2-ring support of a cluxel: residuals to its centre, and their moments. All members have the same weight
/// whatever their number of points, so that the support measures the surface and not the scanner's density.
struct Support {
  Residuals residual;                     ///< members' centres minus the cluxel's [m]; without the cluxel itself
  MomentSum sum;                          ///< with the cluxel itself, relative to its centre
  float height_low = 0, height_high = 0;  ///< vertical extent of the members' boxes, relative to the centre [m]
};

inline constexpr std::size_t kElevationNodes = 6;  ///< sin(elevation) -1, -0.6, ... 1; the poles have no azimuth
inline constexpr std::size_t kAzimuthNodes = 3;    ///< 0, 45 and 90 degrees from the support's main direction
inline constexpr std::size_t kHorBins = (kElevationNodes - 2) * kAzimuthNodes + 2;
inline constexpr std::size_t kHorScalars = 6;
inline constexpr std::size_t kHorColumns = kHorBins + kHorScalars;

std::vector<std::string> horColumns();

/// Buffers reused for all cluxels.
struct HorScratch {
  std::vector<float> length, middle;
  std::vector<std::int32_t> bucket;
};

/// Fills kHorColumns numbers; all are zero for a support without extent. `shape` is that of the support.
void fillHor(const Support& support, const EigenShape& shape, HorScratch& scratch, std::span<float> out);

}  // namespace cluxel::perception
