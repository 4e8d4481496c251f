// SPDX-License-Identifier: Apache-2.0
// Reads CLI11's tree. A command or option without a group is hidden, as in CLI11's own help.
#include "app/command_table.hpp"

#include <algorithm>
#include <cctype>

namespace cluxel::app {

namespace {

std::string upperCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

OptionEntry entryOf(const CLI::Option& option) {
  OptionEntry entry;
  entry.help = option.get_description();
  entry.is_required = option.get_required();
  entry.is_repeated = option.get_expected_max() > 1;
  if (option.get_positional()) {
    entry.names.push_back(option.get_name(true));
    entry.value = upperCase(entry.names.front());
    return entry;
  }
  for (const std::string& name : option.get_snames()) entry.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) entry.names.push_back("--" + name);
  const bool is_flag = option.get_expected_max() == 0;
  if (!is_flag) entry.value = upperCase(option.get_lnames().empty() ? "value" : option.get_lnames().front());
  return entry;
}

CommandEntry commandOf(const CLI::App& app, const std::string& name) {
  CommandEntry entry{name, app.get_description(), {}, {}, {}};
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group().empty()) continue;
    (option->get_positional() ? entry.arguments : entry.options).push_back(entryOf(*option));
  }
  for (const CLI::App* command : app.get_subcommands(std::function<bool(const CLI::App*)>{}))
    if (!command->get_group().empty())
      entry.commands.push_back(commandOf(*command, name + (name.empty() ? "" : " ") + command->get_name()));
  return entry;
}

void addBelow(const CommandEntry& command, std::vector<const CommandEntry*>& all) {
  all.push_back(&command);
  for (const CommandEntry& next : command.commands) addBelow(next, all);
}

}  // namespace

CommandEntry commandTableOf(const CLI::App& app) {
  return commandOf(app, "");
}

std::vector<const CommandEntry*> flattened(const CommandEntry& program) {
  std::vector<const CommandEntry*> all;
  addBelow(program, all);
  return all;
}

}  // namespace cluxel::app
