// SPDX-License-Identifier: Apache-2.0
// The reference of what rules can test and of the rules themselves, as Markdown.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "mapping/map_reader.hpp"
#include "rules/language/rule_set.hpp"

namespace cluxel::tasks {

/// Every attribute of the objects of maps, by local name of their class. SI.
class MeasuredClasses {
 public:
  /// Cost: linear in the cluxels of the map's objects.
  void add(const mapping::MapReader& map);

  std::size_t maps() const { return maps_; }
  const std::map<std::string, std::vector<std::array<double, perception::kAttributeCount>>>& values() const {
    return values_;
  }

 private:
  std::size_t maps_ = 0;
  std::map<std::string, std::vector<std::array<double, perception::kAttributeCount>>> values_;
};

/// Attributes, relations and measures; the rules in the order of the strata with their trees in words; and, when maps
/// were measured, the 5 %, 50 % and 95 % quantiles of each attribute by class.
std::string referenceOf(const rules::RuleSet& rules, const MeasuredClasses& measured);

}  // namespace cluxel::tasks
