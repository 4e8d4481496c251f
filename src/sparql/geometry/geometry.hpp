// SPDX-License-Identifier: Apache-2.0
// Geometry for the GeoSPARQL functions: WKT literals in the map frame or a named system, parsed once per query.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "base/proj_reference_system.hpp"

namespace cluxel::sparql {

struct Geometry;
struct FunctionContext;
struct Value;
class SearchFrame;

/// Coordinates as written: metres of the map frame, unless the geometry names a system.
struct Box2 {
  double min_x = 0, min_y = 0, max_x = 0, max_y = 0;
};

/// Null for text that is not WKT of a point, line, polygon, their multi-forms or a collection of them. A leading CRS
/// IRI is accepted and kept; Z and M coordinates are dropped, because the functions measure in two dimensions.
std::shared_ptr<const Geometry> parseWkt(std::string_view text);
/// The bounding box as a WKT polygon in the same CRS; absent for an empty geometry.
std::optional<std::string> envelopeWkt(const Geometry& geometry);
/// Of the coordinates as written; the minima of an empty geometry are above its maxima.
Box2 planeBoxOf(const Geometry& geometry);
/// True when the literal begins with the IRI of a reference system.
bool namesReferenceSystem(const Geometry& geometry);
/// Null for a value that is not a well-formed geo:wktLiteral.
std::shared_ptr<const Geometry> geometryOf(const Value& value, FunctionContext& context);
/// Notes that geometries of two systems, which are named as in systemOf(), have no distance and no relation.
void noteDifferentSystems(const std::string& a, const std::string& b, FunctionContext& context);
/// The system that the literal names, in angle brackets; empty for the map frame.
const std::string& systemOf(const Geometry& geometry);
/// The literal has Z or M coordinates, which measuring leaves out.
bool hasHeight(const Geometry& geometry);
/// The minimum distance in the plane, in units of the coordinates; 0 when they intersect, infinite when one is empty.
double distanceBetween(const Geometry& a, const Geometry& b);
/// The minimum distance along the ellipsoid of a geographic system [m]; absent when a latitude lies beyond a pole.
std::optional<double> geodesicDistance(const Geometry& a, const Geometry& b, const ReferenceSystem& system);
/// Relations in the plane of the coordinates, for geometries of one system.
bool intersects(const Geometry& a, const Geometry& b);
bool within(const Geometry& a, const Geometry& b);
bool touches(const Geometry& a, const Geometry& b);

/// Where a search looks for a geometry: its box in metres, in the plane of its coordinate system.
struct SearchBox {
  static constexpr std::uint32_t kMapFrame = 0;
  Box2 box;
  std::uint32_t system = kMapFrame;  ///< a number that equal systems share within a query
};

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
  const ReferenceSystem& system(const std::string& name);
  /// Absent where no box tells the distances of a geometry.
  std::optional<SearchBox> searchBox(const Geometry& geometry);
  /// The name of a system by its number; empty for the map frame.
  const std::string& systemName(std::uint32_t number) const;

 private:
  std::map<std::string, std::shared_ptr<const Geometry>, std::less<>> parsed_;
  std::unordered_map<std::uint32_t, std::shared_ptr<const Geometry>> stored_;
  std::map<std::string, std::unique_ptr<const ReferenceSystem>> systems_;
  struct NumberedFrame;
  std::vector<NumberedFrame> frames_;  ///< number n is at n - 1
};

}  // namespace cluxel::sparql
