// SPDX-License-Identifier: Apache-2.0
// PCD 0.7: ascii, binary and binary_compressed.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <string_view>

#include "scan/parsed_scan.hpp"

namespace cluxel {

/// Header and lengths are checked here; binary bodies are decoded by PCL, text by this wing (three times as
/// fast). Throws InputError naming line or byte.
ParsedScan parsePcd(std::string_view bytes, const std::string& file);

/// The VIEWPOINT of a header when it is not the identity; `head` may end anywhere after the header.
std::optional<Eigen::Isometry3d> pcdViewpoint(std::string_view head, const std::string& file);

}  // namespace cluxel
