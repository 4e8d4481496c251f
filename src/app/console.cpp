// SPDX-License-Identifier: Apache-2.0
// stdout is data, stderr is progress and notes.
#include <unistd.h>

#include <cstdio>
#include <thread>

#include "app/command.hpp"

namespace cluxel::app {

Console::Console() : is_terminal_(isatty(STDERR_FILENO) == 1) {}
Console::~Console() { clearLine(); }

void Console::clearLine() {
  if (line_is_open_) std::fputs("\r\033[K", stderr);
  line_is_open_ = false;
}

void Console::progress(std::string_view stage, std::size_t done, std::size_t total) {
  if (!is_terminal_) return;
  clearLine();
  std::fprintf(stderr, "%.*s %zu/%zu", static_cast<int>(stage.size()), stage.data(), done, total);
  std::fflush(stderr);
  line_is_open_ = true;
}

void Console::note(std::string_view message) {
  clearLine();
  std::fprintf(stderr, "note: %.*s\n", static_cast<int>(message.size()), message.data());
}

unsigned Session::threadCount() const {
  return threads > 0 ? threads : std::max(1U, std::thread::hardware_concurrency());
}

void onRun(CLI::App& command, Session& session, std::function<ExitCode()> run) {
  command.add_flag("--json", session.json, "print JSON");
  command.callback([&session, run = std::move(run)] { session.exit_code = run(); });
}

CLI::Validator above0() {
  const auto fault = [](std::string& text) {
    double value = 0;
    const bool is_number = CLI::detail::lexical_cast(text, value);
    return is_number && value > 0 ? std::string() : "write a number above 0, not " + text;
  };
  return {fault, "ABOVE 0", "above0"};
}

void print(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stdout);
  if (text.empty() || text.back() != '\n') std::fputc('\n', stdout);
}

void printJson(const Json& json) { print(json.dump(2, ' ', false, Json::error_handler_t::replace)); }

}  // namespace cluxel::app
