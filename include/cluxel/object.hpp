// SPDX-License-Identifier: Apache-2.0
// Objects of a map as values: class, confidence, position, extent and parts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace cluxel {

/// A position in the map frame [m]: z points up.
struct Position {
  double x = 0, y = 0, z = 0;
};

/// A position seen from above, in the map frame [m].
struct GroundPosition {
  double x = 0, y = 0;
};

/// Where something lies and how large it is, rounded to millimetres.
struct Extent {
  Position centroid;              ///< mean of its points
  Position min, max;              ///< corners of its box along the axes of the map frame
  double length_m = 0;            ///< longer side of the smallest upright box
  double width_m = 0;             ///< shorter side of that box
  double height_m = 0;            ///< from its lowest to its highest point
  double bottom_m = 0;            ///< lowest point above the local ground
  double top_m = 0;               ///< highest point above the local ground
  std::uint64_t point_count = 0;  ///< of its points after thinning
};

/// A part of an object: the trunk of a tree.
struct ObjectPart : Extent {
  std::string iri;
  std::string class_iri;
  std::string label;  ///< the class's English label
};

/// An object that the rules found.
struct Object : Extent {
  std::size_t number = 0;  ///< its place in Map::objects(), which is sorted by IRI
  std::string iri;
  std::string class_iri;
  std::string label;              ///< the class's English label: "tree"
  double confidence = 0;          ///< in [0, 1]
  std::string rule;               ///< the rule that made it
  double heading_rad = 0;         ///< direction of its longer side, from the x axis towards y
  std::vector<ObjectPart> parts;  ///< sorted by IRI; empty when its rule names no parts
  /// Times (xsd:dateTime in UTC) of the first and the last scan that speak for it. Absent where the map has fewer than
  /// two scans with a time and a pose, and of ground.
  std::optional<std::string> first_seen, last_seen;
  std::optional<std::string> seen_through;  ///< it is gone: the time of the first scan after that saw through its place
};

}  // namespace cluxel
