// SPDX-License-Identifier: Apache-2.0
// Scenes made of boxes, for rule tests: each box is a primitive whose cluxels fill it.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "cluxel/perception/scene.hpp"

namespace cluxel {

struct BoxPrimitive {
  std::string name;
  PrimitiveLabel label = PrimitiveLabel::Scatter;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Vector3d size = Eigen::Vector3d::Ones();    ///< length, width, height [m]
  double yaw_rad = 0;
  std::map<Attribute, double> attributes;   ///< measured otherwise than the box is (SI)
  std::map<std::string, double> adjacency;  ///< share of its outward edges that lead to another box
};

struct BoxScene {
  std::vector<BoxPrimitive> boxes;
  double ground_z_m = 0;
};

/// Primitives stand in the order of their ids; `names[i]` is the box of primitive i. A cluxel's name depends on its
/// box's name and place, not on the order of boxes. Relations follow relationInfos(). Cost: some microseconds per
/// cluxel.
struct BuiltBoxScene {
  Scene scene;
  std::vector<std::string> names;
};
BuiltBoxScene sceneOfBoxes(const BoxScene& boxes);

}  // namespace cluxel
