// SPDX-License-Identifier: Apache-2.0
// One scan file, read whole.
#pragma once

#include <string>
#include <string_view>

#include "cluxel/scan/scan_set.hpp"
#include "scan/parsed_scan.hpp"

namespace cluxel {

/// Parses bytes of a known format. Throws InputError; never returns an empty scan.
ParsedScan parseScan(std::string_view bytes, ScanFormat format, const std::string& file);

/// Reads the file and its labels, and gives the scan its pose, time and id.
Scan loadScan(const ScanFile& file);

}  // namespace cluxel
