// SPDX-License-Identifier: Apache-2.0
// `cluxel explain`: the tests that led to a decision, why it was no other, and the smallest change that would reverse
// it.
#include "app/command.hpp"
#include "app/map_condition.hpp"
#include "tasks/explanation.hpp"

namespace cluxel::app {

namespace {

struct ExplainOptions {
  fs::path map;
  std::string name;
  bool allow_unfinished = false;
};

}  // namespace

void addExplain(CLI::App& app, Session& session) {
  auto options = std::make_shared<ExplainOptions>();
  CLI::App* command = app.add_subcommand("explain", "show why an object or primitive has its class");
  command->add_option("map", options->map, "a map")->required();
  command
      ->add_option("object", options->name,
                   "an object or primitive: its IRI, the first digits of its hash, or an object's number (17, #17)")
      ->required();
  addAllowUnfinished(*command, options->allow_unfinished);
  onRun(*command, session, [options, &session] {
    const mapping::MapReader map(options->map);
    noteUnfinished(options->map, map.isFinished(), options->allow_unfinished, session);
    print(tasks::explainThing(map, options->name, session.json));
    return ExitCode::Done;
  });
}

}  // namespace cluxel::app
