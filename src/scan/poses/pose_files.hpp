// SPDX-License-Identifier: Apache-2.0
// Poses, calibration and times as lines of numbers.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cluxel::scan {

/// Poses in the order of their file. TUM lines also have times.
struct PoseList {
  std::vector<Eigen::Isometry3d> poses;
  std::vector<double> time_s;  ///< empty, or one for each pose
};

/// KITTI (12 numbers a line: 3x4 by rows), 4x4 (16 numbers a line, or four lines of 4), or TUM (time x y z qx
/// qy qz qw); distinguished by the number of columns. Throws InputError naming the line when a pose is no rigid motion
/// (1e-3).
PoseList parsePoses(std::string_view bytes, const std::string& file);

/// The motion from the frame of one map to that of another: one matrix in a form of parsePoses(). Its rotation part
/// must be a rotation within 1e-6, because it acts over kilometres; the nearest rotation is returned. InputError naming
/// the line else.
Eigen::Isometry3d parseTransform(std::string_view bytes, const std::string& file);

/// Of a matrix that is nearly a rotation. One that is one within the rounding of numbers is returned as it is.
Eigen::Matrix3d nearestRotation(const Eigen::Matrix3d& matrix);

/// `Tr` (velodyne to left camera) of KITTI's calib.txt.
Eigen::Isometry3d parseKittiCalibration(std::string_view bytes, const std::string& file);

/// Line 2 (SLAM) of scan_i_robotPoses.dat: x y z roll pitch yaw in metres and radians.
Eigen::Isometry3d parseFreiburgPose(std::string_view bytes, const std::string& file);

/// One time a line [s].
std::vector<double> parseTimes(std::string_view bytes, const std::string& file);

/// Rz(yaw) Ry(pitch) Rx(roll), as REP-103.
Eigen::Matrix3d rotationFromRpy(double roll_rad, double pitch_rad, double yaw_rad);

/// What is wrong with a matrix that should be a rigid motion; nothing when it is one.
std::optional<std::string> faultOfPose(const Eigen::Isometry3d& pose);

struct TransformFault {
  std::string what, remedy;
};
/// What is wrong with a matrix that takes one map to another. It acts over kilometres, where a pose acts over the reach
/// of a sensor, so that less rounding passes than in a pose.
std::optional<TransformFault> faultOfTransform(const Eigen::Isometry3d& T);

}  // namespace cluxel::scan
