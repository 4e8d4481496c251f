// SPDX-License-Identifier: Apache-2.0
// A position is written so that it reads back the same.
#include "api/way_values.hpp"

#include <charconv>

namespace cluxel {

tasks::WayRequest wayRequestOf(const GroundOptions& options) {
  tasks::WayRequest request;
  request.params.max_slope = options.max_slope;
  request.params.max_step_m = options.max_step_m;
  request.terrain.highest_m = options.clearance_m;
  request.terrain.cell_m = options.cell_m;
  request.without = options.without;
  request.with_gone = options.with_gone;
  return request;
}

std::string exactText(double number) {
  char text[64];
  return {text, std::to_chars(text, text + sizeof text, number).ptr};
}

std::string textOf(const Place& place) {
  if (const auto* name = std::get_if<std::string>(&place)) return *name;
  const auto& at = std::get<GroundPosition>(place);
  return exactText(at.x) + "," + exactText(at.y);
}

GroundPosition groundPositionOf(const Eigen::Vector2d& p_map) {
  return {p_map.x(), p_map.y()};
}

std::vector<GroundPosition> lineOf(const std::vector<Eigen::Vector2d>& places) {
  std::vector<GroundPosition> line;
  line.reserve(places.size());
  for (const Eigen::Vector2d& place : places) line.push_back(groundPositionOf(place));
  return line;
}

}  // namespace cluxel
