// SPDX-License-Identifier: Apache-2.0
// The commands and options of the program as values, read from CLI11's tree: the man page and shell completion are
// written from them.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace cluxel::app {

struct OptionEntry {
  std::vector<std::string> names;  ///< "-o", "--output"; of a positional argument its name: "scans"
  std::string value;               ///< "OUTPUT"; empty for a flag
  std::string help;
  bool is_required = false, is_repeated = false;
};

struct CommandEntry {
  std::string name;  ///< "rules check"; empty for the program
  std::string help;
  std::vector<OptionEntry> arguments;  ///< positional ones, in their order
  std::vector<OptionEntry> options;
  std::vector<CommandEntry> commands;  ///< without hidden ones
};

CommandEntry commandTableOf(const CLI::App& app);

/// The program and all commands below it. Each stands before its subcommands.
std::vector<const CommandEntry*> flattened(const CommandEntry& program);

}  // namespace cluxel::app
