// SPDX-License-Identifier: Apache-2.0
// The update, then closure and SPARQL rules; the whole semantic layer only when rules ask the map.
#include "cluxel/mapping/map_update.hpp"

#include "cluxel/base/diagnostic.hpp"
#include "cluxel/knowledge/map_replacement.hpp"
#include "cluxel/knowledge/ontology.hpp"
#include "mapping/map_state.hpp"
#include "mapping/semantic_layer.hpp"
#include "mapping/sparql_rules.hpp"

namespace cluxel {
namespace {

void inferAnew(WriteTransaction& transaction, ProgressSink& sink) {
  const ParsedInputs parsed = parseInputs(storedInputs(transaction));
  if (parsed.rules.asks_map) {
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
  WriteTransaction transaction = writeMap(file);
  const auto state = storedState(transaction);
  if (state && !state->is_finished)
    throw Error(ExitCode::Usage, file.string() + ": its build is unfinished; repeat the build command first");
  const UpdateReport report = runUpdate(transaction, update, options);
  if (state && report.inserted + report.deleted > 0) inferAnew(transaction, sink);
  transaction.commit();
  return report;
}

}  // namespace cluxel
