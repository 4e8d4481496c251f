// SPDX-License-Identifier: Apache-2.0
// Distances along an ellipsoid: PROJ's geodesics between points, Boost.Geometry's (Vincenty) from lines and areas.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <geodesic.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/proj_reference_system.hpp"
#include "sparql/geometry/geometry_parts.hpp"

namespace cluxel::sparql {
namespace {

namespace geo = boost::geometry;
using EarthPoint = geo::model::point<double, 2, geo::cs::geographic<geo::degree>>;
using EarthLine = geo::model::linestring<EarthPoint>;
using EarthPolygon = geo::model::polygon<EarthPoint>;
using Spheroid = geo::srs::spheroid<double>;

/// A geometry as longitudes and latitudes in degrees.
struct OnEarth {
  geo::model::multi_point<EarthPoint> points;
  geo::model::multi_linestring<EarthLine> lines;
  geo::model::multi_polygon<EarthPolygon> polygons;
  bool is_valid = true;  ///< no latitude lies beyond a pole
};

class Placing {
 public:
  explicit Placing(const ReferenceSystem& system) : system_(system) {}

  OnEarth place(const Geometry& from) {
    OnEarth to;
    for (const PlanePoint& point : from.points) to.points.push_back(placed(point));
    for (const PlaneLine& line : from.lines) to.lines.push_back(path<EarthLine>(line));
    for (const PlanePolygon& polygon : from.polygons) {
      EarthPolygon area;
      area.outer() = path<EarthPolygon::ring_type>(polygon.outer());
      for (const auto& ring : polygon.inners()) area.inners().push_back(path<EarthPolygon::ring_type>(ring));
      geo::correct(area);
      to.polygons.push_back(std::move(area));
    }
    to.is_valid = is_valid_;
    return to;
  }

 private:
  EarthPoint placed(const PlanePoint& point) {
    const double first = point.x() * system_.degrees_per_unit, second = point.y() * system_.degrees_per_unit;
    const double longitude = system_.latitude_first ? second : first,
                 latitude = system_.latitude_first ? first : second;
    is_valid_ = is_valid_ && std::abs(latitude) <= 90 && std::abs(longitude) <= 360;
    return {longitude, latitude};
  }
  template <typename Path, typename From>
  Path path(const From& from) {
    Path to;
    for (const PlanePoint& point : from) to.push_back(placed(point));
    return to;
  }

  const ReferenceSystem& system_;
  bool is_valid_ = true;
};

double betweenPoints(const OnEarth& a, const OnEarth& b, const ReferenceSystem& system) {
  geod_geodesic earth{};
  geod_init(&earth, system.semi_major_axis_m, system.inverse_flattening > 0 ? 1 / system.inverse_flattening : 0);
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const EarthPoint& p : a.points)
    for (const EarthPoint& q : b.points) {
      double distance_m = 0;
      geod_inverse(&earth, geo::get<1>(p), geo::get<0>(p), geo::get<1>(q), geo::get<0>(q), &distance_m, nullptr,
                   nullptr);
      nearest_m = std::min(nearest_m, distance_m);
    }
  return nearest_m;
}

}  // namespace

std::optional<double> geodesicDistance(const Geometry& a, const Geometry& b, const ReferenceSystem& system) {
  const OnEarth on_a = Placing(system).place(a), on_b = Placing(system).place(b);
  if (!on_a.is_valid || !on_b.is_valid) return std::nullopt;
  const double flattening = system.inverse_flattening > 0 ? 1 / system.inverse_flattening : 0;
  const geo::strategy::distance::geographic_cross_track<geo::strategy::vincenty, Spheroid> across(
      Spheroid(system.semi_major_axis_m, system.semi_major_axis_m * (1 - flattening)));
  double nearest_m = betweenPoints(on_a, on_b, system);
  const auto measure = [&](const auto& part, const auto& other) {
    if (!part.empty() && !other.empty()) nearest_m = std::min(nearest_m, double(geo::distance(part, other, across)));
  };
  measure(on_a.points, on_b.lines);
  measure(on_a.points, on_b.polygons);
  measure(on_a.lines, on_b.points);
  measure(on_a.lines, on_b.lines);
  measure(on_a.lines, on_b.polygons);
  measure(on_a.polygons, on_b.points);
  measure(on_a.polygons, on_b.lines);
  measure(on_a.polygons, on_b.polygons);
  return nearest_m;
}

}  // namespace cluxel::sparql
