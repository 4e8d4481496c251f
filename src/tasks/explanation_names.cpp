// SPDX-License-Identifier: Apache-2.0
// Statements change the class of an object, not what the rules said of it.
#include "tasks/explanation_names.hpp"

#include <filesystem>
#include <string>

namespace cluxel::tasks {

void shortenFiles(rules::Decision& decision, const mapping::MapInputs& inputs) {
  if (inputs.rules.empty()) return;
  const std::filesystem::path folder = std::filesystem::path(inputs.rules.front().name).parent_path();
  const auto shorten = [&](std::string& name) { name = mapping::nameWithin(folder, name).string(); };
  for (rules::DecisionStep& step : decision.path) shorten(step.file);
  for (rules::EvidenceStep& step : decision.evidence) shorten(step.file);
}

void shortenFiles(rules::Explanation& explanation, const mapping::MapInputs& inputs) {
  for (rules::ExplainedDecision& explained : explanation.decisions) shortenFiles(explained.decision, inputs);
}

mapping::MapPart withObjectsByRules(const mapping::MapReader& map, mapping::MapPart part) {
  for (const mapping::OverruledObject& overruled : map.overruled())
    for (rules::SemanticObject& object : part.objects)
      if (overruled.now == object.id) object.rule_id = overruled.by_rules.rule_id;
  return part;
}

}  // namespace cluxel::tasks
