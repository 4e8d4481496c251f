// SPDX-License-Identifier: Apache-2.0
// The only door to PCL: its decoders get headers and lengths that this wing has already checked.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <string_view>
#include <vector>

#include "scan/point_fields.hpp"

namespace cluxel {

/// PCL reports to the console by itself; the library must not. Called before PCL is used.
void silencePcl();

/// Packed records of `fields` from the body of a binary PCD. `compressed`: PCL's LZF form. Throws InputError
/// when PCL cannot decode it.
std::string pcdRecords(std::string_view body, const std::vector<PointField>& fields, std::size_t count, bool compressed,
                       const std::string& file);

/// Packed little-endian records of `fields` from the vertices of a binary PLY in either byte order.
std::string plyRecords(std::string_view body, const std::vector<PointField>& fields, std::size_t count, bool big_endian,
                       const std::string& file);

/// A whole binary PCD file of packed records, with VIEWPOINT from `T_map_sensor`.
std::string pcdFile(std::string_view records, const std::vector<PointField>& fields, std::size_t count,
                    const Eigen::Isometry3d& T_map_sensor);

}  // namespace cluxel
