// SPDX-License-Identifier: Apache-2.0
// Each script first finds the command on the line, then offers what the table holds for it.
#include "app/help/shell_completion.hpp"

namespace cluxel::app {

namespace {

/// In single quotes, for bash and zsh.
std::string shellQuoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'')
      result += "'\\''";
    else
      result += c;
  }
  return result + "'";
}

std::string lastWord(const std::string& name) {
  return name.substr(name.rfind(' ') + 1);
}

/// Options of the program that take the next word as their value, so that it is no command: "--home|--threads".
std::string optionsWithValue(const CommandEntry& program) {
  std::string names;
  for (const OptionEntry& option : program.options)
    for (const std::string& name : option.names)
      if (!option.value.empty()) names += (names.empty() ? "" : "|") + name;
  return names;
}

/// Shell code, for bash and zsh: sets `command` to the subcommand that the next word of the line names.
std::string steps(const CommandEntry& program, const std::string& word, const std::string& skip) {
  std::string code = "    case \"$command " + word + "\" in\n";
  for (const CommandEntry* entry : flattened(program))
    if (!entry->name.empty()) {
      const std::string above = entry->name.substr(0, entry->name.size() - lastWord(entry->name).size());
      code += "      " + shellQuoted((above.empty() ? " " : above) + lastWord(entry->name)) +
              ") command=" + shellQuoted(entry->name) + " ;;\n";
    }
  code += "      *)\n        case " + word + " in " + optionsWithValue(program) + ") " + skip + " ;; esac ;;\n";
  return code + "    esac\n";
}

std::vector<OptionEntry> optionsAt(const CommandEntry& program, const CommandEntry& command) {
  std::vector<OptionEntry> options = command.options;
  if (!command.name.empty())  // options of the program may follow the command
    for (const OptionEntry& option : program.options)
      if (option.names.back() != "--help" && option.names.back() != "--version") options.push_back(option);
  return options;
}

std::string fishCondition(const CommandEntry& command) {
  if (command.name.empty()) return "__fish_use_subcommand";
  std::string condition;
  for (std::size_t at = 0; at < command.name.size();) {
    const std::size_t end = std::min(command.name.find(' ', at), command.name.size());
    condition +=
        (condition.empty() ? "" : "; and ") + ("__fish_seen_subcommand_from " + command.name.substr(at, end - at));
    at = end + 1;
  }
  if (command.commands.empty()) return condition;
  condition += "; and not __fish_seen_subcommand_from";
  for (const CommandEntry& next : command.commands) condition += " " + lastWord(next.name);
  return condition;
}

/// In single quotes, for fish.
std::string fishQuoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') result += '\\';
    result += c;
  }
  return result + "'";
}

}  // namespace

std::string bashCompletion(const CommandEntry& program) {
  std::string code =
      "# bash completion for cluxel\n_cluxel() {\n  local current=\"${COMP_WORDS[COMP_CWORD]}\" command='' commands='' "
      "options='' i\n  for ((i = 1; i < COMP_CWORD; ++i)); do\n" +
      steps(program, "${COMP_WORDS[i]}", "((++i))") + "  done\n  case \"$command\" in\n";
  for (const CommandEntry* entry : flattened(program)) {
    std::string commands, options;
    for (const CommandEntry& next : entry->commands) commands += (commands.empty() ? "" : " ") + lastWord(next.name);
    for (const OptionEntry& option : optionsAt(program, *entry))
      for (const std::string& name : option.names) options += (options.empty() ? "" : " ") + name;
    code += "    " + shellQuoted(entry->name) + ") commands=" + shellQuoted(commands) +
            " options=" + shellQuoted(options) + " ;;\n";
  }
  return code +
         "  esac\n  COMPREPLY=()\n  if [[ \"$current\" == -* ]]; then commands=\"$options\"; fi\n"
         "  while IFS= read -r i; do\n    [[ -n \"$i\" ]] && COMPREPLY+=(\"$i\")\n"
         "  done < <(compgen -W \"$commands\" -- \"$current\")\n  return 0\n}\n"
         "complete -o default -F _cluxel cluxel\n";
}

std::string zshCompletion(const CommandEntry& program) {
  std::string code =
      "#compdef cluxel\n_cluxel() {\n  local command=''\n  local -a commands options\n  integer i\n"
      "  for ((i = 2; i < CURRENT; ++i)); do\n" +
      steps(program, "${words[i]}", "((++i))") + "  done\n  case \"$command\" in\n";
  const auto described = [](std::string name, const std::string& help) {
    return "\n        " + shellQuoted(name + ":" + help);
  };
  for (const CommandEntry* entry : flattened(program)) {
    code += "    " + shellQuoted(entry->name) + ")\n      commands=(";
    for (const CommandEntry& next : entry->commands) code += described(lastWord(next.name), next.help);
    code += ")\n      options=(";
    for (const OptionEntry& option : optionsAt(program, *entry))
      for (const std::string& name : option.names) code += described(name, option.help);
    code += ") ;;\n";
  }
  return code +
         "  esac\n  if [[ $PREFIX == -* ]]; then\n    _describe -o option options\n"
         "  elif (( ${#commands} )); then\n    _describe command commands\n  else\n    _files\n  fi\n}\n"
         "_cluxel \"$@\"\n";
}

std::string fishCompletion(const CommandEntry& program) {
  std::string code = "# fish completion for cluxel\n";
  for (const CommandEntry* entry : flattened(program)) {
    const std::string head = "complete -c cluxel -n " + fishQuoted(fishCondition(*entry));
    for (const CommandEntry& next : entry->commands)
      code += head + " -f -a " + lastWord(next.name) + " -d " + fishQuoted(next.help) + "\n";
    for (const OptionEntry& option : optionsAt(program, *entry)) {
      code += head;
      for (const std::string& name : option.names)
        code += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      code += std::string(option.value.empty() ? "" : " -r") + " -d " + fishQuoted(option.help) + "\n";
    }
  }
  return code;
}

}  // namespace cluxel::app
