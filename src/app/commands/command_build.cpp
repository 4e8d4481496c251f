// SPDX-License-Identifier: Apache-2.0
// `cluxel build`: makes one map file from scans.
#include "app/command.hpp"
#include "app/shared_options.hpp"
#include "cluxel/error.hpp"
#include "mapping/build/map_builder.hpp"
#include "mapping/statements/statement.hpp"
#include "rdf/io/rdf_io.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::app {

namespace {

struct BuildOptions {
  std::vector<fs::path> inputs;
  fs::path output;
  ScanOptions scans;
  mapping::MapInputFiles files;
  fs::path statements;
  mapping::BuildParams params;
};

std::vector<Quad> statementsIn(const fs::path& file) {
  std::vector<Quad> quads;
  rdf::parseRdf(rdf::readRdfSource(file), [&](const Quad& quad) {
    if (!quad.graph.text.empty() && quad.graph.text != rdf::vocabulary::kGraphOperator)
      throw InputError({.file = file.string()},
                       "has statements of graph <" + quad.graph.text + ">, but --statements takes those of graph <" +
                           std::string(rdf::vocabulary::kGraphOperator) + "> alone, as 'state --export' writes them");
    quads.push_back(quad);
  });
  try {
    mapping::statementsAmong(quads);
  } catch (const Error& fault) {
    throw InputError({.file = file.string()}, fault.what());
  }
  return quads;
}

ExitCode build(const BuildOptions& options, Session& session) {
  const scan::ScanSet scans = scan::ScanSet::open(options.inputs, options.scans.params(), session.console);
  const mapping::MapInputs inputs = readMapInputs(options.files, session.dataHome());
  mapping::BuildParams params = options.params;
  params.threads = session.threadCount();
  if (!options.statements.empty()) params.statements = statementsIn(options.statements);
  const mapping::BuildReport report = buildMap(scans, inputs, options.output, params, session.console);
  if (session.json) {
    printJson(Json{{"map", options.output.string()},
                   {"scans", report.scans},
                   {"points", report.points},
                   {"tiles", report.tiles},
                   {"cluxels", report.cluxels},
                   {"primitives", report.primitives},
                   {"objects", report.objects},
                   {"quads", report.quads},
                   {"scans_already_there", report.scans_already_there}});
    return ExitCode::Done;
  }
  std::printf("%s: %zu scans, %llu points in %zu tiles, %zu cluxels, %zu primitives, %zu objects, %llu quads\n",
              options.output.c_str(), report.scans, static_cast<unsigned long long>(report.points), report.tiles,
              report.cluxels, report.primitives, report.objects, static_cast<unsigned long long>(report.quads));
  return ExitCode::Done;
}

}  // namespace

void addBuild(CLI::App& app, Session& session) {
  auto options = std::make_shared<BuildOptions>();
  CLI::App* command = app.add_subcommand("build", "make a map from scans");
  command->add_option("scans", options->inputs, "files, folders and manifests of scans")->required();
  command->add_option("-o,--output", options->output, "the map file to make")->required()->check(named());
  addScanOptions(*command, options->scans);
  command->add_flag("--register", options->params.refine_poses, "refine the poses first, as the command register does");
  command->add_option("--model", options->files.model, "a trained model: a name in models/, a folder or a file");
  command->add_option("--rules", options->files.rules, "rule files instead of rules/outdoor.rules.yaml");
  command->add_option("--sparql-rules", options->files.sparql_rules, "CONSTRUCT rules instead of rules/*.rq");
  command->add_option("--ontology", options->files.ontology, "ontology files instead of ontology/*.ttl");
  command
      ->add_option("--batch-points", options->params.batch_points, "commit when a batch of scans has this many points")
      ->check(wholeAbove0());
  command->add_option("--statements", options->statements,
                      "an RDF file of operator statements, as the command state exports them");
  CLI::Option* force =
      command->add_flag("--force", options->params.force, "replace a finished map; the operator's statements are kept");
  command
      ->add_flag("--drop-statements", options->params.drop_statements,
                 "with --force: drop the operator's statements too")
      ->needs(force);
  onRun(*command, session, [options, &session] { return build(*options, session); });
}

}  // namespace cluxel::app
