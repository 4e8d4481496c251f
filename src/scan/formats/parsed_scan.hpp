// SPDX-License-Identifier: Apache-2.0
// The result of a file format's parser, and the checks that all formats share.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cluxel/error.hpp"
#include "scan/scan.hpp"

namespace cluxel::scan {

struct ParsedScan {
  ScanPoints points;
  /// To be added to every point and to the origin of its ray, in double [m].
  Eigen::Vector3d local_origin = Eigen::Vector3d::Zero();
  std::optional<Eigen::Isometry3d> viewpoint;  ///< the sensor's pose, when the file holds one
  /// Records that are no points, ascending: without a finite position, or withheld.
  std::vector<std::size_t> no_return;
  std::size_t withheld_count = 0;               ///< of these, records that the file marks as deleted
  std::vector<std::string> ignored_fields;      ///< fields whose meaning another field has already
  std::vector<std::string> lone_origin_fields;  ///< fields of an origin that lacks the others
};

/// A float beyond this is coarser than half a millimetre, so points are stored relative to a local origin.
inline constexpr double kFloatReach_m = 4096;

/// 10 000 km in millimetres, the smallest unit. The points in metres are held to the range of maps when their unit and
/// pose are known: requireInMapRange().
inline constexpr double kMaxGivenCoordinate = 1e10;
inline constexpr const char* kOutOfRange = "has a coordinate beyond 10000 km, even in millimetres";

/// The local origin for a file whose first point is `first` [m]: zero within kFloatReach_m, else the nearest whole
/// kilometres.
inline Eigen::Vector3d localOriginFor(const Eigen::Vector3d& first) {
  if (first.cwiseAbs().maxCoeff() <= kFloatReach_m) return Eigen::Vector3d::Zero();
  return (first / 1000.0).array().round().matrix() * 1000.0;
}

/// What became of a point.
enum class PointUse { Added, NoReturn, OutOfRange };

/// Collects points given in double. The first one fixes the local origin; each is rounded to float once.
class PointCollector {
 public:
  explicit PointCollector(ParsedScan& scan) : scan_(&scan) {}

  /// Organised clouds fill directions without a return with NaN: such a record is noted in `no_return`.
  PointUse add(double x, double y, double z) {
    const std::size_t record = record_++;
    if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z)) {
      scan_->no_return.push_back(record);
      return PointUse::NoReturn;
    }
    if (std::max({std::abs(x), std::abs(y), std::abs(z)}) > kMaxGivenCoordinate) return PointUse::OutOfRange;
    if (scan_->points.empty()) scan_->local_origin = localOriginFor({x, y, z});
    const Eigen::Vector3d& origin = scan_->local_origin;
    scan_->points.x.push_back(static_cast<float>(x - origin.x()));
    scan_->points.y.push_back(static_cast<float>(y - origin.y()));
    scan_->points.z.push_back(static_cast<float>(z - origin.z()));
    return PointUse::Added;
  }
  /// A record that the file marks as deleted.
  void withhold() {
    scan_->no_return.push_back(record_++);
    ++scan_->withheld_count;
  }
  /// The origin of the ray of the last added point; false when it is not finite.
  bool addOrigin(const Eigen::Vector3d& origin) {
    scan_->points.origin.push_back((origin - scan_->local_origin).cast<float>());
    return scan_->points.origin.back().allFinite();
  }

  void reserve(std::size_t count) {
    scan_->points.x.reserve(count);
    scan_->points.y.reserve(count);
    scan_->points.z.reserve(count);
  }

 private:
  ParsedScan* scan_;
  std::size_t record_ = 0;
};

[[noreturn]] inline void refuseFile(const std::string& file, std::string message, std::string hint = {}) {
  throw InputError({.file = file}, std::move(message), std::move(hint));
}

[[noreturn]] inline void refuseByte(const std::string& file, std::uint64_t byte, std::string message,
                                    std::string hint = {}) {
  throw InputError({.file = file, .byte_offset = byte}, std::move(message), std::move(hint));
}

/// Refuses a file in which no record is a point.
inline void requirePoints(const ParsedScan& scan, const std::string& file) {
  if (!scan.points.empty()) return;
  if (scan.no_return.empty()) refuseFile(file, "holds no points", "an empty scan cannot be mapped: leave it out");
  if (scan.withheld_count == scan.no_return.size())
    refuseFile(file, "marks all of its " + std::to_string(scan.withheld_count) + " points as withheld",
               "such points are deleted: leave the file out, or export it again");
  refuseFile(file, "none of its " + std::to_string(scan.no_return.size()) + " points has a finite position",
             "all are NaN or infinite: leave the file out, or export it again");
}

}  // namespace cluxel::scan
