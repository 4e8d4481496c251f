// SPDX-License-Identifier: Apache-2.0
// The update, then closure and SPARQL rules; the whole semantic layer only when rules ask the map.
#include "cluxel/mapping/map_update.hpp"

#include <algorithm>

#include "cluxel/base/diagnostic.hpp"
#include "cluxel/knowledge/ontology.hpp"
#include "mapping/map_state.hpp"
#include "mapping/semantic_layer.hpp"
#include "mapping/sparql_rules.hpp"

namespace cluxel {

namespace {

bool asks(const Condition& condition) {
  return condition.kind == Condition::Kind::Ask ||
         std::any_of(condition.operands.begin(), condition.operands.end(), asks);
}

bool anyAsks(const std::vector<Condition>& conditions) { return std::any_of(conditions.begin(), conditions.end(), asks); }

bool asks(const TreeNode& node) {
  if (const auto* branch = std::get_if<BranchNode>(&node.what)) return asks(branch->condition);
  if (const auto* find = std::get_if<FindNode>(&node.what)) return anyAsks(find->where);
  const auto* accept = std::get_if<AcceptLeaf>(&node.what);
  return accept != nullptr && std::any_of(accept->absorb.begin(), accept->absorb.end(),
                                          [](const AbsorbSpec& absorb) { return anyAsks(absorb.when); });
}

bool asks(const Rule& rule) {
  return anyAsks(rule.seed.where) || (rule.group && anyAsks(rule.group->limits)) ||
         std::any_of(rule.nodes.begin(), rule.nodes.end(), [](const TreeNode& node) { return asks(node); });
}

void inferAnew(WriteTransaction& transaction, ProgressSink& sink) {
  const ParsedInputs parsed = parseInputs(storedInputs(transaction));
  const auto& rules = parsed.rules.rules;
  if (std::any_of(rules.begin(), rules.end(), [](const Rule& rule) { return asks(rule); })) {
    TileStages stages(parsed.model, parsed.inputs.params);
    stages.loadAll(transaction);
    writeSemanticLayer(transaction, parsed, stages, sink);
    return;
  }
  inferClosure(transaction);
  runSparqlRules(transaction, parsed.inputs.sparql_rules);
}

}  // namespace

UpdateReport updateMap(const std::filesystem::path& file, const std::string& update, const UpdateOptions& options,
                       ProgressSink& sink) {
  const auto environment = Environment::open(file, OpenMode::ReadWrite);
  WriteTransaction transaction = environment->write();
  const auto state = storedState(transaction);
  if (state && !state->is_finished)
    throw Error(ExitCode::Usage, file.string() + ": its build is unfinished; repeat the build command first");
  const UpdateReport report = runUpdate(transaction, update, options);
  if (state && report.inserted + report.deleted > 0) inferAnew(transaction, sink);
  transaction.commit();
  return report;
}

}  // namespace cluxel
