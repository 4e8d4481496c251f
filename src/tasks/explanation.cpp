// SPDX-License-Identifier: Apache-2.0
// Finds what a name means in a map and hands it to the rules.
#include "cluxel/tasks/explanation.hpp"

#include <algorithm>

#include "cluxel/base/diagnostic.hpp"
#include "cluxel/mapping/ask_replay.hpp"
#include "cluxel/mapping/class_catalogue_of.hpp"
#include "cluxel/reasoning/explain.hpp"
#include "cluxel/reasoning/rule_loader.hpp"

namespace cluxel {

namespace {

RuleSet rulesOf(const MapInputs& inputs) {
  std::vector<RuleSource> sources;
  for (const NamedText& text : inputs.rules) sources.push_back({text.name, text.text});
  return loadRuleTexts(sources, inputs.rule_roots, classCatalogueOf(inputs.ontology)).require();
}

/// The name without what tables and other formats write around it: <IRI>, map:object/HEX.
std::string plainName(const std::string& written) {
  std::string_view name = written;
  if (name.starts_with('<') && name.ends_with('>')) name = name.substr(1, name.size() - 2);
  if (name.starts_with("map:")) name.remove_prefix(4);
  return std::string(name);
}

bool isNamed(const std::string& kind, const ContentHash& id, const std::string& name) {
  const std::string hex = id.hex(), path = kind + "/" + hex;
  return path.starts_with(name) || hex.starts_with(name) || name.ends_with("/map/" + path);
}

/// The one thing of the list that has the name; none when there is none.
template <typename Things>
std::optional<std::size_t> findOne(const Things& things, const std::string& kind, const std::string& name) {
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < things.size(); ++i) {
    if (!isNamed(kind, things[i].id, name)) continue;
    if (found) throw Error(ExitCode::NoRows, "'" + name + "' names more than one " + kind + "; write more digits");
    found = i;
  }
  return found;
}

}  // namespace

std::string explainThing(const MapReader& map, const std::string& written, bool as_json) {
  const std::string name = plainName(written);
  const RuleSet rules = rulesOf(map.inputs());
  const Scene& scene = map.scene();
  AskReplay oracle(map);
  const ReasoningContext context{.oracle = &oracle};
  Explanation explanation;
  if (name.size() < 4)
    throw Error(ExitCode::Usage, "'" + name + "' is too short: write at least four digits of the name");
  const auto primitive = findOne(scene.primitives, "primitive", name);
  const bool is_object = findOne(map.objects(), "object", name).has_value();
  if (is_object && primitive)
    throw Error(ExitCode::NoRows, "'" + name + "' names an object and a primitive; write more digits, or object/" +
                                      name + " or primitive/" + name);
  if (is_object) {
    const ReasoningResult result = reason(scene, rules, context);
    const auto object = findOne(result.objects, "object", name);
    if (!object) throw Error(ExitCode::NoRows, "the map's rules make no object '" + name + "' any more");
    const SemanticObject& found = result.objects[*object];
    explanation = explain(scene, rules, context, found, result.decisions.at(found.decision));
  } else if (primitive) {
    explanation = explain(scene, rules, context, static_cast<PrimitiveIndex>(*primitive));
  } else {
    throw Error(ExitCode::NoRows,
                "nothing in the map is named '" + name + "'; `cluxel query MAP objects.rq` lists objects");
  }
  return as_json ? jsonOf(explanation, rules, scene) : textOf(explanation, rules, scene);
}

}  // namespace cluxel
