// SPDX-License-Identifier: Apache-2.0
// `cluxel documentation`: the man page and shell completion, written at build time from the table of commands.
#include "app/command.hpp"
#include "app/help/man_page.hpp"
#include "app/help/shell_completion.hpp"
#include "cluxel/error.hpp"

namespace cluxel::app {

namespace {

struct DocumentationOptions {
  bool man = false;
  std::string shell;
};

std::string documentationOf(const CommandEntry& program, const DocumentationOptions& options) {
  if (options.man) return manPage(program, "cluxel " CLUXEL_VERSION);
  if (options.shell == "bash") return bashCompletion(program);
  if (options.shell == "zsh") return zshCompletion(program);
  if (options.shell == "fish") return fishCompletion(program);
  throw Error(ErrorKind::InvalidArgument, "documentation: give --man or --completion bash, zsh or fish");
}

}  // namespace

void addDocumentation(CLI::App& app) {
  auto options = std::make_shared<DocumentationOptions>();
  CLI::App* command = app.add_subcommand("documentation", "write the man page or shell completion");
  command->group("");  // hidden: for the build
  CLI::Option* man = command->add_flag("--man", options->man, "the man page, in roff");
  command->add_option("--completion", options->shell, "completion for bash, zsh or fish")->excludes(man);
  command->callback([options, &app] { print(documentationOf(commandTableOf(app), *options)); });
}

}  // namespace cluxel::app
