// SPDX-License-Identifier: Apache-2.0
// stdout is data, stderr is progress and notes.
#include <unistd.h>

#include <cstdio>
#include <thread>

#include "app/command.hpp"
#include "base/utf8.hpp"

namespace cluxel::app {

Console::Console() : is_terminal_(isatty(STDERR_FILENO) == 1) {}
Console::~Console() {
  clearLine();
}

void Console::clearLine() {
  if (line_is_open_) std::fputs("\r\033[K", stderr);
  line_is_open_ = false;
}

void Console::progress(std::string_view stage, std::size_t done, std::size_t total) {
  constexpr double kTerminalPause_s = 0.1, kPlainPause_s = 30;
  const double now_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  const std::string line = meter_.line(stage, done, total, now_s);
  const bool is_due = now_s - last_s_ >= (is_terminal_ ? kTerminalPause_s : kPlainPause_s);
  if (!is_due && !(is_terminal_ && done == total)) return;
  last_s_ = now_s;
  clearLine();
  std::fprintf(stderr, is_terminal_ ? "%s" : "%s\n", line.c_str());
  std::fflush(stderr);
  line_is_open_ = is_terminal_;
}

void Console::note(std::string_view message) {
  clearLine();
  std::fprintf(stderr, "note: %s\n", withoutControls(message).c_str());
}

unsigned Session::threadCount() const {
  return threads > 0 ? threads : std::max(1U, std::thread::hardware_concurrency());
}

void onRun(CLI::App& command, Session& session, std::function<ExitCode()> run) {
  command.add_flag("--json", session.json, "print JSON");
  command.callback([&session, run = std::move(run)] { session.exit_code = run(); });
}

void print(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stdout);
  if (text.empty() || text.back() != '\n') std::fputc('\n', stdout);
}

void printJson(const Json& json) {
  print(json.dump(2, ' ', false, Json::error_handler_t::replace));
}

void printJsonLine(const Json& json) {
  print(json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace cluxel::app
