// SPDX-License-Identifier: Apache-2.0
// `cluxel explain`: the tests that led to a decision, why it was no other, and the smallest change that would reverse
// it.
#include "app/command.hpp"
#include "tasks/explanation.hpp"

namespace cluxel::app {

namespace {

struct ExplainOptions {
  fs::path map;
  std::string name;
};

}  // namespace

void addExplain(CLI::App& app, Session& session) {
  auto options = std::make_shared<ExplainOptions>();
  CLI::App* command = app.add_subcommand("explain", "show why an object or primitive has its class");
  command->add_option("map", options->map, "a map")->required();
  command
      ->add_option("thing", options->name,
                   "an object or primitive: its IRI, the first digits of its hash, or an object's number (17, #17)")
      ->required();
  onRun(*command, session, [options, &session] {
    print(tasks::explainThing(mapping::MapReader(options->map), options->name, session.json));
    return ExitCode::Done;
  });
}

}  // namespace cluxel::app
