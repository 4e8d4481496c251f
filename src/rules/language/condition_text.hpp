// SPDX-License-Identifier: Apache-2.0
// Conditions written as text, in the words in which `explain` prints them: "height of top >= 1 m".
#pragma once

#include <optional>

#include "base/yaml/yaml_tree.hpp"

namespace cluxel::rules {

/// The mapping that the text is short for, with the places of its words; a fault when it is none.
std::optional<YamlNode> conditionOfText(const YamlNode& text, FaultList& faults);
/// The same for what is measured, without a comparison: "roughness of whole from 1.3 m to 2 m", "gap to clx:Building".
std::optional<YamlNode> measureOfText(const YamlNode& text, FaultList& faults);

}  // namespace cluxel::rules
