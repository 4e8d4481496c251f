// SPDX-License-Identifier: Apache-2.0
// After the update, closure and SPARQL rules are computed again; the whole semantic layer only when rules use `ask:`.
#include "mapping/build/map_update.hpp"

#include "cluxel/error.hpp"
#include "mapping/facts/semantic_layer.hpp"
#include "mapping/map_state.hpp"
#include "rdf/store/map_replacement.hpp"

namespace cluxel::mapping {
namespace {

void inferAnew(rdf::WriteTransaction& transaction, ProgressSink& sink) {
  const ParsedInputs parsed = parseInputs(storedInputs(transaction));
  if (parsed.rules.asks_map) {
    TileStages stages(parsed.model, parsed.inputs.params);
    stages.loadAll(transaction);
    writeSemanticLayer(transaction, parsed, stages, sink);
    return;
  }
  inferFacts(transaction, parsed.inputs, sink);
}

}  // namespace

sparql::UpdateReport updateMap(const std::filesystem::path& file, const std::string& update,
                               const sparql::UpdateOptions& options, ProgressSink& sink) {
  rdf::WriteTransaction transaction = rdf::writeMap(file);
  const auto state = storedState(transaction);
  if (state && !state->is_finished)
    throw Error(ErrorKind::InvalidArgument,
                file.string() + ": its build is unfinished; repeat the build command first");
  const sparql::UpdateReport report = runUpdate(transaction, update, options);
  if (state && report.inserted + report.deleted > 0) inferAnew(transaction, sink);
  transaction.commit();
  for (const Diagnostic& warning : report.warnings) sink.note(format(warning));
  return report;
}

}  // namespace cluxel::mapping
