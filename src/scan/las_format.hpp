// SPDX-License-Identifier: Apache-2.0
// LAS 1.2 to 1.4, uncompressed (ASPRS LAS specification 1.4 R15; all point formats 0 to 10).
#pragma once

#include <string>
#include <string_view>

#include "scan/parsed_scan.hpp"

namespace cluxel {

/// Coordinates with scale and offset applied in double; intensity and classification (as label) when any is
/// not 0. Throws InputError naming the byte; compressed files (LAZ) are refused in plain words.
ParsedScan parseLas(std::string_view bytes, const std::string& file);

}  // namespace cluxel
