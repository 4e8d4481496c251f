// SPDX-License-Identifier: Apache-2.0
// Scans as lines of numbers. All parsers throw InputError naming line and column, skip points that are not finite, and
// never return an empty scan.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "scan/formats/parsed_scan.hpp"

namespace cluxel::scan {

/// `x y z` or `x y z intensity`, the same on every line.
ParsedScan parseXyzText(std::string_view bytes, const std::string& file);

/// `x y z label confidence`, as in Oakland 3-D.
ParsedScan parseLabelledText(std::string_view bytes, const std::string& file);

/// `sx sy sz x y z` in the robot frame [m]: the origin of the ray, and the point.
ParsedScan parseFreiburgPoints(std::string_view bytes, const std::string& file);

/// One label id per line, `point_count` of them.
std::vector<std::uint32_t> parseLabelLines(std::string_view bytes, const std::string& file, std::size_t point_count);

/// The number of columns of the first line with content; 0 when there is none.
std::size_t columnsOfFirstLine(std::string_view bytes);

}  // namespace cluxel::scan
