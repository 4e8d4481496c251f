// SPDX-License-Identifier: Apache-2.0
// The words of conditions: operators, and measures between two things.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include "rules/language/rule_condition.hpp"

namespace cluxel::rules {

inline std::optional<Comparison> comparisonOf(std::string_view word) {
  static constexpr std::array<std::pair<std::string_view, Comparison>, 8> kOperators{
      {{"<", Comparison::Less},
       {"<=", Comparison::LessEqual},
       {">", Comparison::Greater},
       {">=", Comparison::GreaterEqual},
       {"=", Comparison::Equal},
       {"!=", Comparison::NotEqual},
       {"between", Comparison::Between},
       {"outside", Comparison::Outside}}};
  for (const auto& [text, comparison] : kOperators)
    if (text == word) return comparison;
  return std::nullopt;
}

struct MeasureWord {
  std::string_view key;
  PairMeasure measure;
  perception::Dimension dimension;
};
inline constexpr std::array<MeasureWord, 5> kMeasureWords{
    {{"gap_to", PairMeasure::Gap, perception::Dimension::Length},
     {"horizontal_gap_to", PairMeasure::HorizontalGap, perception::Dimension::Length},
     {"vertical_gap_to", PairMeasure::VerticalGap, perception::Dimension::Length},
     {"axis_distance_to", PairMeasure::AxisDistance, perception::Dimension::Length},
     {"adjacent_fraction_to", PairMeasure::AdjacentFraction, perception::Dimension::Ratio}}};

/// Absent for another word.
inline const MeasureWord* measureOf(std::string_view key) {
  const auto* found = std::find_if(kMeasureWords.begin(), kMeasureWords.end(),
                                   [&](const MeasureWord& word) { return word.key == key; });
  return found == kMeasureWords.end() ? nullptr : found;
}

}  // namespace cluxel::rules
