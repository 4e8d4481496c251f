// SPDX-License-Identifier: Apache-2.0
// What operators state about an object, for its explanation.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "mapping/map_reader.hpp"
#include "rules/language/rule_set.hpp"

namespace cluxel::tasks {

/// The object's thing, whether it is gone, and what operators state about it. Adds the same to `json`.
std::string historyOf(const mapping::MapReader& map, const ContentHash& object, nlohmann::ordered_json& json);

/// What operators made of an object, as the rules made it: another one, or none. Empty when they left it. Adds the same
/// to `json`.
std::string statedOf(const mapping::MapReader& map, const rules::RuleSet& rules,
                     const std::optional<rules::SemanticObject>& by_rules, nlohmann::ordered_json& json);

}  // namespace cluxel::tasks
