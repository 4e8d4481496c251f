// SPDX-License-Identifier: Apache-2.0
// KITTI's binary scans and SemanticKITTI's labels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "scan/parsed_scan.hpp"

namespace cluxel {

/// Records of four little-endian floats: x y z intensity. Throws InputError naming the byte.
ParsedScan parseKittiPoints(std::string_view bytes, const std::string& file);

/// One little-endian 32-bit number a point: the class id in the low 16 bits, which is what is returned, and
/// an instance in the high ones. Throws InputError naming the byte.
std::vector<std::uint32_t> parseKittiLabels(std::string_view bytes, const std::string& file, std::size_t point_count);

}  // namespace cluxel
