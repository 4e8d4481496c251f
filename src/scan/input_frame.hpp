// SPDX-License-Identifier: Apache-2.0
// Length unit and up axis of inputs, their conversion to metres with z up, and signs that they are not what was stated.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "scan/scan.hpp"

namespace cluxel::scan {

enum class LengthUnit : std::uint8_t { Metre, Centimetre, Millimetre, Foot, UsSurveyFoot };
double metresPer(LengthUnit unit);
/// "m", "cm", "mm", "ft", "us-ft".
std::string_view nameOf(LengthUnit unit);

enum class UpAxis : std::uint8_t { Z, Y };

/// Unit and axes of all coordinates of the inputs: points, ray origins and poses.
struct InputFrame {
  LengthUnit unit = LengthUnit::Metre;
  UpAxis up = UpAxis::Z;

  bool operator==(const InputFrame&) const = default;
};

/// A position in metres with z up. y up becomes z up by a quarter turn around x: (x, y, z) to (x, -z, y).
Eigen::Vector3d toMetresZUp(const Eigen::Vector3d& p, const InputFrame& frame);
/// The same change of unit and axes of a pose, so that converted points and poses fit each other.
Eigen::Isometry3d toMetresZUp(const Eigen::Isometry3d& pose, const InputFrame& frame);
void toMetresZUp(ScanPoints& points, const InputFrame& frame);

/// Signs of a wrong InputFrame.
enum class FrameDoubt : std::uint8_t {
  HugeExtent,  ///< the points span more than 20 km: millimetres read as metres, or a few points far outside
  YUp          ///< the ground is perpendicular to y
};

/// Checks the points of one scan in the map frame: metres, z up. Cost: one pass, and a sample of 10 000 points.
std::vector<FrameDoubt> frameDoubtsOf(const Scan& scan);

}  // namespace cluxel::scan
