// SPDX-License-Identifier: Apache-2.0
// LAS 1.2 to 1.4, uncompressed (ASPRS LAS specification 1.4 R15; all point formats 0 to 10).
#pragma once

#include <string>
#include <string_view>

#include "scan/formats/parsed_scan.hpp"

namespace cluxel::scan {

/// Points [in the file's unit] with scale and offset applied in double; intensity and classification (as label) unless
/// all are 0, which means not recorded. Throws InputError naming the byte, also for compressed files (LAZ).
ParsedScan parseLas(std::string_view bytes, const std::string& file);

}  // namespace cluxel::scan
