// SPDX-License-Identifier: Apache-2.0
// PLY 1.0 (Stanford triangle format): ascii, binary little and big endian. The points are the element "vertex".
#pragma once

#include <string>
#include <string_view>

#include "scan/formats/parsed_scan.hpp"

namespace cluxel::scan {

/// Header and lengths are checked here; PCL decodes binary vertices, text is parsed here. Elements after the vertices
/// (faces) are ignored. Throws InputError naming line or byte.
ParsedScan parsePly(std::string_view bytes, const std::string& file);
/// The same with the field `label_field` as labels, whatever else the vertices have. Throws InputError when the
/// vertices have no such field.
ParsedScan parsePly(std::string_view bytes, const std::string& file, const std::string& label_field);

}  // namespace cluxel::scan
