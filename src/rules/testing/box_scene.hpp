// SPDX-License-Identifier: Apache-2.0
// Scenes made of boxes, for rule tests: each box is a primitive whose cluxels fill it.
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "perception/segments/scene.hpp"

namespace cluxel::rules {

struct BoxPrimitive {
  std::string name;
  scan::PrimitiveLabel label = scan::PrimitiveLabel::Scatter;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Vector3d size = Eigen::Vector3d::Ones();    ///< length, width, height [m]
  double yaw_rad = 0;
  std::map<perception::Attribute, double> attributes;  ///< override the measured values (SI)
  std::map<std::string, double> adjacency;  ///< other box → share of this box's outward edges that lead to it
};

/// A sensor that saw all boxes.
struct BoxView {
  Eigen::Vector3d from = Eigen::Vector3d::Zero();  ///< [m]
  std::optional<double> up_to_rad;  ///< elevation of the upper edge of its field of view; none: unlimited
};

struct BoxScene {
  std::vector<BoxPrimitive> boxes;
  double ground_z_m = 0;
  std::vector<BoxView> views = {};
};

/// Primitives are sorted by id; `names[i]` is the box of primitive i. A cluxel's name depends on its box's name and its
/// place in the box, not on the order of boxes. Relations follow relationInfos(). Cost: some microseconds per cluxel.
struct BuiltBoxScene {
  perception::Scene scene;
  std::vector<std::string> names;
};
BuiltBoxScene sceneOfBoxes(const BoxScene& boxes);

}  // namespace cluxel::rules
