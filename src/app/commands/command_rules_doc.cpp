// SPDX-License-Identifier: Apache-2.0
// `cluxel rules doc`: the reference of attributes, relations, measures and rules.
#include "app/command.hpp"
#include "app/shared_options.hpp"
#include "cluxel/error.hpp"
#include "mapping/facts/map_oracle.hpp"
#include "mapping/map_inputs.hpp"
#include "rules/language/rule_loader.hpp"
#include "tasks/rule_reference/rule_reference.hpp"

namespace cluxel::app {

namespace {

struct ReferenceOptions {
  std::vector<fs::path> files, maps;
  fs::path out;
};

ExitCode writeReference(const ReferenceOptions& options, const Session& session) {
  refuseToReplaceMap(options.out);
  const DataHome home = session.dataHome();
  std::vector<fs::path> files;
  for (const fs::path& file : options.files) files.push_back(home.locateFile("rules", file, ".rules.yaml"));
  if (files.empty()) files.push_back(home.locate("rules/outdoor.rules.yaml"));
  const rules::ClassCatalogue catalogue = mapping::classCatalogueOf(mapping::readMapInputs({}, home).ontology);
  const rules::RuleSet rules = loadRules(files, catalogue, mapping::withCheckedQueries()).require();
  tasks::MeasuredClasses measured;
  for (const fs::path& file : options.maps) measured.add(mapping::MapReader(file));
  const std::string text = referenceOf(rules, measured);
  if (options.out.empty())
    print(text);
  else
    writeOutput(options.out, text);
  return ExitCode::Done;
}

}  // namespace

void addRuleReference(CLI::App& rules, Session& session) {
  auto options = std::make_shared<ReferenceOptions>();
  CLI::App* reference =
      rules.add_subcommand("doc", "write the reference of attributes, relations and rules (Markdown)");
  reference->add_option("files", options->files, "rule files; default: rules/outdoor.rules.yaml");
  reference->add_option("--maps", options->maps, "finished maps: their objects are measured by class");
  reference->add_option("-o,--out", options->out, "write it to this file instead of standard output")->check(named());
  onRun(*reference, session, [options, &session] { return writeReference(*options, session); });
}

}  // namespace cluxel::app
