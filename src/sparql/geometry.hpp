// SPDX-License-Identifier: Apache-2.0
// Plane geometry behind the GeoSPARQL functions: WKT literals in metres, read once per query.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace cluxel::sparql {

struct Geometry;

/// Metres, in the map frame.
struct Box2 {
  double min_x = 0, min_y = 0, max_x = 0, max_y = 0;
};

/// Null for text that is not WKT of a point, line, polygon, their multi-forms or a collection of them. A CRS IRI in
/// front is accepted and kept; Z and M coordinates are dropped (the functions are plane ones).
std::shared_ptr<const Geometry> parseWkt(std::string_view text);
/// The box around it as a WKT polygon, in the same CRS.
std::string envelopeWkt(const Geometry& geometry);
Box2 boundsOf(const Geometry& geometry);
/// False where both name a reference system, and not the same: nothing is converted.
bool mayMeasure(const Geometry& a, const Geometry& b);
/// The least distance of any two points, 0 when they meet [m].
double distanceBetween(const Geometry& a, const Geometry& b);
bool intersects(const Geometry& a, const Geometry& b);
bool within(const Geometry& a, const Geometry& b);
bool touches(const Geometry& a, const Geometry& b);

/// Geometries of the literals that a query has met, by their text; null for faulty ones.
class GeometryCache {
 public:
  GeometryCache();
  ~GeometryCache();
  std::shared_ptr<const Geometry> find(std::string_view text);

 private:
  std::map<std::string, std::shared_ptr<const Geometry>, std::less<>> parsed_;
};

}  // namespace cluxel::sparql
