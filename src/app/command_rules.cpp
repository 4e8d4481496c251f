// SPDX-License-Identifier: Apache-2.0
// `cluxel rules`: checks rule files and runs their tests.
#include "app/command.hpp"
#include "cluxel/base/diagnostic.hpp"
#include "cluxel/base/file_bytes.hpp"
#include "cluxel/mapping/class_catalogue_of.hpp"
#include "cluxel/mapping/map_inputs.hpp"
#include "cluxel/reasoning/rule_loader.hpp"

namespace cluxel::app {

namespace {

struct RulesOptions {
  std::vector<fs::path> files;
  MapInputFiles inputs;
};

Json diagnosticJson(const Diagnostic& diagnostic) {
  return {{"severity", diagnostic.severity == Severity::Error ? "error" : "warning"},
          {"file", diagnostic.location.file}, {"line", diagnostic.location.line},
          {"column", diagnostic.location.column}, {"message", diagnostic.message}, {"hint", diagnostic.hint}};
}

std::vector<fs::path> ruleFiles(const RulesOptions& options, const DataHome& home) {
  std::vector<fs::path> files;
  for (const fs::path& file : options.files) files.push_back(home.locate("rules", file));
  if (files.empty()) files.push_back(home.locate("rules/outdoor.rules.yaml"));
  return files;
}

ExitCode check(const RulesOptions& options, const Session& session) {
  const DataHome home = session.dataHome();
  const ClassCatalogue catalogue = classCatalogueOf(readMapInputs(options.inputs, home).ontology);
  const std::vector<Diagnostic> faults = checkRules(ruleFiles(options, home), catalogue);
  if (session.json) {
    Json json = Json::array();
    for (const Diagnostic& fault : faults) json.push_back(diagnosticJson(fault));
    printJson(json);
  } else {
    print(faults.empty() ? "no faults" : format(faults));
  }
  return hasErrors(faults) ? ExitCode::FaultyInput : ExitCode::Done;
}

}  // namespace

void addRules(CLI::App& app, Session& session) {
  auto options = std::make_shared<RulesOptions>();
  CLI::App* rules = app.add_subcommand("rules", "check and test rules");
  rules->require_subcommand(1);
  CLI::App* checking = rules->add_subcommand("check", "report every fault with file, line and column");
  checking->add_option("files", options->files, "rule files; else rules/outdoor.rules.yaml");
  checking->add_option("--ontology", options->inputs.ontology, "ontology files instead of ontology/*.ttl");
  onRun(*checking, session, [options, &session] { return check(*options, session); });
}

}  // namespace cluxel::app
