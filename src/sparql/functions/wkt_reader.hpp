// SPDX-License-Identifier: Apache-2.0
// Parses well-known text to coordinates.
#pragma once

#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace cluxel::sparql {

using WktPath = std::vector<std::pair<double, double>>;

/// The parts of a geometry or collection.
struct WktShape {
  WktPath points;
  std::vector<WktPath> lines;
  std::vector<std::vector<WktPath>> polygons;  ///< outer ring, then the holes
  bool has_height = false;                     ///< coordinates beyond x and y were dropped
};

/// POINT, LINESTRING, POLYGON, MULTI…, GEOMETRYCOLLECTION, with Z, M, ZM (dropped) and EMPTY; none for other text.
std::optional<WktShape> readWkt(std::string_view text);

}  // namespace cluxel::sparql
