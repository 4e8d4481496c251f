// SPDX-License-Identifier: Apache-2.0
// The catalogue of the reasoning tests, written out so that they do not depend on the ontology's loader.
#include "rules/reasoning_fixture.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
using namespace rules;

std::string clx(const std::string& name) {
  return "https://w3id.org/cluxel/ontology#" + name;
}

ClassCatalogue outdoorCatalogue() {
  const std::vector<std::pair<std::string, std::vector<std::string>>> concepts{
      {"Ground", {}},
      {"Building", {"Facade", "Roof"}},
      {"Tree", {"TreeTrunk", "TreeTop"}},
      {"UtilityPole", {"PoleMast", "PoleCrossarm"}},
      {"Wire", {}},
      {"TrafficLight", {"TrafficLightPole", "TrafficLightHead"}},
      {"StreetLamp", {"LampPole", "LampHead"}},
      {"StreetSign", {"SignPole", "SignPlate"}},
      {"Vehicle", {}},
      {"Person", {}},
      {"Pole", {}},
      {"Bush", {}},
      {"SmallObject", {}}};
  ClassCatalogue catalogue;
  catalogue.classes.push_back({clx("Object"), {}, {}});
  for (const auto& [name, parts] : concepts) {
    ClassEntry entry{clx(name), {clx("Object")}, {}};
    for (const std::string& part : parts) {
      entry.parts.push_back(clx(part));
      catalogue.classes.push_back({clx(part), {}, {}});
    }
    catalogue.classes.push_back(entry);
  }
  catalogue.classes.push_back({clx("Barrier"), {clx("SmallObject")}, {}});
  return catalogue;
}

LoadedRules loadText(const std::string& text, const ClassCatalogue& catalogue) {
  const std::vector<RuleSource> sources{{"rules.yaml", text}};
  return loadRuleTexts(sources, 1, catalogue);
}

RuleSet rulesOf(const std::string& order, const std::string& body) {
  LoadedRules loaded = loadText(
      "apiVersion: cluxel.rules/v1\n"
      "prefixes: { clx: \"https://w3id.org/cluxel/ontology#\" }\n"
      "order: " +
      order + "\nrules:\n" + body);
  EXPECT_TRUE(loaded.rules.has_value()) << format(loaded.diagnostics);
  return loaded.rules.value_or(RuleSet{});
}

}  // namespace cluxel::testing
