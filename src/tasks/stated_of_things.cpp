// SPDX-License-Identifier: Apache-2.0
// The rules do not know statements, so that explanations of their decisions leave these out.
#include "tasks/stated_of_things.hpp"

#include <algorithm>

#include "mapping/change/statement_change.hpp"
#include "mapping/statements/applied_statements.hpp"
#include "mapping/thing_history.hpp"
#include "rdf/map_iris.hpp"
#include "tasks/gone_things.hpp"
#include "tasks/thing_names.hpp"

namespace cluxel::tasks {

namespace {

bool isByOperator(const mapping::MapReader& map, const ContentHash& object) {
  const auto& overruled = map.overruled();
  return std::any_of(overruled.begin(), overruled.end(), [&](const auto& changed) { return changed.now == object; });
}

}  // namespace

std::string historyOf(const mapping::MapReader& map, const ContentHash& object, nlohmann::ordered_json& json) {
  const std::vector<mapping::Thing> things = mapping::ThingLookup(map.quads()).thingsOf(object);
  const std::string thing = things.empty() ? rdf::iriOfThing(object) : things.front().iri;
  json["thing"] = thing;
  std::string text = "thing/" + mapping::localName(thing) + "\n";
  if (const auto gone = seenThrough(map.quads(), rdf::iriOfObject(object))) {
    json["seenThrough"] = *gone;
    text += "gone: a scan at " + *gone + " saw through its place\n";
  }
  for (const mapping::KnownStatement& known : mapping::knownStatements(map.quads())) {
    if (known.object != rdf::iriOfObject(object)) continue;
    json["stated"].push_back({{"statement", known.statement.id().hex()},
                              {"states", textOf(known.statement)},
                              {"effect", known.effect},
                              {"author", known.author},
                              {"statedAt", known.stated_at},
                              {"rulesSay", known.rules_class},
                              {"contradictsRules", known.contradicts}});
    text += "stated" + (known.author.empty() ? "" : " by " + known.author) +
            (known.stated_at.empty() ? "" : " " + known.stated_at) + ": " + textOf(known.statement) + " (" +
            known.effect + (known.contradicts ? ", against the rules" : "") + ")\n";
  }
  if (isByOperator(map, object)) text += "without the statement the rules decide:\n";
  return text;
}

std::string statedOf(const mapping::MapReader& map, const rules::RuleSet& rules,
                     const std::optional<rules::SemanticObject>& by_rules, nlohmann::ordered_json& json) {
  if (!by_rules) return {};
  for (const mapping::OverruledObject& overruled : map.overruled()) {
    if (overruled.by_rules.id != by_rules->id) continue;
    if (!overruled.now) {
      json["removed"] = true;
      return "an operator statement removed the object; without it the rules decide:\n";
    }
    const std::string class_iri = map.classOf(objectNamed(map, overruled.now->hex()));
    json["now"] = {{"object", rdf::iriOfObject(*overruled.now)}, {"class", class_iri}};
    return "now of object/" + overruled.now->hex() + " (" + rules.shorten(class_iri) + ")\n" +
           historyOf(map, *overruled.now, json);
  }
  return {};
}

}  // namespace cluxel::tasks
