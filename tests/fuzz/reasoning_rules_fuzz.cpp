// SPDX-License-Identifier: Apache-2.0
// Any bytes as a rule file: faults or rules come out, never a crash; what is accepted also runs on an empty scene.
#include <cstddef>
#include <cstdint>
#include <string>

#include "cluxel/reasoning/reason.hpp"
#include "cluxel/reasoning/rule_loader.hpp"

namespace {

cluxel::ClassCatalogue smallCatalogue() {
  const std::string base = "https://w3id.org/cluxel/ontology#";
  cluxel::ClassCatalogue catalogue;
  for (const char* name : {"TreeTrunk", "TreeTop", "Ground", "Building", "Facade", "Vehicle"})
    catalogue.classes.push_back({base + name, {}, {}});
  catalogue.classes.push_back({base + "Tree", {}, {base + "TreeTrunk", base + "TreeTop"}});
  return catalogue;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const cluxel::ClassCatalogue catalogue = smallCatalogue();
  const std::vector<cluxel::RuleSource> sources{
      {"fuzz.rules.yaml", std::string(reinterpret_cast<const char*>(data), size)}};
  const cluxel::LoadedRules loaded = cluxel::loadRuleTexts(sources, 1, catalogue);
  if (!loaded.rules && !cluxel::hasErrors(loaded.diagnostics)) __builtin_trap();
  for (const cluxel::Diagnostic& diagnostic : loaded.diagnostics) (void)cluxel::format(diagnostic);
  if (!loaded.rules) return 0;
  cluxel::Scene scene;
  scene.relation_offset = {0};
  scene.cluxels.edge_offset = {0};
  (void)cluxel::reason(scene, *loaded.rules);
  return 0;
}
