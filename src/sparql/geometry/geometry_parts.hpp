// SPDX-License-Identifier: Apache-2.0
// The parts of a geometry, for the files that compute with Boost.Geometry.
#pragma once

#include <boost/geometry.hpp>
#include <boost/geometry/geometries/multi_linestring.hpp>
#include <boost/geometry/geometries/multi_point.hpp>
#include <boost/geometry/geometries/multi_polygon.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <string>

#include "sparql/geometry/geometry.hpp"

namespace cluxel::sparql {

using PlanePoint = boost::geometry::model::d2::point_xy<double>;
using PlaneLine = boost::geometry::model::linestring<PlanePoint>;
using PlanePolygon = boost::geometry::model::polygon<PlanePoint>;

struct Geometry {
  std::string crs;          ///< including angle brackets, or empty: the map frame
  bool has_height = false;  ///< Z or M coordinates were dropped
  boost::geometry::model::multi_point<PlanePoint> points;
  boost::geometry::model::multi_linestring<PlaneLine> lines;
  boost::geometry::model::multi_polygon<PlanePolygon> polygons;
};

}  // namespace cluxel::sparql
