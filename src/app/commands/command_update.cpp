// SPDX-License-Identifier: Apache-2.0
// `cluxel update`: changes to the operator's statements by SPARQL Update.
#include "app/command.hpp"
#include "app/commands/change_report.hpp"
#include "app/named_sources.hpp"
#include "app/shared_options.hpp"
#include "base/file_bytes.hpp"
#include "mapping/change/map_update.hpp"
#include "rdf/io/rdf_io.hpp"
#include "sparql/syntax/parser.hpp"

namespace cluxel::app {

namespace {

/// What LOAD <iri> reads: the file named for the IRI. Nothing is fetched from the network.
std::vector<Quad> triplesOf(const std::map<std::string, fs::path>& files, const std::string& iri) {
  const auto file = files.find(iri);
  if (file == files.end())
    throw Error(ErrorKind::FaultyInput,
                "LOAD <" + iri + "> is refused: no file is named for it, and nothing is fetched; name it: --load '" +
                    iri + "=FILE'");
  const auto format = rdf::rdfFormatOf(file->second);
  if (!format)
    throw Error(ErrorKind::InvalidArgument,
                "--load: " + file->second.string() + " is not an RDF file (.ttl .nt .nq .trig .rdf)");
  std::vector<Quad> quads;
  const std::string text = readFile(file->second);
  rdf::parseRdf(
      {.text = text, .name = file->second.string(), .format = *format, .base_iri = iri, .graph = Term::iri("")},
      [&quads](const Quad& quad) { quads.push_back(quad); });
  return quads;
}

struct UpdateArguments {
  fs::path map, file;
  std::string text;
  std::vector<std::string> loads;
  std::string base_iri, author;
  BudgetOptions budget;
  bool strict = false, no_prefixes = false, check = false, dry_run = false;
};

sparql::UpdateOptions optionsOf(const UpdateArguments& arguments, const std::string& name) {
  sparql::UpdateOptions options;
  options.query.source_name = name;
  options.query.base_iri = arguments.base_iri;
  if (!arguments.no_prefixes) options.query.prefixes = sparql::mapPrefixes();
  if (arguments.strict) options.query.default_graph = sparql::DefaultGraph::Unnamed;
  options.any_graph_writable = arguments.strict;
  arguments.budget.applyTo(options.query.budget);
  return options;
}

ExitCode checkSyntax(const sparql::QueryOptions& query, const std::string& text) {
  sparql::SparqlParseOptions options;
  options.file = query.source_name;
  options.base_iri = query.base_iri;
  options.prefixes = query.prefixes;
  parseUpdate(text, options);
  return ExitCode::Done;
}

void printReport(const UpdateArguments& arguments, const mapping::MapUpdateReport& report, const Session& session) {
  if (session.json) {
    Json json{{"inserted", report.inserted}, {"deleted", report.deleted}};
    if (arguments.dry_run) json["dry_run"] = true;
    if (report.is_map) json["change"] = changeJson(arguments.map, report.change, arguments.dry_run);
    return printJson(json);
  }
  const bool looked_at_objects = report.change.tiles_decided > 0;
  std::printf("%llu inserted, %llu deleted%s\n", static_cast<unsigned long long>(report.inserted),
              static_cast<unsigned long long>(report.deleted),
              arguments.dry_run && !looked_at_objects ? " (dry run, nothing written)" : "");
  if (looked_at_objects) printChange(arguments.map, report.change, {.dry_run = arguments.dry_run}, session);
}

ExitCode update(const UpdateArguments& arguments, Session& session) {
  const tasks::Question question = questionFrom(arguments.file, arguments.text, session);
  const std::map<std::string, fs::path> loads = namedFiles("--load", arguments.loads);
  sparql::UpdateOptions options = optionsOf(arguments, question.file.string());
  if (arguments.check) return checkSyntax(options.query, question.text);
  if (!loads.empty()) options.load = [&loads](const std::string& iri) { return triplesOf(loads, iri); };
  printReport(arguments,
              mapping::updateMap(arguments.map, question.text, options, session.console,
                                 {.author = authorOr(arguments.author), .dry_run = arguments.dry_run}),
              session);
  return ExitCode::Done;
}

}  // namespace

void addUpdate(CLI::App& app, Session& session) {
  auto options = std::make_shared<UpdateArguments>();
  CLI::App* command = app.add_subcommand("update", "change the operator's statements in a map by SPARQL Update");
  command->add_option("map", options->map, "a map")->required();
  command->add_option("update", options->file, "a file with the update");
  command->add_option("-e,--text", options->text, "the update itself");
  command->add_option("--load", options->loads, "IRI=FILE: the RDF file that LOAD <IRI> reads; others are refused");
  addAuthor(*command, options->author);
  addBudget(*command, options->budget);
  command->add_option("--base", options->base_iri, "base IRI of relative IRIs");
  command->add_flag("--no-prefixes", options->no_prefixes, "know only the prefixes that the update declares");
  command->add_flag(
      "--strict", options->strict,
      "in a store that no build has made: every graph may be written, and the default graph is the unnamed one");
  addDryRun(*command, options->dry_run);
  command->add_flag("--check", options->check, "only check the syntax");
  onRun(*command, session, [options, &session] { return update(*options, session); });
}

}  // namespace cluxel::app
