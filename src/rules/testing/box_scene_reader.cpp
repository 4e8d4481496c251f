// SPDX-License-Identifier: Apache-2.0
// Reads boxes, the sensors that see them, and which of them touch.
#include "rules/testing/box_scene_reader.hpp"

#include <algorithm>

#include "base/nearest_name.hpp"

namespace cluxel::rules {

void BoxSceneReader::readPrimitives(const YamlNode& node, BoxScene& boxes) {
  if (!node.isMap()) return faults_.error(node.at, "'primitives' maps names to boxes");
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    if (!checkKeys(node.items[i], "primitive", faults_)) continue;
    const std::string& name = node.keys[i].text;
    const auto same = std::find_if(boxes.boxes.begin(), boxes.boxes.end(),
                                   [&](const BoxPrimitive& known) { return known.name == name; });
    if (same != boxes.boxes.end()) {
      changePrimitive(node.items[i], *same);
      continue;
    }
    BoxPrimitive primitive;
    primitive.name = name;
    for (const char* key : {"label", "box"}) requireKey(node.items[i], key, "primitive", faults_);
    changePrimitive(node.items[i], primitive);
    boxes.boxes.push_back(std::move(primitive));
  }
}

void BoxSceneReader::changePrimitive(const YamlNode& node, BoxPrimitive& primitive) {
  const auto labels = node.find("label") == nullptr ? std::vector<scan::PrimitiveLabel>{} : readLabels(node, reading_);
  if (!labels.empty()) primitive.label = labels.front();
  const YamlNode* box = node.find("box");
  if (box != nullptr && checkKeys(*box, "box", faults_)) {
    primitive.center = readTriple(*box, "center", "box");
    primitive.size = readTriple(*box, "size", "box");
    if (primitive.size.minCoeff() <= 0) faults_.error(box->at, "a box must have a size");
    if (const YamlNode* yaw = box->find("yaw"))
      if (const auto angle = readQuantity(*yaw, perception::Dimension::Angle, reading_))
        primitive.yaw_rad = angle->value;
  }
  const YamlNode* attributes = node.find("attributes");
  if (attributes == nullptr) return;
  for (std::size_t i = 0; i < attributes->items.size() && attributes->isMap(); ++i)
    readAttribute(attributes->keys[i], attributes->items[i], primitive);
}

void BoxSceneReader::readAttribute(const YamlNode& key, const YamlNode& value, BoxPrimitive& primitive) {
  const auto attribute = perception::attributeOf(key.text);
  if (!attribute) {
    std::vector<std::string> known;
    for (const perception::AttributeInfo& info : perception::attributeInfos()) known.emplace_back(info.name);
    return faults_.error(key.at, "unknown attribute '" + key.text + "'", suggestion(key.text, known));
  }
  const perception::Dimension dimension = perception::attributeInfos()[static_cast<std::size_t>(*attribute)].dimension;
  if (const auto quantity = readQuantity(value, dimension, reading_))
    primitive.attributes[*attribute] = quantity->value;
}

Eigen::Vector3d BoxSceneReader::readTriple(const YamlNode& map, std::string_view key, std::string_view context) {
  Eigen::Vector3d triple = Eigen::Vector3d::Ones();
  const YamlNode* node = requireKey(map, key, context, faults_);
  if (node == nullptr) return triple;
  if (!node->isSequence() || node->items.size() != 3) {
    faults_.error(node->at, "three numbers are expected here, in metres: [x, y, z]");
    return triple;
  }
  for (int i = 0; i < 3; ++i) {
    const YamlNode& item = node->items[static_cast<std::size_t>(i)];
    const auto number = item.isScalar() ? parseNumber(item.text) : std::nullopt;
    if (number && std::abs(*number) < 1e5)
      triple[i] = *number;
    else
      faults_.error(item.at, "a number of metres is expected here");
  }
  return triple;
}

void BoxSceneReader::readViews(const YamlNode& node, BoxScene& boxes) {
  if (!node.isSequence())
    return faults_.error(node.at, "'views' takes a list of sensors: [ { from: [0, 0, 2], up_to: 2 deg } ]");
  boxes.views.clear();
  for (const YamlNode& item : node.items) {
    if (!checkKeys(item, "view", faults_)) continue;
    BoxView view;
    view.from = readTriple(item, "from", "view");
    if (const YamlNode* up_to = item.find("up_to"))
      if (const auto angle = readQuantity(*up_to, perception::Dimension::Angle, reading_))
        view.up_to_rad = angle->value;
    boxes.views.push_back(view);
  }
}

void BoxSceneReader::readAdjacency(const YamlNode& node, BoxScene& boxes) {
  if (!node.isMap()) return faults_.error(node.at, "'adjacency' maps names to shares: { b: { c: 0.8 } }");
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    const auto box = std::find_if(boxes.boxes.begin(), boxes.boxes.end(),
                                  [&](const BoxPrimitive& known) { return known.name == node.keys[i].text; });
    if (box == boxes.boxes.end() || !node.items[i].isMap()) {
      faults_.error(node.keys[i].at, "'" + node.keys[i].text + "' is no primitive of this test", "{ b: { c: 0.8 } }");
      continue;
    }
    for (std::size_t j = 0; j < node.items[i].items.size(); ++j) {
      checkPrimitive(node.items[i].keys[j], boxes);
      const auto share = readQuantity(node.items[i].items[j], perception::Dimension::Ratio, reading_);
      if (share && (share->value < 0 || share->value > 1))
        faults_.error(node.items[i].items[j].at, "a share lies between 0 and 1");
      if (share) box->adjacency[node.items[i].keys[j].text] = share->value;
    }
  }
}

void BoxSceneReader::checkPrimitive(const YamlNode& name, const BoxScene& boxes) {
  std::vector<std::string> known;
  for (const BoxPrimitive& box : boxes.boxes) known.push_back(box.name);
  if (!name.isScalar() || std::find(known.begin(), known.end(), name.text) == known.end())
    faults_.error(name.at, "no primitive '" + name.text + "' in this test", suggestion(name.text, known));
}

}  // namespace cluxel::rules
