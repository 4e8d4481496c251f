// SPDX-License-Identifier: Apache-2.0
// CLI11 only says that an argument was not expected; this names the nearest expected one.
#include "app/console/usage_fault.hpp"

#include <algorithm>

#include "base/nearest_name.hpp"
#include "tasks/ask/task_table.hpp"

namespace cluxel::app {

namespace {

using Names = std::vector<std::string>;

/// The command that was reached, with its place: "rules check"; empty for the program itself.
struct Reached {
  const CLI::App* command;
  std::string name;

  std::string prefix() const { return name.empty() ? "" : name + ": "; }
};

Reached reachedIn(const CLI::App& app) {
  Reached reached{&app, {}};
  for (auto chosen = app.get_subcommands(); !chosen.empty(); chosen = reached.command->get_subcommands()) {
    reached.command = chosen.front();
    reached.name += (reached.name.empty() ? "" : " ") + chosen.front()->get_name();
  }
  return reached;
}

Names commandsOf(const CLI::App& app) {
  Names names;
  for (const CLI::App* command : app.get_subcommands(std::function<bool(const CLI::App*)>{}))
    if (!command->get_group().empty()) names.push_back(command->get_name());  // without group: hidden
  return names;
}

Names optionsOf(const CLI::App& app) {
  Names names;
  for (const CLI::App* at = &app; at != nullptr; at = at->get_parent())
    for (const CLI::Option* option : at->get_options())
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

std::string didYouMean(const std::string& name, const Names& known) {
  const auto nearest = nearestName(name, known);
  return nearest ? "; did you mean '" + *nearest + "'?" : "";
}

/// CLI11 says "--label: At Most 1 required but received 2".
std::string withoutRepetition(const std::string& what) {
  constexpr std::string_view kRepeated = ": At Most 1 required but received ";
  const std::size_t at = what.find(kRepeated);
  if (at == std::string::npos) return what;
  return what.substr(0, at) + " is given " + what.substr(at + kRepeated.size()) + " times; give it once";
}

std::string unexpected(const std::string& argument, const Reached& reached) {
  if (argument.starts_with('-')) {
    const std::string option = argument.substr(0, argument.find('='));
    const Names known = optionsOf(*reached.command);
    if (std::find(known.begin(), known.end(), option) != known.end())
      return "the option '" + option + "' belongs after the command: 'cluxel " + reached.name + " ... " + option + "'";
    return "there is no option '" + option + "'" + didYouMean(option, known);
  }
  const Names commands = commandsOf(*reached.command);
  if (commands.empty()) return "'" + argument + "' is one argument too many";
  const auto tasks = tasks::tasksOf({});
  const bool is_task = std::any_of(tasks.begin(), tasks.end(), [&](const auto& task) { return task.name == argument; });
  if (is_task) return "'" + argument + "' is a task, no command: 'cluxel ask MAP " + argument + "'";
  return "there is no command '" + argument + "'" + didYouMean(argument, commands) +
         "\n  commands: " + listed(commands);
}

}  // namespace

std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

std::string usageMessage(const CLI::App& app, const CLI::ParseError& fault) {
  const Reached reached = reachedIn(app);
  const Names extras = app.remaining(true);
  std::string what = withoutRepetition(fault.what());
  const bool is_incomplete = dynamic_cast<const CLI::RequiredError*>(&fault) != nullptr;
  if (!extras.empty())
    what = unexpected(extras.front(), reached);
  else if (const Names commands = commandsOf(*reached.command); is_incomplete && !commands.empty())
    what = "a command is missing: " + listed(commands);
  const std::string help = "cluxel " + reached.name + (reached.name.empty() ? "" : " ") + "--help";
  return reached.prefix() + what + "\n  hint: '" + help + "' shows what it takes";
}

}  // namespace cluxel::app
