// SPDX-License-Identifier: Apache-2.0
// Written with the macros of man(7).
#include "app/help/man_page.hpp"

#include "app/exit_code.hpp"

namespace cluxel::app {

namespace {

/// Text as roff reads it: no escapes, no control lines, and hyphens that can be searched for and copied.
std::string roff(const std::string& text) {
  std::string escaped = text.starts_with('.') || text.starts_with('\'') ? "\\&" : "";
  for (const char c : text) {
    if (c == '\\')
      escaped += "\\e";
    else if (c == '-')
      escaped += "\\-";
    else
      escaped += c;
  }
  return escaped;
}

std::string bold(const std::string& text) {
  return "\\fB" + roff(text) + "\\fR";
}
std::string italic(const std::string& text) {
  return "\\fI" + roff(text) + "\\fR";
}

std::string argumentText(const OptionEntry& argument) {
  const std::string name = italic(argument.value) + (argument.is_repeated ? "..." : "");
  return argument.is_required ? name : "[" + name + "]";
}

std::string item(const std::string& tag, const std::string& help) {
  return ".TP\n" + tag + "\n" + roff(help) + "\n";
}

std::string optionItem(const OptionEntry& option) {
  std::string tag;
  for (const std::string& name : option.names) tag += (tag.empty() ? "" : ", ") + bold(name);
  if (!option.value.empty()) tag += " " + italic(option.value);
  return item(tag, option.help + (option.is_required ? " (required)" : ""));
}

std::string commandSection(const CommandEntry& command) {
  std::string usage = bold("cluxel " + command.name);
  if (!command.options.empty()) usage += " [" + italic("options") + "]";
  for (const OptionEntry& argument : command.arguments) usage += " " + argumentText(argument);
  std::string text = ".SS \"cluxel " + roff(command.name) + "\"\n" + usage + "\n.PP\n" + roff(command.help) + "\n";
  for (const OptionEntry& argument : command.arguments) text += item(italic(argument.value), argument.help);
  for (const OptionEntry& option : command.options) text += optionItem(option);
  return text;
}

}  // namespace

std::string manPage(const CommandEntry& program, const std::string& version) {
  std::string text = ".TH CLUXEL 1 \"\" \"" + roff(version) + "\" \"User Commands\"\n";
  text += ".SH NAME\ncluxel \\- semantic maps from laser scans\n";
  text += ".SH SYNOPSIS\n" + bold("cluxel") + " [" + italic("options") + "] " + italic("COMMAND") + " ...\n";
  text += ".SH DESCRIPTION\n" + roff(program.help) +
          "\nData go to standard output; progress, notes and errors go to standard error.\n";
  text += ".SH OPTIONS\nThese may stand before or behind the command.\n";
  for (const OptionEntry& option : program.options) text += optionItem(option);
  text += ".SH COMMANDS\n";
  for (const CommandEntry* command : flattened(program))
    if (command->commands.empty()) text += commandSection(*command);
  text += ".SH EXIT STATUS\n";
  for (const ExitCodeHelp& help : kExitCodeHelp)
    text += item(bold(std::to_string(static_cast<int>(help.code))), help.meaning);
  text += ".SH ENVIRONMENT\n" + item(bold("CLUXEL_HOME"), "the data folder, as --home names it");
  return text;
}

}  // namespace cluxel::app
