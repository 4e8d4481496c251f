// SPDX-License-Identifier: Apache-2.0
// Routes and reach as JSON and GeoJSON texts.
#pragma once

#include <string>
#include <vector>

#include "tasks/export/map_export.hpp"
#include "tasks/ways/route.hpp"

namespace cluxel::tasks {

/// "street sign object/1a2b3c…" or "something unnamed".
std::string thingName(const mapping::MapReader& map, std::uint32_t thing);
/// A barrier in words: "a step of 0.12 m at (3.1, 4.0)".
std::string barrierText(const mapping::MapReader& map, const Barrier& barrier);

/// Corners of a way [m, map]: cells between which the direction stays are left out.
std::vector<Eigen::Vector2d> cornersOf(const GridFrame& frame, const std::vector<std::uint32_t>& cells);

/// Routes with their places [m, map] and barriers.
std::string routesJson(const mapping::MapReader& map, const GridFrame& frame, const RouteAnswer& answer);
/// A LineString for each route. Throws as writeFootprints().
std::string routesGeoJson(const mapping::MapReader& map, const GridFrame& frame, const RouteAnswer& answer,
                          ExportFrame coordinates);
/// Objects with class, walk and time.
std::string reachJson(const mapping::MapReader& map, const std::vector<ReachedObject>& reached, double area_m2,
                      double speed_m_s);

}  // namespace cluxel::tasks
