// SPDX-License-Identifier: Apache-2.0
// After the update, closure and SPARQL rules are computed again; the whole semantic layer only when rules use `ask:`.
#include "mapping/build/map_update.hpp"

#include <chrono>

#include "cluxel/error.hpp"
#include "mapping/facts/semantic_layer.hpp"
#include "mapping/map_state.hpp"
#include "rdf/file/map_replacement.hpp"

namespace cluxel::mapping {

void inferAfterUpdate(rdf::WriteTransaction& transaction, ProgressSink& sink) {
  const ParsedInputs parsed = parseInputs(storedInputs(transaction));
  if (parsed.rules.asks_map) {
    TileStages stages(parsed.model, parsed.inputs.params);
    stages.loadAll(transaction);
    writeSemanticLayer(transaction, parsed, stages, 1, sink);
    return;
  }
  inferFacts(transaction, parsed.inputs, sink);
}

sparql::UpdateReport updateMap(const std::filesystem::path& file, const std::string& update,
                               const sparql::UpdateOptions& options, ProgressSink& sink) {
  const auto start = std::chrono::steady_clock::now();
  rdf::WriteTransaction transaction = rdf::writeMap(file);
  const bool is_map = requireFinished(file, transaction);
  if (is_map && options.any_graph_writable)
    throw Error(ErrorKind::InvalidArgument, file.string() +
                                                ": is a map, of which only the operator's statements may be "
                                                "written; a store that no build has made is open");
  const sparql::UpdateReport report = runUpdate(transaction, update, options);
  if (is_map && report.inserted + report.deleted > 0) inferAfterUpdate(transaction, sink);
  const auto& deadline = options.query.budget.deadline;
  if (deadline && std::chrono::steady_clock::now() - start > *deadline)
    throw Error(ErrorKind::BudgetExceeded,
                "update: its budget of time is exceeded by what had to be inferred; nothing was changed");
  transaction.commit();
  for (const Diagnostic& warning : report.warnings) sink.note(format(warning));
  return report;
}

}  // namespace cluxel::mapping
