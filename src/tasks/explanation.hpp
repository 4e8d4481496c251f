// SPDX-License-Identifier: Apache-2.0
// Why something in a map is what it is.
#pragma once

#include <string>
#include <vector>

#include "mapping/map_reader.hpp"
#include "rules/language/rule_set.hpp"

namespace cluxel::tasks {

/// One explanation in both forms.
struct ExplanationTexts {
  std::string text;  ///< prose
  std::string json;
};

/// Explains an object or a primitive; `name` as for thingNamed(). Runs the map's own rules again on what lies around
/// it, and reads no more of the map where that tells. Files of rules are named relative to the folder of the first.
/// Throws Error (NotFound) when nothing or more than one resource has the name.
ExplanationTexts explainThing(const mapping::MapReader& map, const std::string& name);

/// Why the thing is not of a class, which is written as for classNamed(): how near each rule of the class comes to
/// it. Runs the rules twice over the tiles around the thing; over the whole map when these may not be enough. Throws
/// Error (NotFound) for a class that the ontology does not know, too.
ExplanationTexts explainWhyNot(const mapping::MapReader& map, const std::string& name, const std::string& class_name);
/// The tree of the rule that decided about the thing as a Graphviz graph, its path in bold; with a class, of the rule
/// of that class that comes nearest.
std::string explanationGraph(const mapping::MapReader& map, const std::string& name, const std::string& class_name);
/// One of the two: JSON instead of prose with `as_json`.
std::string explainThing(const mapping::MapReader& map, const std::string& name, bool as_json);

/// Explains an object by its number in MapReader::objects(): one line of JSON. Reads what explainThing() reads, and
/// tells the same.
std::string explainObject(const mapping::MapReader& map, std::size_t number);

/// Explains every object of the map: one line of JSON for each, in the order of MapReader::objects(), as explainThing()
/// gives it, but for counterfactuals, which that may tell from a part of the map. Runs the rules twice over the scene,
/// whatever the number of objects. forEachExplanation() needs less memory.
std::vector<std::string> explainObjects(const mapping::MapReader& map);

}  // namespace cluxel::tasks
