// SPDX-License-Identifier: Apache-2.0
// `cluxel serve`: maps over HTTP, until SIGINT or SIGTERM.
#include <algorithm>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <future>
#include <mutex>
#include <system_error>
#include <thread>

#include "app/command.hpp"
#include "app/map_condition.hpp"
#include "app/shared_options.hpp"
#include "app/stop_signals.hpp"
#include "base/file_bytes.hpp"
#include "base/utc_time.hpp"
#include "cluxel/error.hpp"
#include "serve/http/http_server.hpp"
#include "serve/map_service.hpp"
#include "tasks/view/view_page.hpp"

namespace cluxel::app {

namespace {

struct ServeArguments {
  std::vector<std::string> maps, origins;
  std::string host = "127.0.0.1";
  int port = 8080;
  fs::path token_file, log;
  double deadline_s = 30, rate = 0;
  std::uint64_t max_rows = 0, max_memory_mib = 1024, max_answer_mib = 256, max_request_kib = 1024;
  std::uint64_t page_points = 5'000'000;
  std::size_t running = 0, queue = 128, connections = 256;
  bool quiet = false, allow_unfinished = false;
};

/// Lines of requests, to a file or to stderr.
class AccessLines {
 public:
  explicit AccessLines(const ServeArguments& arguments) : name_(arguments.log.string()) {
    if (arguments.quiet) return;
    refuseToReplaceMap(arguments.log);
    file_ = arguments.log.empty() ? stderr : std::fopen(arguments.log.c_str(), "ae");
    if (file_ == nullptr)
      throw Error(ErrorKind::StoreUnavailable, arguments.log.string() + ": the access log cannot be written");
  }
  ~AccessLines() {
    if (file_ != nullptr && file_ != stderr) std::fclose(file_);
  }
  AccessLines(const AccessLines&) = delete;
  AccessLines& operator=(const AccessLines&) = delete;

  void write(const serve::AccessEntry& entry) {
    if (file_ == nullptr) return;
    constexpr std::size_t max_target = 2000;
    std::string target = entry.target.substr(0, max_target);
    for (char& c : target)
      if (static_cast<unsigned char>(c) <= ' ' || c == '"' || c == '\x7f') c = '?';
    const std::lock_guard lock(mutex_);
    std::fprintf(file_, "%s %s \"%s %s\" %d %zu %.1f ms\n", dateTimeText(secondsNow()).c_str(), entry.client.c_str(),
                 entry.method.c_str(), target.c_str(), entry.status, entry.bytes, entry.seconds * 1000);
    const bool is_written = std::fflush(file_) == 0 && std::ferror(file_) == 0;
    if (!is_written) tellFailure(errno);
    is_failing_ = !is_written;
    std::clearerr(file_);
  }

 private:
  /// Once, until lines are written again. Requests are answered all the same.
  void tellFailure(int code) const {
    if (!is_failing_ && file_ != stderr)
      std::fprintf(stderr, "note: %s: the access log cannot be written (%s); requests are served without it\n",
                   name_.c_str(), std::generic_category().message(code).c_str());
  }

  std::string name_;
  std::FILE* file_ = nullptr;
  std::mutex mutex_;
  bool is_failing_ = false;  ///< the last line could not be written
};

std::string tokenIn(const fs::path& file) {
  constexpr std::size_t min_length = 16;
  if (file.empty()) return {};
  std::string token = readFile(file);
  while (!token.empty() && std::isspace(static_cast<unsigned char>(token.back())) != 0) token.pop_back();
  const bool is_plain = std::all_of(token.begin(), token.end(), [](unsigned char c) { return c > ' ' && c < 0x7f; });
  if (token.size() < min_length || !is_plain)
    throw Error(ErrorKind::FaultyInput, file.string() +
                                            ": a token has at least 16 visible ASCII characters on one line; "
                                            "'openssl rand -hex 32' prints one");
  return token;
}

/// The page of `cluxel view`; absent when the page's program has not been built.
std::function<std::string(const mapping::MapReader&, const std::string&)> pageMaker(const DataHome& home,
                                                                                    std::uint64_t max_points) {
  std::string program;
  try {
    program = tasks::viewTemplate(home);
  } catch (const Error&) {
    return {};
  }
  return [program, max_points, questions = tasks::shippedQuestions(home)](const mapping::MapReader& map,
                                                                          const std::string& name) {
    tasks::ViewOptions options;
    options.name = name;
    options.is_served = true;
    options.max_points = max_points;
    std::string page;
    writeViewPage(map, program, questions, options, [&page](std::string_view piece) { page.append(piece); });
    return page;
  };
}

bool isLoopback(const std::string& host) {
  return host == "localhost" || host == "::1" || host.starts_with("127.");
}

serve::ServiceOptions serviceOptions(const ServeArguments& arguments, const Session& session) {
  serve::ServiceOptions options;
  options.request.deadline = std::chrono::milliseconds(static_cast<std::int64_t>(arguments.deadline_s * 1000));
  options.request.max_rows = arguments.max_rows;
  options.request.max_memory_bytes = arguments.max_memory_mib << 20U;
  options.request.max_answer_bytes = arguments.max_answer_mib << 20U;
  options.load.running = arguments.running > 0 ? arguments.running : session.threadCount();
  options.load.waiting = arguments.queue;
  options.load.per_second = arguments.rate;
  options.warns_of_unfinished = !arguments.allow_unfinished;
  options.token = tokenIn(arguments.token_file);
  options.allowed_origins = arguments.origins;
  options.page = pageMaker(session.dataHome(), arguments.page_points);
  if (isLoopback(arguments.host)) options.host_names = {"localhost", "127.0.0.1", "[::1]", arguments.host};
  return options;
}

serve::HttpOptions httpOptions(const ServeArguments& arguments) {
  serve::HttpOptions options;
  options.host = arguments.host;
  options.port = arguments.port;
  options.max_connections = arguments.connections;
  options.max_body_bytes = arguments.max_request_kib << 10U;
  return options;
}

void announce(const serve::HttpServer& server, const ServeArguments& arguments, Session& session) {
  const bool is_v6 = arguments.host.find(':') != std::string::npos;
  const std::string url =
      "http://" + (is_v6 ? "[" + arguments.host + "]" : arguments.host) + ":" + std::to_string(server.port()) + "/";
  if (session.json)
    printJson(Json{{"url", url}, {"port", server.port()}});
  else
    print(url);
  std::fflush(stdout);
  if (!isLoopback(arguments.host))
    session.console.note("the service can be reached from other machines; what it answers is not encrypted");
}

/// Releases old commits once a second, in a thread of its own: it may have to wait, and a signal must not.
class Housekeeper {
 public:
  explicit Housekeeper(serve::MapService& service)
      : thread_([&service, ended = ended_.get_future()] {
          while (ended.wait_for(std::chrono::seconds(1)) != std::future_status::ready) service.tidy();
        }) {}
  ~Housekeeper() {
    ended_.set_value();
    thread_.join();
  }
  Housekeeper(const Housekeeper&) = delete;
  Housekeeper& operator=(const Housekeeper&) = delete;

