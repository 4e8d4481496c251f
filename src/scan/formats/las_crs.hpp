// SPDX-License-Identifier: Apache-2.0
// The coordinate reference system that a LAS file states: GeoTIFF keys or OGC WKT (LAS specification 1.4 R15, 2.5 and
// 3).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "scan/input_frame.hpp"

namespace cluxel::scan {

struct LasCrs {
  std::string crs;                 ///< "EPSG:25832", else the WKT; empty when it cannot be read
  std::optional<LengthUnit> unit;  ///< of the horizontal axes, when the file states it
  bool is_geographic = false;      ///< the axes are degrees
  std::string fault;               ///< why `crs` is empty
};

/// The unit that the file states, else that of its coordinate system as PROJ knows it; absent when neither is known.
std::optional<LengthUnit> unitOf(const LasCrs& stated);

/// The statement of a file; absent when it makes none, or is no LAS file (its reader says so). Reads only the records
/// before and after the points.
std::optional<LasCrs> lasCrsOf(const std::filesystem::path& path);

/// The statement of one GeoKeyDirectory record (34735) of little-endian 16-bit numbers.
LasCrs crsFromGeoKeys(std::string_view record);
/// The statement of an OGC WKT record (2112), WKT 1 or WKT 2.
LasCrs crsFromWkt(std::string_view record);

}  // namespace cluxel::scan
