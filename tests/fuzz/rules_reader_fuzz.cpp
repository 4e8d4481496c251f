// SPDX-License-Identifier: Apache-2.0
// Any bytes as a rule file: faults or rules come out, never a crash. What is accepted also decides a small scene:
// competition, evidence, splitting and absorbing give disjoint objects with confidences between 0 and 1.
#include <cstddef>
#include <cstdint>
#include <set>
#include <string>

#include "rules/decide/reason.hpp"
#include "rules/language/rule_loader.hpp"
#include "rules/testing/box_scene.hpp"

namespace {

cluxel::perception::Scene smallScene() {
  using cluxel::scan::PrimitiveLabel;
  cluxel::rules::BoxScene boxes;
  boxes.boxes = {{"floor", PrimitiveLabel::HorizontalPlane, {0, 0, -0.1}, {8, 8, 0.2}, 0, {}, {}},
                 {"wall", PrimitiveLabel::VerticalPlane, {0, 3, 1.5}, {4, 0.3, 3}, 0, {}, {}},
                 {"pole", PrimitiveLabel::Column, {-2, 0, 1}, {0.2, 0.2, 2}, 0, {}, {}},
                 {"trunk", PrimitiveLabel::Column, {2, 0, 1}, {0.3, 0.3, 2}, 0, {}, {}},
                 {"crown", PrimitiveLabel::Scatter, {0, 0, 3}, {5, 3, 2}, 0, {}, {}},
                 {"bin", PrimitiveLabel::SmallStructure, {2.5, 0, 0.5}, {0.5, 0.5, 1}, 0, {}, {}}};
  return cluxel::rules::sceneOfBoxes(boxes).scene;
}

void requireSound(const cluxel::rules::ReasoningResult& result) {
  std::set<cluxel::ContentHash> ids;
  for (const cluxel::rules::SemanticObject& object : result.objects) {
    if (!(object.confidence >= 0 && object.confidence <= 1) || !ids.insert(object.id).second) __builtin_trap();
    if (object.decision >= result.decisions.size()) __builtin_trap();
  }
}

cluxel::rules::ClassCatalogue smallCatalogue() {
  const std::string base = "https://w3id.org/cluxel/ontology#";
  cluxel::rules::ClassCatalogue catalogue;
  for (const char* name : {"TreeTrunk", "TreeTop", "Ground", "Building", "Facade", "Vehicle"})
    catalogue.classes.push_back({base + name, {}, {}});
  catalogue.classes.push_back({base + "Tree", {}, {base + "TreeTrunk", base + "TreeTop"}});
  return catalogue;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const cluxel::rules::ClassCatalogue catalogue = smallCatalogue();
  const std::vector<cluxel::rules::RuleSource> sources{
      {"fuzz.rules.yaml", std::string(reinterpret_cast<const char*>(data), size)}};
  const cluxel::rules::LoadedRules loaded = cluxel::rules::loadRuleTexts(sources, 1, catalogue);
  if (!loaded.rules && !cluxel::hasErrors(loaded.diagnostics)) __builtin_trap();
  for (const cluxel::Diagnostic& diagnostic : loaded.diagnostics) (void)cluxel::format(diagnostic);
  if (!loaded.rules) return 0;
  static const cluxel::perception::Scene scene = smallScene();
  try {
    requireSound(cluxel::rules::reason(scene, *loaded.rules));
  } catch (const cluxel::Error&) {  // a rule set with `ask:` needs an oracle
  }
  return 0;
}
