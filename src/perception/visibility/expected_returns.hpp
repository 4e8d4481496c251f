// SPDX-License-Identifier: Apache-2.0
// How many returns a scan gives where there is something: what makes a direction without return tell that nothing is
// there.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "perception/visibility/direction_index.hpp"

namespace cluxel::perception {

/// For classes of range and elevation, how many rays end around a place where one ends. It follows from the returns
/// alone: a scan that was thinned, cut off at a height or a range, or whose beams lie far apart, has few or none there.
class ExpectedReturns {
 public:
  /// Fewer returns of like range and elevation tell nothing.
  static constexpr std::size_t kFewestReturns = 24;

  /// Counts rays within `near_m` of places. `index` must outlive this. Cost: linear in the rays above the sensor.
  ExpectedReturns(const DirectionIndex& index, double near_m);

  /// The rays that pass within `near_m` of a place when something is there, or behind it: the median over returns of
  /// like range and elevation. Zero where fewer than kFewestReturns tell, or where hardly any goes higher at that
  /// range. Cost: the first call for a class counts its rays, some ten microseconds.
  double around(const Eigen::Vector3d& place) const;

 private:
  /// The returns of one range and elevation.
  struct Class {
    std::vector<std::uint32_t> rays;  ///< by number
    std::once_flag is_counted;
    float median = 0;
  };
  float medianOf(std::size_t number) const;

  const DirectionIndex& index_;
  double near_m_;
  std::unique_ptr<Class[]> classes_;  ///< by range and elevation; counted when one is asked about
  std::vector<float> highest_;  ///< by class of range: the elevation that returns of this range or more reach [rad]
};

}  // namespace cluxel::perception
