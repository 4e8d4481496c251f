// SPDX-License-Identifier: Apache-2.0
// The only place where clouds pass through PCL. Its decoders get headers and lengths that are already checked.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <string_view>
#include <vector>

#include "scan/formats/point_fields.hpp"

namespace cluxel::scan {

/// Stops PCL from printing to the console; call it before PCL is used.
void silencePcl();

/// Packed records of `fields` from the body of a binary PCD. `compressed`: PCL's LZF form. Throws InputError
/// when PCL cannot decode it.
std::string pcdRecords(std::string_view body, const std::vector<PointField>& fields, std::size_t count, bool compressed,
                       const std::string& file);

/// Packed little-endian records of `fields` from the vertices of a binary PLY in either byte order.
std::string plyRecords(std::string_view body, const std::vector<PointField>& fields, std::size_t count, bool big_endian,
                       const std::string& file);

/// The bytes of a binary PCD file with these packed records and VIEWPOINT from `T_map_sensor`.
std::string pcdFile(std::string_view records, const std::vector<PointField>& fields, std::size_t count,
                    const Eigen::Isometry3d& T_map_sensor);

}  // namespace cluxel::scan
