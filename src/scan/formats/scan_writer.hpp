// SPDX-License-Identifier: Apache-2.0
// Writes scans and poses to files that the readers read back unchanged.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <vector>

#include "scan/scan.hpp"

namespace cluxel::scan {

/// Writes one scan as binary PCD: x y z, then intensity, label and ray origins (vp_x vp_y vp_z) as far as the
/// scan has them. VIEWPOINT holds the pose, its rotation as a quaternion; a poses file beside the scans is
/// exact to the last bit. The time is not stored: it belongs into times.txt or a manifest. Throws InputError
/// for an empty scan or arrays of different lengths, Error (StoreUnavailable) when the disk refuses; the file
/// is whole or not there.
void writeScanFile(const Scan& scan, const std::filesystem::path& path);

/// Writes one line of 16 numbers a pose (4x4, row by row), each with the digits that give back the same
/// double. In a folder of scans the file is named poses.txt and its lines follow the scans' file names in
/// natural order.
void writePoses(const std::vector<Eigen::Isometry3d>& T_map_sensor, const std::filesystem::path& path);

/// Writes one line a scan, in seconds, as times.txt in a folder of scans.
void writeTimes(const std::vector<double>& time_s, const std::filesystem::path& path);

}  // namespace cluxel::scan
