// SPDX-License-Identifier: Apache-2.0
// `cluxel ask` and `cluxel tasks`: the tasks that a map answers by name.
#include "app/answer_output.hpp"
#include "app/command.hpp"
#include "app/unfinished_note.hpp"
#include "cluxel/error.hpp"
#include "tasks/ask/task_table.hpp"

namespace cluxel::app {

namespace {

struct AskArguments {
  fs::path map;
  std::string task;
  std::vector<std::string> values;
  AnswerOutput output;
  bool why = false, allow_unfinished = false;
};

tasks::NamedValues valuesOf(const std::vector<std::string>& texts) {
  tasks::NamedValues values;
  for (const std::string& text : texts) {
    const std::size_t cut = text.find('=');
    if (cut == std::string::npos || cut == 0)
      throw Error(ErrorKind::InvalidArgument, "'" + text + "': write a parameter as NAME=VALUE");
    values.emplace_back(text.substr(0, cut), text.substr(cut + 1));
  }
  return values;
}

ExitCode ask(const AskArguments& arguments, Session& session) {
  const std::vector<tasks::Task> all = tasksOf(tasks::shippedQuestions(session.dataHome()));
  const tasks::Task& task = taskNamed(all, arguments.task);
  const tasks::TaskValues values(task.parameters, valuesOf(arguments.values));
  const mapping::MapReader map(arguments.map);
  noteUnfinished(arguments.map, map.isFinished(), arguments.allow_unfinished, session);
  tasks::TaskAnswer answer = task.run({map, arguments.why, {}}, values);
  if (answer.columns.empty()) answer.columns = task.columns;
  if (arguments.why && !task.has_reasons) session.console.note("note: the task " + task.name + " gives no reasons");
  return printAnswer(map, answer, arguments.output, session);
}

std::string unitText(const std::string& unit) {
  return unit.empty() ? "" : " [" + unit + "]";
}

void printTask(const tasks::Task& task) {
  std::printf("%s\n  %s\n", task.name.c_str(), task.title.c_str());
  for (const tasks::TaskParameter& p : task.parameters)
    std::printf("  %s=%s  (%s%s)%s %s\n", p.name.c_str(), p.default_value.empty() ? "…" : p.default_value.c_str(),
                nameOf(p.kind),
                p.is_required  ? ", required"
                : p.may_repeat ? ", may be repeated"
                               : "",
                unitText(p.unit).c_str(), p.help.c_str());
  for (const tasks::QueryColumn& c : task.columns)
    std::printf("    %s%s: %s\n", c.name.c_str(), unitText(c.unit).c_str(), c.help.c_str());
}

ExitCode listTasks(const Session& session) {
  const std::vector<tasks::Task> all = tasksOf(tasks::shippedQuestions(session.dataHome()));
  if (session.json) {
    print(taskListJson(all));
    return ExitCode::Done;
  }
  for (const tasks::Task& task : all) printTask(task);
  return ExitCode::Done;
}

}  // namespace

void addAsk(CLI::App& app, Session& session) {
  auto options = std::make_shared<AskArguments>();
  CLI::App* command = app.add_subcommand("ask", "have a map answer one of its tasks");
  command->add_option("map", options->map, "a map")->required();
  command->add_option("task", options->task, "a name that `cluxel tasks` lists")->required();
  command->add_option("values", options->values, "NAME=VALUE for parameters of the task");
  addAnswerOutput(*command, options->output);
  command->add_flag("--why", options->why, "the reasons of each row, where the task gives them");
  addAllowUnfinished(*command, options->allow_unfinished);
  onRun(*command, session, [options, &session] { return ask(*options, session); });
}

void addTasks(CLI::App& app, Session& session) {
  CLI::App* command = app.add_subcommand("tasks", "list the tasks that `ask` takes, with parameters and columns");
  onRun(*command, session, [&session] { return listTasks(session); });
}

}  // namespace cluxel::app
