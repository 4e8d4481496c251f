// SPDX-License-Identifier: Apache-2.0
// Planar geometry for the GeoSPARQL functions: WKT literals in metres, parsed once per query.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>

namespace cluxel::sparql {

struct Geometry;
struct FunctionContext;
struct Value;

/// Coordinates in metres, in the map frame.
struct Box2 {
  double min_x = 0, min_y = 0, max_x = 0, max_y = 0;
};

/// Null for text that is not WKT of a point, line, polygon, their multi-forms or a collection of them. A leading CRS
/// IRI is accepted and kept; Z and M coordinates are dropped, because the functions are planar.
std::shared_ptr<const Geometry> parseWkt(std::string_view text);
/// The bounding box as a WKT polygon in the same CRS.
std::string envelopeWkt(const Geometry& geometry);
Box2 boundsOf(const Geometry& geometry);
/// False when both name different reference systems; there is no conversion.
bool mayMeasure(const Geometry& a, const Geometry& b);
/// True when the literal begins with the IRI of a reference system.
bool namesReferenceSystem(const Geometry& geometry);
/// Null for a value that is not a well-formed geo:wktLiteral.
std::shared_ptr<const Geometry> geometryOf(const Value& value, FunctionContext& context);
/// The minimum distance in metres; 0 when they intersect.
double distanceBetween(const Geometry& a, const Geometry& b);
bool intersects(const Geometry& a, const Geometry& b);
bool within(const Geometry& a, const Geometry& b);
bool touches(const Geometry& a, const Geometry& b);

/// A cache of parsed geometries of a query; null for malformed ones.
class GeometryCache {
 public:
  GeometryCache();
  ~GeometryCache();
  /// By the id of a stored literal; null and no entry for an unknown id.
  const std::shared_ptr<const Geometry>* known(std::uint32_t id) const;
  std::shared_ptr<const Geometry> add(std::uint32_t id, std::string_view text);
  /// By the text of a computed literal, whose id may change its meaning between runs.
  std::shared_ptr<const Geometry> find(std::string_view text);

 private:
  std::map<std::string, std::shared_ptr<const Geometry>, std::less<>> parsed_;
  std::unordered_map<std::uint32_t, std::shared_ptr<const Geometry>> stored_;
};

}  // namespace cluxel::sparql
