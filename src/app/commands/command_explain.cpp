// SPDX-License-Identifier: Apache-2.0
// `cluxel explain`: the tests that led to a decision, why other classes were rejected, and the smallest change that
// would reverse the decision.
#include "app/command.hpp"
#include "app/map_condition.hpp"
#include "base/utf8.hpp"
#include "cluxel/error.hpp"
#include "tasks/explanation.hpp"
#include "tasks/thing_names.hpp"

namespace cluxel::app {

namespace {

struct ExplainOptions {
  fs::path map;
  std::string name, why_not;
  bool dot = false, allow_unfinished = false;
};

ExitCode explainOne(const ExplainOptions& options, Session& session) {
  if (options.dot && session.json) throw Error(ErrorKind::InvalidArgument, "--dot and --json: choose one of them");
  const mapping::MapReader map(options.map);
  noteUnfinished(options.map, map.isFinished(), options.allow_unfinished, session);
  if (const std::string note = tasks::nameNote(map, options.name); !note.empty()) session.console.note(note);
  if (options.dot) {
    print(tasks::explanationGraph(map, options.name, options.why_not));
  } else {
    const tasks::ExplanationTexts texts = options.why_not.empty()
                                              ? tasks::explainThing(map, options.name)
                                              : tasks::explainWhyNot(map, options.name, options.why_not);
    print(session.json ? texts.json : withoutControls(texts.text));
  }
  return ExitCode::Done;
}

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
  command->add_option("--why-not", options->why_not,
                      "how near the rules of this class come to accepting it, and which tests fail");
  command->add_flag("--dot", options->dot,
                    "print the rule's tree as a Graphviz graph, with the path of the decision in bold");
  onRun(*command, session, [options, &session] { return explainOne(*options, session); });
}

}  // namespace cluxel::app
