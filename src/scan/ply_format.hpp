// SPDX-License-Identifier: Apache-2.0
// PLY 1.0: ascii, binary little and big endian. The points are the element "vertex".
#pragma once

#include <string>
#include <string_view>

#include "scan/parsed_scan.hpp"

namespace cluxel {

/// Header and lengths are checked here; binary vertices are decoded by PCL, text by this wing. Elements after
/// the vertices (faces) are left alone. Throws InputError naming line or byte.
ParsedScan parsePly(std::string_view bytes, const std::string& file);

}  // namespace cluxel
