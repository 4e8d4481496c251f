// SPDX-License-Identifier: Apache-2.0
// Files and rules as explanations name them.
#pragma once

#include "mapping/map_part.hpp"
#include "mapping/map_reader.hpp"
#include "rules/explain/explain.hpp"

namespace cluxel::tasks {

/// Names rule files relative to the folder of the first: the map holds the paths of the machine that built it.
void shortenFiles(rules::Decision& decision, const mapping::MapInputs& inputs);
void shortenFiles(rules::Explanation& explanation, const mapping::MapInputs& inputs);

/// Part of a map: its objects name the rules that made them, also where something else was stated.
mapping::MapPart withObjectsByRules(const mapping::MapReader& map, mapping::MapPart part);

}  // namespace cluxel::tasks
