// SPDX-License-Identifier: Apache-2.0
// Any bytes as a rule file: faults or rules come out, never a crash; what is accepted also runs on an empty scene.
#include <cstddef>
#include <cstdint>
#include <string>

#include "rules/decide/reason.hpp"
#include "rules/language/rule_loader.hpp"

namespace {

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
  cluxel::perception::Scene scene;
  scene.relation_offset = {0};
  scene.cluxels.edge_offset = {0};
  (void)cluxel::rules::reason(scene, *loaded.rules);
  return 0;
}
