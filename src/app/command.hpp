// SPDX-License-Identifier: Apache-2.0
// What the subcommands share: the options of the whole program, the console, and how a command hands back its exit
// code.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "cluxel/base/data_home.hpp"
#include "cluxel/base/exit_code.hpp"
#include "cluxel/base/progress.hpp"

namespace cluxel::app {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Progress on a terminal, notes always, both on stderr.
class Console : public ProgressSink {
 public:
  Console();
  ~Console() override;
  void progress(std::string_view stage, std::size_t done, std::size_t total) override;
  void note(std::string_view message) override;

 private:
  void clearLine();
  bool is_terminal_, line_is_open_ = false;
};

/// The state of one run of the program.
struct Session {
  std::string home;
  bool json = false;
  unsigned threads = 0;  ///< 0: as many as the machine has
  Console console;
  ExitCode exit_code = ExitCode::Done;

  DataHome dataHome() const { return DataHome::find(home); }
  unsigned threadCount() const;
};

/// Adds a subcommand whose `run` is called when it was chosen; what it returns becomes the exit code.
void onRun(CLI::App& command, Session& session, std::function<ExitCode()> run);

/// For options that take a number above 0.
CLI::Validator above0();
/// For options that take a share: a number from 0 to 1.
CLI::Validator share();
/// For options that take a whole number of at most 64 bits, as it stands: neither cut off nor wrapped round.
CLI::Validator whole();
/// For names of what is written: the empty one is that of a variable that nobody has set.
CLI::Validator named();

/// Data to stdout, with a line end. A closed pipe is not an error.
void print(std::string_view text);
void printJson(const Json& json);

void addInfo(CLI::App& app, Session& session);
void addSimulate(CLI::App& app, Session& session);
void addRegister(CLI::App& app, Session& session);
void addBuild(CLI::App& app, Session& session);
void addTrain(CLI::App& app, Session& session);
void addQuery(CLI::App& app, Session& session);
void addUpdate(CLI::App& app, Session& session);
void addTasks(CLI::App& app, Session& session);
void addRules(CLI::App& app, Session& session);
void addExplain(CLI::App& app, Session& session);
void addExport(CLI::App& app, Session& session);
void addEvaluate(CLI::App& app, Session& session);
void addUpkeep(CLI::App& app, Session& session);  ///< doctor, compact

}  // namespace cluxel::app
