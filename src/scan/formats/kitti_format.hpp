// SPDX-License-Identifier: Apache-2.0
// Scans of KITTI odometry (.bin) and labels of SemanticKITTI (.label).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "scan/formats/parsed_scan.hpp"

namespace cluxel::scan {

/// Records of four little-endian floats: x y z [m, sensor frame] and intensity. Throws InputError naming the byte.
ParsedScan parseKittiPoints(std::string_view bytes, const std::string& file);

/// The class ids (low 16 bits) of one little-endian 32-bit number per record; the high 16 bits are an instance.
/// Throws InputError naming the byte.
std::vector<std::uint32_t> parseKittiLabels(std::string_view bytes, const std::string& file, std::size_t point_count);

}  // namespace cluxel::scan
