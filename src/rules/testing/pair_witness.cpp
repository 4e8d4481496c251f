// SPDX-License-Identifier: Apache-2.0
// Tries boxes with measures at the ends and in the middle of the intervals. Sizes and heights follow from the box; what
// a box of full cluxels cannot show (roughness, tilt, points) is given to it as an attribute.
#include "rules/testing/pair_witness.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace cluxel::rules {

namespace {

using perception::Attribute;
using Intervals = std::map<Attribute, AttributeInterval>;

/// `preferred` when it is inside, then the middle and the ends, as whole centimetres where these are inside too.
std::vector<double> valuesWithin(const Intervals& intervals, Attribute attribute, double preferred) {
  const auto found = intervals.find(canonical(attribute));
  if (found == intervals.end()) return {preferred};
  const AttributeInterval& range = found->second;
  const double low = std::isfinite(range.low.value) ? range.low.value : std::min(preferred, range.high.value - 1);
  const double high = std::isfinite(range.high.value) ? range.high.value : std::max(preferred, 1.5 * low + 0.1);
  const double step = (high - low) / 20;
  std::vector<double> values;
  for (const double wanted : {preferred, (low + high) / 2, low + step, high - step, low, high}) {
    const double rounded = std::round(wanted * 100) / 100;
    const double value = range.contains(rounded) ? rounded : wanted;
    if (range.contains(value) && std::find(values.begin(), values.end(), value) == values.end())
      values.push_back(value);
  }
  return values;
}

bool followsFromBox(Attribute attribute) {
  switch (attribute) {
    case Attribute::Height:
    case Attribute::Length:
    case Attribute::Width:
    case Attribute::FootprintArea:
    case Attribute::Volume:
    case Attribute::Bottom:
    case Attribute::Top:
    case Attribute::ElevationSpan:
    case Attribute::FreeHeightBelow:
      return true;
    default:
      return false;
  }
}

/// Gives the box the attributes that it does not show by itself. False when its sizes do not fit.
bool fitAttributes(const Intervals& intervals, BoxPrimitive& box) {
  const perception::Primitive measured = sceneOfBoxes({{box}, 0}).scene.primitives.front();
  for (const auto& [attribute, range] : intervals) {
    if (range.contains(measured[attribute])) continue;
    if (followsFromBox(attribute)) return false;
    const std::vector<double> values = valuesWithin(intervals, attribute, measured[attribute]);
    if (values.empty()) return false;
    box.attributes[attribute] = values.front();
  }
  return true;
}

std::string numberText(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.10g", value);
  return text;
}

}  // namespace

std::optional<BoxPrimitive> boxWithin(const PathKnowledge& knowledge, const std::string& name,
                                      const std::function<bool(const perception::Scene&)>& accepts) {
  const Intervals intervals = knowledge.intervalsOf(name);
  BoxPrimitive box;
  box.name = "a";
  for (const scan::PrimitiveLabel label : knowledge.labelsOf(name))
    for (const double length : valuesWithin(intervals, Attribute::Length, 0.5))
      for (const double width : valuesWithin(intervals, Attribute::Width, 0.3))
        for (const double bottom : valuesWithin(intervals, Attribute::Bottom, 0))
          for (const double top : valuesWithin(intervals, Attribute::Top, bottom + 2)) {
            if (width > length || width <= 0 || top <= bottom) continue;
            box.label = label;
            box.size = {length, width, top - bottom};
            box.center = {0, 0, (top + bottom) / 2};
            box.attributes.clear();
            if (fitAttributes(intervals, box) && accepts(sceneOfBoxes({{box}, 0}).scene)) return box;
          }
  return std::nullopt;
}

std::string primitivesText(const BoxPrimitive& box) {
  const auto triple = [](const Eigen::Vector3d& v) {
    return "[" + numberText(v.x()) + ", " + numberText(v.y()) + ", " + numberText(v.z()) + "]";
  };
  std::string text = "{ " + box.name + ": { label: " + std::string(nameOf(box.label)) +
                     ", box: { center: " + triple(box.center) + ", size: " + triple(box.size) + " }";
  std::string attributes;
  for (const auto& [attribute, value] : box.attributes) {
    const perception::AttributeInfo& info = perception::attributeInfos()[static_cast<std::size_t>(attribute)];
    const std::string_view unit = unitOf(info.dimension);
    const double shown = info.dimension == perception::Dimension::Angle ? value * 180 / std::numbers::pi : value;
    attributes += (attributes.empty() ? "" : ", ") + std::string(info.name) + ": " + numberText(shown) +
                  (unit.empty() ? "" : " " + std::string(unit));
  }
  return text + (attributes.empty() ? "" : ", attributes: { " + attributes + " }") + " } }";
}

}  // namespace cluxel::rules
