// SPDX-License-Identifier: Apache-2.0
// What the subcommands share: the program's options, the console, and how a command returns its exit code.
#pragma once

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "app/console/progress_line.hpp"
#include "app/exit_code.hpp"
#include "app/option_checks.hpp"
#include "base/installation/data_home.hpp"
#include "cluxel/progress.hpp"

namespace cluxel::app {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Progress and notes on stderr. On a terminal, progress is one line that is rewritten. Elsewhere a line is printed
/// now and then; short work prints none.
class Console : public ProgressSink {
 public:
  Console();
  ~Console() override;
  void progress(std::string_view stage, std::size_t done, std::size_t total) override;
  void note(std::string_view message) override;

 private:
  void clearLine();
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  ProgressMeter meter_;
  double last_s_ = 0;  ///< when a line was last written
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

/// Gives a subcommand its `run`, whose result becomes the exit code.
void onRun(CLI::App& command, Session& session, std::function<ExitCode()> run);

/// Data to stdout, with a line end. A closed pipe is not an error.
void print(std::string_view text);
void printJson(const Json& json);
/// In one line, for readers that take line by line.
void printJsonLine(const Json& json);

void addInfo(CLI::App& app, Session& session);
void addSimulate(CLI::App& app, Session& session);
void addRegister(CLI::App& app, Session& session);
void addBuild(CLI::App& app, Session& session);
void addTrain(CLI::App& app, Session& session);
void addQuery(CLI::App& app, Session& session);
void addState(CLI::App& app, Session& session);
void addLoad(CLI::App& app, Session& session);
void addDump(CLI::App& app, Session& session);
void addUpdate(CLI::App& app, Session& session);
void addAsk(CLI::App& app, Session& session);
void addTasks(CLI::App& app, Session& session);
void addRules(CLI::App& app, Session& session);
void addRuleFit(CLI::App& rules, Session& session);        ///< a subcommand of `rules`
void addRuleTrial(CLI::App& rules, Session& session);      ///< subcommands of `rules`
void addRuleTeaching(CLI::App& rules, Session& session);   ///< a subcommand of `rules`
void addRuleReference(CLI::App& rules, Session& session);  ///< a subcommand of `rules`
void addExplain(CLI::App& app, Session& session);
void addExport(CLI::App& app, Session& session);
void addView(CLI::App& app, Session& session);
void addEvaluate(CLI::App& app, Session& session);
void addChange(CLI::App& app, Session& session);  ///< extend, retract, repose, merge
void addWatch(CLI::App& app, Session& session);
void addWays(CLI::App& app, Session& session);  ///< route, reach, costmap, search
void addChanges(CLI::App& app, Session& session);
void addInventory(CLI::App& app, Session& session);
void addServe(CLI::App& app, Session& session);
void addUpkeep(CLI::App& app, Session& session);  ///< doctor, compact
void addDocumentation(CLI::App& app);             ///< hidden: the man page and shell completion

}  // namespace cluxel::app
