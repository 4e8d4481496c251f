// SPDX-License-Identifier: Apache-2.0
// For each cut every other thing has a distance beyond it. A pair of cuts separates when each other thing lies beyond
// one of them; its margin is that of the other thing that comes nearest.
#include "tasks/rule_teaching/separating_cuts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "rules/language/rule_condition.hpp"
#include "tasks/rule_fitting/round_number.hpp"

namespace cluxel::tasks {

namespace {

using perception::Attribute;

constexpr std::array kUsed{Attribute::Height,        Attribute::HorizontalExtent, Attribute::HorizontalThickness,
                           Attribute::FootprintArea, Attribute::Bottom,           Attribute::Top,
                           Attribute::NormalTilt,    Attribute::AxisTilt,         Attribute::Linearity,
                           Attribute::Planarity,     Attribute::Scattering,       Attribute::Radius,
                           Attribute::Roughness,     Attribute::GroundContact,    Attribute::PointCount};

/// A direction of one attribute, with how far each other thing lies beyond the outermost wanted one.
struct Direction {
  Attribute attribute = Attribute::Height;
  bool at_least = true;
  double edge = 0;             ///< value of the outermost wanted thing
  double spread = 0;           ///< of the attribute
  std::vector<double> beyond;  ///< in units of the spread; above 0: it can be cut off
};

/// The range of the middle half or the standard deviation, whichever is larger: the former is 0 where most are equal.
double spreadOf(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  double mean = 0, square = 0;
  for (const double value : values) mean += value / static_cast<double>(n);
  for (const double value : values) square += (value - mean) * (value - mean) / static_cast<double>(n);
  return std::max(values[n - 1 - n / 4] - values[n / 4], std::sqrt(square));
}

std::optional<Direction> directionOf(Attribute attribute, bool at_least, std::span<const AttributeValues> wanted,
                                     std::span<const AttributeValues> others) {
  const auto place = static_cast<std::size_t>(attribute);
  const double sign = at_least ? 1 : -1;
  Direction direction{attribute, at_least, 0, 0, {}};
  std::vector<double> all;
  double edge = std::numeric_limits<double>::infinity();
  for (const AttributeValues& values : wanted) {
    edge = std::min(edge, sign * values[place]);
    all.push_back(values[place]);
  }
  for (const AttributeValues& values : others) all.push_back(values[place]);
  direction.edge = sign * edge;
  direction.spread = spreadOf(std::move(all));
  if (!(direction.spread > 0) || !std::isfinite(direction.edge)) return std::nullopt;
  for (const AttributeValues& values : others)
    direction.beyond.push_back((edge - sign * values[place]) / direction.spread);
  return direction;
}

double marginOf(const Direction& a, const Direction& b) {
  double margin = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < a.beyond.size(); ++i) margin = std::min(margin, std::max(a.beyond[i], b.beyond[i]));
  return margin;
}

double edgesUnit(Attribute attribute) {
  const auto& info = perception::attributeInfos()[static_cast<std::size_t>(attribute)];
  return info.dimension == perception::Dimension::Angle ? std::numbers::pi / 180 : 1;
}

/// Between a quarter and three quarters of the way to the nearest other thing, at the roundest number there.
AttributeCut cutAlong(const Direction& direction, double margin) {
  const double unit = edgesUnit(direction.attribute), sign = direction.at_least ? -1 : 1;
  const double from = direction.edge + sign * margin * direction.spread / 4;
  const double to = direction.edge + sign * margin * direction.spread * 3 / 4;
  return {direction.attribute, direction.at_least,
          unit * roundestIn(std::min(from, to) / unit, std::max(from, to) / unit)};
}

}  // namespace

bool AttributeCut::holds(const AttributeValues& values) const {
  const double measured = values[static_cast<std::size_t>(attribute)];
  return at_least ? measured >= value : measured <= value;
}

std::optional<std::vector<AttributeCut>> separatingCuts(std::span<const AttributeValues> wanted,
                                                        std::span<const AttributeValues> others) {
  if (wanted.empty() || others.empty()) return std::vector<AttributeCut>{};
  std::vector<Direction> directions;
  for (const Attribute attribute : kUsed)
    for (const bool at_least : {true, false})
      if (auto direction = directionOf(attribute, at_least, wanted, others))
        directions.push_back(std::move(*direction));
  for (const bool two : {false, true}) {
    const Direction *first = nullptr, *second = nullptr;
    double best = kLeastSpread;
    for (std::size_t i = 0; i < directions.size(); ++i)
      for (std::size_t j = two ? i + 1 : i; j < (two ? directions.size() : i + 1); ++j) {
        const double margin = marginOf(directions[i], directions[j]);
        if (margin <= best) continue;
        best = margin;
        first = &directions[i];
        second = &directions[j];
      }
    if (first == nullptr) continue;
    if (!two) return std::vector{cutAlong(*first, best)};
    return std::vector{cutAlong(*first, best), cutAlong(*second, best)};
  }
  return std::nullopt;
}

std::string conditionText(const AttributeCut& cut) {
  const auto& info = perception::attributeInfos()[static_cast<std::size_t>(cut.attribute)];
  const std::string_view unit = rules::unitOf(info.dimension);
  return std::string(info.name) + (cut.at_least ? " >= " : " <= ") +
         sixDigitText(cut.value / edgesUnit(cut.attribute)) + (unit.empty() ? "" : " " + std::string(unit));
}

}  // namespace cluxel::tasks
