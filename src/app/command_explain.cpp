// SPDX-License-Identifier: Apache-2.0
// `cluxel explain`: the way to a decision, why not another, and the least change that would turn it.
#include "app/command.hpp"
#include "cluxel/tasks/explanation.hpp"

namespace cluxel::app {

namespace {

struct ExplainOptions {
  fs::path map;
  std::string name;
};

}  // namespace

void addExplain(CLI::App& app, Session& session) {
  auto options = std::make_shared<ExplainOptions>();
  CLI::App* command = app.add_subcommand("explain", "why an object or a primitive became what it is");
  command->add_option("map", options->map, "a map")->required();
  command->add_option("thing", options->name, "an object or primitive: its IRI, or the first digits of its hash")
      ->required();
  onRun(*command, session, [options, &session] {
    print(explainThing(MapReader(options->map), options->name, session.json));
    return ExitCode::Done;
  });
}

}  // namespace cluxel::app
