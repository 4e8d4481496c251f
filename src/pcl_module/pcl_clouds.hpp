// SPDX-License-Identifier: Apache-2.0
// PCL's readers and writer, documented in PclFunctions. Callers have checked headers and lengths.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <string_view>
#include <vector>

#include "scan/formats/point_fields.hpp"

namespace cluxel::scan {

/// Stops PCL from printing to the console; call it before PCL is used.
void silencePcl();

std::string pcdRecords(std::string_view body, const std::vector<PointField>& fields, std::size_t count, bool compressed,
                       const std::string& file);

std::string plyRecords(std::string_view body, const std::vector<PointField>& fields, std::size_t count, bool big_endian,
                       const std::string& file);

std::string pcdFile(std::string_view records, const std::vector<PointField>& fields, std::size_t count,
                    const Eigen::Isometry3d& T_map_sensor);

}  // namespace cluxel::scan
