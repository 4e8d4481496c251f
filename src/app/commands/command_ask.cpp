// SPDX-License-Identifier: Apache-2.0
// `cluxel ask`, `cluxel tasks` and `cluxel inventory`: the tasks that a map answers by name.
#include "app/command.hpp"
#include "app/map_condition.hpp"
#include "base/ascii.hpp"
#include "cluxel/error.hpp"
#include "tasks/ask/inventory_task.hpp"
#include "tasks/ask/task_table.hpp"

namespace cluxel::app {

namespace {

struct AnswerOutput {
  std::string format;
  bool local = false, geojson = false;
};

tasks::AnswerFormat formatIn(const AnswerOutput& output, const Session& session) {
  if (output.geojson) return tasks::AnswerFormat::GeoJson;
  if (output.format.empty()) return session.json ? tasks::AnswerFormat::Json : tasks::AnswerFormat::Table;
  return *tasks::answerFormatOf(output.format);
}

/// Adds --format, --geojson and --local.
void addAnswerOutput(CLI::App& command, AnswerOutput& output) {
  command.add_option("--format", output.format, "table, csv, json, geojson")
      ->check(oneOf(std::vector<std::string>{"table", "csv", "json", "geojson"}));
  command.add_flag("--geojson", output.geojson, "the same as --format geojson");
  command.add_flag("--local", output.local,
                   "write GeoJSON in metres of the map frame instead of longitude and latitude");
}

/// On stderr, where the form has no place in which people see them.
void noteBesideAnswer(const tasks::TaskAnswer& answer, tasks::AnswerFormat format, Session& session) {
  if (showsNotes(format)) return;
  for (const std::string& note : answer.notes) session.console.note(trimmed(note));  // tables indent lists
}

/// Prints, and tells whether the answer is "no" or has no rows.
ExitCode printAnswer(const mapping::MapReader& map, const tasks::TaskAnswer& answer, const AnswerOutput& output,
                     Session& session) {
  const tasks::ExportFrame frame = output.local ? tasks::ExportFrame::Local : tasks::ExportFrame::LongitudeLatitude;
  const tasks::AnswerFormat format = formatIn(output, session);
  std::string text = answerText(map, answer, format, frame);
  if (text.ends_with('\n')) text.pop_back();  // print() ends the line
  print(text);
  noteBesideAnswer(answer, format, session);
  if (answer.is_negative) return ExitCode::NegativeFinding;
  return answer.rows.empty() ? ExitCode::NoRows : ExitCode::Done;
}

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
  const tasks::TaskAnswer answer = answerOf(task, {map, arguments.why, {}}, values);
  if (arguments.why && !task.has_reasons) session.console.note("the task " + task.name + " gives no reasons");
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

struct InventoryArguments {
  fs::path map, streets, register_file;
  std::vector<std::string> kinds;
  tasks::RegisterParams comparison;
  AnswerOutput output;
  bool allow_unfinished = false;
};

ExitCode inventory(const InventoryArguments& arguments, Session& session) {
  const mapping::MapReader map(arguments.map);
  noteUnfinished(arguments.map, map.isFinished(), arguments.allow_unfinished, session);
  const mapping::MapInputs inputs = map.inputs();
  const rdf::OntologyView ontology = rdf::ontologyViewOf(map.quads());
  const tasks::InventoryParams params = tasks::inventoryOfKinds(map, arguments.kinds);
  if (!arguments.register_file.empty()) {
    const auto entries = tasks::readRegister(arguments.register_file, inputs, ontology);
    return printAnswer(map, registerAnswer(map, params, entries, arguments.comparison), arguments.output, session);
  }
  std::vector<tasks::Street> streets;
  if (!arguments.streets.empty()) streets = tasks::readStreets(arguments.streets, inputs, session.console);
  return printAnswer(map, inventoryAnswer(map, params, streets), arguments.output, session);
}

}  // namespace

void addAsk(CLI::App& app, Session& session) {
  auto options = std::make_shared<AskArguments>();
  CLI::App* command = app.add_subcommand("ask", "run a task on a map, such as route, search or inventory");
  command->add_option("map", options->map, "a map")->required();
  command->add_option("task", options->task, "name of the task; `cluxel tasks` lists all")->required();
  command->add_option("values", options->values, "NAME=VALUE for parameters of the task");
  addAnswerOutput(*command, options->output);
  command->add_flag("--why", options->why, "print the reasons of each row, where the task gives them");
  addAllowUnfinished(*command, options->allow_unfinished);
  onRun(*command, session, [options, &session] { return ask(*options, session); });
}

void addTasks(CLI::App& app, Session& session) {
  CLI::App* command = app.add_subcommand("tasks", "list the tasks that `ask` takes, with parameters and columns");
  onRun(*command, session, [&session] { return listTasks(session); });
}

void addInventory(CLI::App& app, Session& session) {
  auto options = std::make_shared<InventoryArguments>();
  CLI::App* command = app.add_subcommand("inventory", "list signs, lamps, trees, parked vehicles and sidewalks");
  command->add_option("map", options->map, "a map")->required();
  command->add_option("--kind", options->kinds,
                      "a class, ParkingRow or Sidewalk; default: street furniture, trees and both of these");
  command->add_option("--streets", options->streets,
                      "GeoJSON lines with names: each entry gets the name of its nearest street");
  command->add_option("--register", options->register_file,
                      "CSV or GeoJSON of the objects that should be there: compare the map with it");
  command
      ->add_option("--within", options->comparison.within_m, "largest distance between an entry and its object [m, 3]")
      ->check(above0());
  command
      ->add_option("--view", options->comparison.view_m,
                   "a place counts as observed when a scan sees it from within this distance [m, 25]")
      ->check(above0());
  addAnswerOutput(*command, options->output);
  addAllowUnfinished(*command, options->allow_unfinished);
  onRun(*command, session, [options, &session] { return inventory(*options, session); });
}

}  // namespace cluxel::app
