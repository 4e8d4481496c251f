// SPDX-License-Identifier: Apache-2.0
// The program `cluxel`: parses the command line, runs one subcommand, turns errors into messages and exit codes.
#include <fcntl.h>
#include <malloc.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <new>

#include "app/command.hpp"
#include "app/console/remedy_hint.hpp"
#include "app/console/usage_fault.hpp"
#include "app/help/version_text.hpp"
#include "base/utf8.hpp"
#include "cluxel/error.hpp"

namespace {

using namespace cluxel;
using namespace cluxel::app;

std::string exitCodesText() {
  std::string text = "Exit codes:";
  for (const ExitCodeHelp& help : kExitCodeHelp)
    text +=
        (help.code == ExitCode::Done ? " " : "; ") + std::to_string(static_cast<int>(help.code)) + " " + help.meaning;
  return text + ".";
}

int fail(ExitCode code, const char* message) {
  std::fprintf(stderr, "cluxel: %s\n", withoutControls(message).c_str());
  return static_cast<int>(code);
}

void addCommands(CLI::App& app, Session& session) {
  addInfo(app, session);
#ifdef CLUXEL_SIMULATION
  addSimulate(app, session);
#endif
  addRegister(app, session);
  addBuild(app, session);
  addChange(app, session);
  addWatch(app, session);
  addQuery(app, session);
  addState(app, session);
  addUpdate(app, session);
  addLoad(app, session);
  addDump(app, session);
  addAsk(app, session);
  addTasks(app, session);
  addExplain(app, session);
  addRules(app, session);
  addTrain(app, session);
  addEvaluate(app, session);
  addExport(app, session);
  addWays(app, session);
  addInventory(app, session);
  addChanges(app, session);
  addServe(app, session);
  addView(app, session);
  addUpkeep(app, session);
  addDocumentation(app);
}

int runProgram(int argc, char** argv) {
  Session session;
  CLI::App app("Cluxel turns registered laser scans of outdoor places into semantic maps.");
  app.footer(exitCodesText());
  app.require_subcommand(1);
  app.set_version_flag("--version", versionText, "print version, commit and formats");
  app.add_option("--home", session.home, "folder with ontology, rules, queries, models and labels")
      ->check(CLI::ExistingDirectory);
  app.add_option("--threads", session.threads, "threads to use (0: all); the result does not depend on it")
      ->check(wholeWithin({.min = 0, .max = 1024}));
  app.fallthrough();
  addCommands(app, session);
  refuseEmptyValues(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& fault) {
    if (fault.get_exit_code() == 0) return app.exit(fault);
    return fail(ExitCode::Usage, usageMessage(app, fault).c_str());
  }
  return static_cast<int>(session.exit_code);
}

/// The descriptor of a closed standard stream would be reused for the next file, so that messages could be written into
/// a map. It is opened in the opposite direction instead: using it fails as if it were closed, and lostData() sees it.
void occupyStandardStreams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(stream, F_GETFD) < 0) ::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

/// Stages take and free arrays of megabytes for each tile. By default the C library gives such memory back at once, and
/// the kernel clears every page of the next array anew: some 3 % of an extension by one scan. With a half and a quarter
/// of these thresholds an extension by 48 scans takes 4 % longer.
void reuseFreedMemory() {
  constexpr int kMebibyte = 1 << 20;
  ::mallopt(M_MMAP_THRESHOLD, 32 * kMebibyte);
  ::mallopt(M_TRIM_THRESHOLD, 256 * kMebibyte);
  ::mallopt(M_TOP_PAD, 4 * kMebibyte);
}

/// Data that could not be written is an error, except when the reader of a pipe has gone.
bool lostData() {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return false;
  struct stat status {};
  const bool is_known = ::fstat(STDOUT_FILENO, &status) == 0;
  return !is_known || !(S_ISFIFO(status.st_mode) || S_ISSOCK(status.st_mode));
}

}  // namespace

int main(int argc, char** argv) {
  occupyStandardStreams();
  reuseFreedMemory();
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a file that becomes larger than allowed (ulimit -f) is an error of its write
  try {
    const int code = runProgram(argc, argv);
    if (lostData())
      return fail(ExitCode::StoreUnavailable, "stdout could not be written completely: is the disk full?");
    return code;
  } catch (const Error& error) {
    return fail(exitCodeOf(error.kind()), messageOf(error).c_str());
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(ExitCode::FaultyInput, messageOf(error).c_str());
  } catch (const std::bad_alloc&) {
    return fail(ExitCode::BudgetExceeded, "not enough memory");
  } catch (const std::exception& error) {
    return fail(ExitCode::FaultyInput, error.what());
  }
}
