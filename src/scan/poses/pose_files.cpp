// SPDX-License-Identifier: Apache-2.0
// Parsers of pose files; every matrix is checked to be a rigid motion.
#include "scan/poses/pose_files.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

#include "scan/formats/text_scanner.hpp"

namespace cluxel::scan {

namespace {

/// KITTI and hand-written poses have six or seven digits.
constexpr double kRotationTolerance = 1e-3;

void checkPose(const TextScanner& scanner, const Eigen::Isometry3d& pose) {
  if (const auto fault = faultOfPose(pose)) scanner.refuse("the pose " + *fault);
}

constexpr const char* kNumberOfPose = "a number of the pose";

void readRow(TextScanner& scanner, Eigen::Isometry3d& pose, int row, const char* number) {
  for (int column = 0; column < 4; ++column) pose(row, column) = scanner.number(number);
}

Eigen::Isometry3d readThreeRows(TextScanner& scanner, const char* number = kNumberOfPose) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int row = 0; row < 3; ++row) readRow(scanner, pose, row, number);
  return pose;
}

Eigen::Isometry3d readFourLines(TextScanner& scanner, const char* number) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int row = 0; row < 4; ++row) {
    if (row > 0 && !scanner.nextLine()) scanner.refuseEnd("ends inside a 4x4 matrix");
    readRow(scanner, pose, row, number);
    scanner.endLine("one row of a 4x4 matrix");
  }
  return pose;
}

/// A matrix whose first line has 4, 12 or 16 columns.
Eigen::Isometry3d readMatrix(TextScanner& scanner, std::size_t columns, const char* number) {
  if (columns == 4) return readFourLines(scanner, number);
  Eigen::Isometry3d pose = readThreeRows(scanner, number);
  if (columns == 16) readRow(scanner, pose, 3, number);
  return pose;
}

Eigen::Isometry3d readTum(TextScanner& scanner) {
  std::array<double, 7> v{};
  for (double& value : v) value = scanner.number(kNumberOfPose);
  const Eigen::Quaterniond rotation(v[6], v[3], v[4], v[5]);
  if (std::abs(rotation.norm() - 1) > kRotationTolerance) scanner.refuse("the quaternion does not have length 1");
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = rotation.normalized().toRotationMatrix();
  pose.translation() = Eigen::Vector3d(v[0], v[1], v[2]);
  return pose;
}

std::size_t columnsOf(TextScanner line) {
  std::size_t columns = 0;
  for (; !line.atLineEnd(); ++columns) line.word("a column");
  return columns;
}

void readPose(TextScanner& scanner, std::size_t columns, PoseList& list) {
  Eigen::Isometry3d pose;
  if (columns == 8) {
    list.time_s.push_back(scanner.number("the time"));
    pose = readTum(scanner);
  } else {
    pose = readMatrix(scanner, columns, kNumberOfPose);
  }
  scanner.endLine("as many numbers as the first line");
  checkPose(scanner, pose);
  list.poses.push_back(pose);
}

/// How far a matrix is from a rotation.
double offRotation(const Eigen::Matrix3d& matrix) {
  return (matrix * matrix.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
}

/// What is wrong with a matrix whose rotation part has rows of length 1 and at right angles.
std::optional<std::string> otherFaultOf(const Eigen::Isometry3d& pose) {
  if (pose.linear().determinant() < 0) return "mirrors space: its rotation part has determinant -1";
  if (pose.matrix().row(3) != Eigen::RowVector4d(0, 0, 0, 1)) return "has a last row that is not 0 0 0 1";
  return std::nullopt;
}

/// "its rows have lengths 0.9996, 0.9996 and 1 and are up to 0.01 degrees off right angles".
std::string shapeOf(const Eigen::Matrix3d& rotation) {
  const Eigen::Vector3d lengths = rotation.rowwise().norm();
  double off_deg = 0;
  for (const auto& [a, b] : {std::pair(0, 1), std::pair(0, 2), std::pair(1, 2)}) {
    const double cosine = rotation.row(a).dot(rotation.row(b)) / (lengths[a] * lengths[b]);
    off_deg = std::max(off_deg, std::abs(std::asin(std::clamp(cosine, -1.0, 1.0))) * 180 / std::numbers::pi);
  }
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(),
                "its rows have lengths %.7g, %.7g and %.7g and are up to %.2g degrees off right angles", lengths[0],
                lengths[1], lengths[2], off_deg);
  return text.data();
}

void requireRigidTransform(const TextScanner& scanner, const Eigen::Isometry3d& T) {
  if (const auto fault = faultOfTransform(T)) scanner.refuse(fault->what, fault->remedy);
}

}  // namespace

std::optional<std::string> faultOfPose(const Eigen::Isometry3d& pose) {
  if (!pose.matrix().allFinite()) return "has numbers that are not finite";
  if (!(offRotation(pose.linear()) <= kRotationTolerance))
    return "has a rotation part whose rows are not of length 1 and at right angles";
  return otherFaultOf(pose);
}

