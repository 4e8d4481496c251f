// SPDX-License-Identifier: Apache-2.0
// Reads one scan file.
#pragma once

#include <string>
#include <string_view>

#include "scan/formats/parsed_scan.hpp"
#include "scan/scan_set.hpp"

namespace cluxel::scan {

/// Parses bytes of a known format. Throws InputError; never returns an empty scan.
ParsedScan parseScan(std::string_view bytes, ScanFormat format, const std::string& file);

/// The scan whose file was parsed: reads its labels, converts the points to metres with z up, and gives the scan its
/// pose, time (to whole microseconds) and id. Takes the points of `parsed`. Throws InputError.
Scan scanOf(const ScanFile& file, ParsedScan& parsed);

/// Reads the file, and makes scanOf() of it.
LoadedScan loadScan(const ScanFile& file);

}  // namespace cluxel::scan
