// SPDX-License-Identifier: Apache-2.0
// The boxes of a rule test, read from YAML.
#pragma once

#include "rules/language/rule_reading.hpp"
#include "rules/testing/box_scene.hpp"

namespace cluxel::rules {

class BoxSceneReader {
 public:
  explicit BoxSceneReader(RuleReading& reading) : reading_(reading), faults_(reading.faults) {}

  /// `primitives`: of boxes that are there, the keys given replace what is known.
  void readPrimitives(const YamlNode& node, BoxScene& boxes);
  /// `views`: the sensors that saw the boxes.
  void readViews(const YamlNode& node, BoxScene& boxes);
  /// `adjacency`: the shares of a box's outward edges that lead to others.
  void readAdjacency(const YamlNode& node, BoxScene& boxes);
  /// Reports a fault when no box has the name.
  void checkPrimitive(const YamlNode& name, const BoxScene& boxes);

 private:
  void changePrimitive(const YamlNode& node, BoxPrimitive& primitive);
  void readAttribute(const YamlNode& key, const YamlNode& value, BoxPrimitive& primitive);
  /// Three numbers in metres.
  Eigen::Vector3d readTriple(const YamlNode& map, std::string_view key, std::string_view context);

  RuleReading& reading_;
  FaultList& faults_;
};

}  // namespace cluxel::rules
