// SPDX-License-Identifier: Apache-2.0
// What a parser of one file format hands on, and the checks that every format shares.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "cluxel/base/diagnostic.hpp"
#include "cluxel/scan/scan.hpp"

namespace cluxel {

struct ParsedScan {
  ScanPoints points;
  Eigen::Vector3d local_origin = Eigen::Vector3d::Zero();  ///< to be added to every point, in double [m]
  std::optional<Eigen::Isometry3d> viewpoint;              ///< the sensor's pose, when the file holds one
};

/// Coordinates beyond this lose more than half a millimetre as floats; they are stored relative to a local
/// origin.
inline constexpr double kFloatReach_m = 4096;

/// No place in any terrestrial frame has a coordinate beyond this; tiles of larger ones could not be counted.
inline constexpr double kFarthest_m = 1e8;
inline constexpr const char* kUnusableCoordinate = "has a coordinate that is not finite or beyond 100000 km";

/// The origin for a file whose first point is `first`: zero within the reach of floats, else whole kilometres
/// near it.
inline Eigen::Vector3d localOriginFor(const Eigen::Vector3d& first) {
  if (first.cwiseAbs().maxCoeff() <= kFloatReach_m) return Eigen::Vector3d::Zero();
  return (first / 1000.0).array().round().matrix() * 1000.0;
}

/// Takes points in double: decides the local origin by the first one and rounds each to float once.
class PointCollector {
 public:
  explicit PointCollector(ParsedScan& scan) : scan_(&scan) {}

  /// False when a coordinate is not finite or beyond kFarthest_m.
  bool add(double x, double y, double z) {
    const bool usable = std::abs(x) <= kFarthest_m && std::abs(y) <= kFarthest_m && std::abs(z) <= kFarthest_m;
    if (!usable) return false;
    if (scan_->points.empty()) scan_->local_origin = localOriginFor({x, y, z});
    const Eigen::Vector3d& origin = scan_->local_origin;
    scan_->points.x.push_back(static_cast<float>(x - origin.x()));
    scan_->points.y.push_back(static_cast<float>(y - origin.y()));
    scan_->points.z.push_back(static_cast<float>(z - origin.z()));
    return true;
  }

  void reserve(std::size_t count) {
    scan_->points.x.reserve(count);
    scan_->points.y.reserve(count);
    scan_->points.z.reserve(count);
  }

 private:
  ParsedScan* scan_;
};

[[noreturn]] inline void refuseFile(const std::string& file, std::string message, std::string hint = {}) {
  throw InputError({.file = file}, std::move(message), std::move(hint));
}

[[noreturn]] inline void refuseByte(const std::string& file, std::uint64_t byte, std::string message,
                                    std::string hint = {}) {
  throw InputError({.file = file, .byte_offset = byte}, std::move(message), std::move(hint));
}

inline constexpr const char* kNotFiniteHint = "leave out points without a return when exporting";

}  // namespace cluxel