std::optional<TransformFault> faultOfTransform(const Eigen::Isometry3d& T) {
  constexpr double kTolerance = 1e-6;  // seven digits after the point give less
  if (!T.matrix().allFinite()) return TransformFault{"the transform has numbers that are not finite", "write numbers"};
  if (!(offRotation(T.linear()) <= kTolerance))
    return TransformFault{
        "the rotation part of the transform is no rotation: " + shapeOf(T.linear()),
        "a transform turns and moves a map, it does not scale it; write it with at least seven digits after the point"};
  if (const auto fault = otherFaultOf(T)) return TransformFault{"the transform " + *fault, "write it row by row"};
  return std::nullopt;
}

Eigen::Matrix3d nearestRotation(const Eigen::Matrix3d& matrix) {
  constexpr double kRounding = 1e-15;
  if (offRotation(matrix) <= kRounding) return matrix;  // the identity and right angles stay exact
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

Eigen::Isometry3d parseTransform(std::string_view bytes, const std::string& file) {
  constexpr const char* kForms =
      "a transform is a 4x4 matrix (16 numbers on a line, or four lines of 4) or a 3x4 one (12)";
  TextScanner scanner(bytes, file);
  if (!scanner.nextLine()) scanner.refuseEnd("holds no transform", kForms);
  const std::size_t columns = columnsOf(scanner);
  if (columns != 4 && columns != 12 && columns != 16)
    scanner.refuse(std::to_string(columns) + " columns are no known form of a transform", kForms);
  if (columns != 12) scanner.trustLastNumber();  // the last row is 0 0 0 1
  Eigen::Isometry3d T = readMatrix(scanner, columns, "a number of the transform");
  if (columns != 4) scanner.endLine("one matrix");
  requireRigidTransform(scanner, T);
  if (scanner.nextLine()) scanner.refuse("holds more than one transform", "one is needed");
  T.linear() = nearestRotation(T.linear());
  return T;
}

PoseList parsePoses(std::string_view bytes, const std::string& file) {
  TextScanner scanner(bytes, file);
  PoseList list;
  std::size_t columns = 0;
  while (scanner.nextLine()) {
    if (columns == 0) columns = columnsOf(scanner);
    if (columns != 4 && columns != 8 && columns != 12 && columns != 16)
      scanner.refuse(std::to_string(columns) + " columns are no known form of a pose",
                     "known are 12 (KITTI 3x4), 16 or four lines of 4 (4x4), and 8 (TUM: time x y z qx qy qz qw)");
    if (columns == 4 || columns == 16) scanner.trustLastNumber();  // the last row is 0 0 0 1
    readPose(scanner, columns, list);
  }
  if (list.poses.empty()) scanner.refuseEnd("holds no poses");
  return list;
}

Eigen::Isometry3d parseKittiCalibration(std::string_view bytes, const std::string& file) {
  TextScanner scanner(bytes, file);
  while (scanner.nextLine()) {
    const std::string_view name = scanner.word("a name");
    if (name != "Tr:" && name != "Tr" && name != "Tr_velo_to_cam:" && name != "Tr_velo_cam:") continue;
    Eigen::Isometry3d Tr = readThreeRows(scanner);
    scanner.endLine("Tr: and 12 numbers");
    checkPose(scanner, Tr);
    return Tr;
  }
  scanner.refuseEnd("has no line 'Tr:'", "KITTI's calib.txt holds the motion from the laser to the camera as Tr");
}

Eigen::Isometry3d parseFreiburgPose(std::string_view bytes, const std::string& file) {
  TextScanner scanner(bytes, file);
  if (!scanner.nextLine() || !scanner.nextLine())
    scanner.refuseEnd("has fewer than two lines", "line 1 is odometry, line 2 is the pose found by SLAM");
  std::array<double, 6> v{};
  for (double& value : v) value = scanner.number("a number of the pose");
  scanner.endLine("x y z roll pitch yaw");
  Eigen::Isometry3d T_map_robot = Eigen::Isometry3d::Identity();
  T_map_robot.linear() = rotationFromRpy(v[3], v[4], v[5]);
  T_map_robot.translation() = Eigen::Vector3d(v[0], v[1], v[2]);
  checkPose(scanner, T_map_robot);
  return T_map_robot;
}

std::vector<double> parseTimes(std::string_view bytes, const std::string& file) {
  TextScanner scanner(bytes, file);
  std::vector<double> times;
  while (scanner.nextLine()) {
    times.push_back(scanner.number("the time"));
    scanner.endLine("one time in seconds");
  }
  return times;
}

Eigen::Matrix3d rotationFromRpy(double roll_rad, double pitch_rad, double yaw_rad) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  return (AngleAxisd(yaw_rad, Vector3d::UnitZ()) * AngleAxisd(pitch_rad, Vector3d::UnitY()) *
          AngleAxisd(roll_rad, Vector3d::UnitX()))
      .toRotationMatrix();
}

}  // namespace cluxel::scan
