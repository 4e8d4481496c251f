// SPDX-License-Identifier: Apache-2.0
// `cluxel load` and `cluxel dump`: RDF files into a store, and out of it.
#include <cstdio>

#include "app/command.hpp"
#include "app/commands/change_report.hpp"
#include "app/map_condition.hpp"
#include "app/shared_options.hpp"
#include "base/file_pieces.hpp"
#include "cluxel/error.hpp"
#include "mapping/change/rdf_loading.hpp"
#include "mapping/map_state.hpp"
#include "rdf/file/environment.hpp"
#include "rdf/io/rdf_io.hpp"

namespace cluxel::app {

namespace {

struct LoadOptions {
  fs::path store;
  std::vector<fs::path> files;
  mapping::RdfLoadParams params;
};

struct DumpOptions {
  fs::path store, output;
  std::string graph;
  bool one_graph = false, allow_unfinished = false;
};

ExitCode load(const LoadOptions& options, Session& session) {
  const mapping::RdfLoadReport report =
      mapping::loadRdfFiles(options.store, options.files, options.params, session.console);
  const bool dry_run = options.params.dry_run;
  if (session.json) {
    Json json{{"statements", report.statements}, {"added", report.added}};
    if (dry_run) json["dry_run"] = true;
    if (report.is_map) json["change"] = changeJson(options.store, report.change, dry_run);
    printJson(json);
    return ExitCode::Done;
  }
  const bool looked_at_objects = report.change.tiles_decided > 0;
  std::printf("%llu statements read, %llu of them new%s\n", static_cast<unsigned long long>(report.statements),
              static_cast<unsigned long long>(report.added),
              dry_run && !looked_at_objects ? " (dry run, nothing written)" : "");
  if (looked_at_objects) printChange(options.store, report.change, {.dry_run = dry_run}, session);
  return ExitCode::Done;
}

bool holdsGraph(const rdf::QuadReader& quads, const Term& graph) {
  rdf::QuadPattern pattern;
  pattern.g = quads.idOf(graph);
  rdf::QuadIds quad;
  return pattern.g && quads.scan(pattern).next(quad);
}

ExitCode dump(const DumpOptions& options, Session& session) {
  const rdf::ReadTransaction transaction = rdf::Environment::open(options.store, rdf::OpenMode::ReadOnly)->read();
  noteUnfinished(options.store, !mapping::hasUnfinishedBuild(transaction), options.allow_unfinished, session);
  const rdf::QuadReader quads(transaction);
  const auto graph = options.one_graph ? std::optional(Term::iri(options.graph)) : std::nullopt;
  if (graph && !holdsGraph(quads, *graph))
    throw Error(ErrorKind::NotFound,
                options.store.string() + ": has no quads in " +
                    (options.graph.empty() ? "the unnamed graph" : "graph <" + options.graph + ">"));
  if (options.output.empty()) {
    writeStoredNQuads(quads, graph, [](std::string_view line) { std::fwrite(line.data(), 1, line.size(), stdout); });
    return ExitCode::Done;
  }
  refuseToReplaceMap(options.output);
  writeFileInPieces(options.output, [&](const auto& take) { writeStoredNQuads(quads, graph, take); });
  return ExitCode::Done;
}

}  // namespace

void addLoad(CLI::App& app, Session& session) {
  auto options = std::make_shared<LoadOptions>();
  CLI::App* command = app.add_subcommand("load", "load RDF files into a store, or into graph operator of a map");
  command->add_option("store", options->store, "a map, or a store, which is created when it does not exist")
      ->required();
  command->add_option("files", options->files, "RDF files (.ttl .nt .nq .trig .rdf)")->required();
  command->add_option("--graph", options->params.graph, "graph for statements that name no graph")->check(named());
  command->add_option("--base", options->params.base_iri, "base IRI of relative IRIs; default: the file's own")
      ->check(named());
  addDryRun(*command, options->params.dry_run);
  onRun(*command, session, [options, &session] { return load(*options, session); });
}

void addDump(CLI::App& app, Session& session) {
  auto options = std::make_shared<DumpOptions>();
  CLI::App* command = app.add_subcommand("dump", "write all quads of a map or store as N-Quads, in the store's order");
  command->add_option("store", options->store, "a map or store")->required();
  command->add_option("-o,--output", options->output, "the file to write; default: stdout")->check(named());
  CLI::Option* graph = command->add_option("--graph", options->graph,
                                           "only this graph, as N-Triples; an empty IRI is the unnamed graph");
  mayBeEmpty(*graph);
  addAllowUnfinished(*command, options->allow_unfinished);
  onRun(*command, session, [options, graph, &session] {
    options->one_graph = graph->count() > 0;
    return dump(*options, session);
  });
}

}  // namespace cluxel::app
