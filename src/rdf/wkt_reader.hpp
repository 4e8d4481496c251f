// SPDX-License-Identifier: Apache-2.0
// Parses well-known text to coordinates.
#pragma once

#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace cluxel::rdf {

using WktPath = std::vector<std::pair<double, double>>;

/// The parts of a geometry or collection.
struct WktShape {
  WktPath points;
  std::vector<WktPath> lines;
  std::vector<std::vector<WktPath>> polygons;  ///< outer ring, then the holes
  bool has_height = false;                     ///< coordinates beyond x and y were dropped
};

/// A geo:wktLiteral: the IRI of its reference system with angle brackets, if it begins with one, and the rest.
struct WktText {
  std::string_view reference_system, shape;
};
/// None when the bracket of the reference system is not closed.
std::optional<WktText> splitWkt(std::string_view text);

/// POINT, LINESTRING, POLYGON, MULTI…, GEOMETRYCOLLECTION, with Z, M, ZM (dropped) and EMPTY; none for other text.
std::optional<WktShape> readWkt(std::string_view text);

}  // namespace cluxel::rdf