 private:
  std::promise<void> ended_;
  std::thread thread_;
};

ExitCode serveMaps(const ServeArguments& arguments, Session& session) {
  AccessLines lines(arguments);
  serve::MapService service(serve::mapArgumentsOf(arguments.maps), session.dataHome(),
                            serviceOptions(arguments, session));
  for (const fs::path& map : service.unfinishedMaps()) noteUnfinished(map, false, arguments.allow_unfinished, session);
  auto signals = std::make_unique<StopSignals>();
  serve::HttpServer server(
      httpOptions(arguments), [&service](const serve::HttpRequest& request) { return service.handle(request); },
      [&lines](const serve::AccessEntry& entry) { lines.write(entry); });
  announce(server, arguments, session);
  const Housekeeper housekeeper(service);
  std::future<void> served = std::async(std::launch::async, [&server] { server.run(); });
  const auto hasEnded = [&served] { return served.wait_for(std::chrono::seconds(0)) == std::future_status::ready; };
  while (!signals->arrived(std::chrono::seconds(1)) && !hasEnded()) {
  }
  signals.reset();
  server.stop();
  served.get();  // throws what ended the server before
  return ExitCode::Done;
}

}  // namespace

void addServe(CLI::App& app, Session& session) {
  auto options = std::make_shared<ServeArguments>();
  CLI::App* command = app.add_subcommand("serve", "answer SPARQL and JSON requests over HTTP");
  command->add_option("maps", options->maps, "maps, each FILE or NAME=FILE")->required();
  command
      ->add_option("--host", options->host,
                   "the address to listen on; any other than 127.0.0.1 can be reached from other machines")
      ->check(named());
  command->add_option("--port", options->port, "the port to listen on; 0: a free one")
      ->check(wholeWithin({.min = 0, .max = 65535}));
  command->add_option("--token-file", options->token_file,
                      "a file with the token that permits updates; without it updates are refused");
  command->add_option("--cors", options->origins, "an origin whose web pages may read answers; *: all origins");
  command->add_option("--log", options->log, "a file to append the access log to, instead of stderr");
  addAllowUnfinished(*command, options->allow_unfinished);
  command->add_flag("--quiet", options->quiet, "write no access log");
  command->add_option("--deadline", options->deadline_s, "seconds after which a query is given up")
      ->check(within({.min = 0.001, .max = 1e9}));
  command->add_option("--max-rows", options->max_rows, "rows above which a query is given up")->check(wholeAbove0());
  command->add_option("--max-memory", options->max_memory_mib, "MiB above which a query is given up")
      ->check(wholeWithin({.min = 1, .max = 1 << 24}));
  command
      ->add_option("--page-points", options->page_points,
                   "points of a map's page; those that it leaves out come when the camera is near")
      ->check(wholeAbove0());
  command->add_option("--max-answer", options->max_answer_mib, "MiB above which an answer is given up")
      ->check(wholeWithin({.min = 1, .max = 1 << 24}));
  command->add_option("--max-request", options->max_request_kib, "KiB above which the body of a request is refused")
      ->check(wholeWithin({.min = 1, .max = 1 << 24}));
  command->add_option("--rate", options->rate, "requests per second of one client; more are refused")->check(above0());
  command->add_option("--running", options->running, "requests that are computed at the same time; default: --threads")
      ->check(wholeWithin({.min = 1, .max = 1024}));
  command->add_option("--queue", options->queue, "requests that wait in the queue; more are refused")
      ->check(wholeWithin({.min = 0, .max = 1 << 16}));
  command->add_option("--connections", options->connections, "open connections; more are refused")
      ->check(wholeWithin({.min = 1, .max = 900}));
  onRun(*command, session, [options, &session] { return serveMaps(*options, session); });
}

}  // namespace cluxel::app
