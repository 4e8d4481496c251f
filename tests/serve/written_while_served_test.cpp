// SPDX-License-Identifier: Apache-2.0
// Clients ask, and hang up, while threads of the same process extend, retract and update the served map.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <future>
#include <mutex>
#include <thread>
#include <vector>

#include "cluxel/error.hpp"
#include "mapping/change/map_change.hpp"
#include "mapping/small_campus.hpp"
#include "serve/http/http_server.hpp"
#include "serve/http_client.hpp"
#include "serve/map_service.hpp"

namespace cluxel::serve {
namespace {

const std::string kWriterToken = "a token of 16 and more characters";

std::string getOf(const std::string& target) {
  return "GET " + target + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n";
}

std::string updateOf(const std::string& text) {
  return "POST /sparql HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nAuthorization: Bearer " + kWriterToken +
         "\r\nContent-Type: application/sparql-update\r\nContent-Length: " + std::to_string(text.size()) + "\r\n\r\n" +
         text;
}

/// Of each kind of request, with layers, spatial indexes, points and the page.
std::vector<std::string> targetsWhileWriting() {
  return {"/sparql?query=SELECT%20%2A%20%7B%3Fs%20a%20%3Fc%20.%20%3Fs%20geo%3AhasGeometry%20%3Fg%7D",
          "/tasks/route?from=0,0&to=3,2",
          "/tasks/costmap",
          "/tasks/inventory",
          "/tasks/trees",
          "/objects/%230/explanation",
          "/objects/%230/points",
          "/objects",
          "/tiles/0/0",
          "/tiles/-1/0",
          "/page",
          "/graph?default",
          "/questions/trees"};
}

int statusOf(const std::string& response) {
  return response.size() < 12 ? 0 : std::stoi(response.substr(9, 3));
}

/// A map of the first scans of a campus, and the service of it.
class WrittenWhileServed : public testing::Test {
 protected:
  void SetUp() override {
    buildMap(mapping::scansOf({campus.files()[0], campus.files()[1]}), mapping::shippedInputs(), file, {.threads = 2},
             mapping::silence());
    ServiceOptions options;
    options.load.running = 4;
    options.load.patience = std::chrono::minutes(5);
    options.token = kWriterToken;
    options.page = [](const mapping::MapReader& map, const std::string&) {
      return std::to_string(map.scene().primitives.size()) + " of " + std::to_string(map.objects().size());
    };
    service =
        std::make_unique<MapService>(std::vector<MapArgument>{{"map", file}}, DataHome(test::sourceFolder()), options);
    server = std::make_unique<HttpServer>(HttpOptions{},
                                          [this](const HttpRequest& request) { return service->handle(request); });
    run = std::async(std::launch::async, [this] { server->run(); });
  }
  std::string answerTo(const std::string& request) const {
    const Client client(server->port());
    client.send(request);
    return client.rest();
  }
  /// Does `work` again and again until the writers have ended.
  void beside(const std::function<void(std::size_t)>& work) {
    threads.emplace_back([this, work] {
      for (std::size_t i = 0; !is_over; ++i) work(i);
    });
  }

  const mapping::SmallCampus campus{{.seed = 3, .stops = 3, .size_m = 50, .points_per_stop = 1000}};
  const rdf::ScratchFolder folder;
  const std::filesystem::path file = folder.path() / "served.clx";
  std::unique_ptr<MapService> service;
  std::unique_ptr<HttpServer> server;
  std::future<void> run;
  std::atomic<bool> is_over = false;
  std::vector<std::thread> threads;
};

TEST_F(WrittenWhileServed, ClientsGetAnswersAndTheMapStaysThatOfItsInputs) {
  const std::string before = mapping::canonicalText(file);
  const std::vector<std::string> targets = targetsWhileWriting();
  for (const std::string& target : targets) EXPECT_EQ(statusOf(answerTo(getOf(target))), 200) << target;
  std::mutex failures_mutex;
  std::vector<std::string> failures;
  const auto requireAnswer = [&](const std::string& request, const std::string& response) {
    for (const int known : {200, 404, 409})
      if (statusOf(response) == known) return;
    const std::lock_guard lock(failures_mutex);
    failures.push_back(request + response);
  };
  for (std::size_t thread = 0; thread < 4; ++thread)
    beside([&, thread](std::size_t i) {
      const std::string request = getOf(targets[(i * 5 + thread * 3) % targets.size()]);
      requireAnswer(request, answerTo(request));
    });
  beside([&](std::size_t i) {  // hangs up in the middle
    const Client client(server->port());
    const std::string request = getOf(targets[i % targets.size()]);
    client.send(i % 3 == 0 ? request.substr(0, request.size() / 2) : request);
    std::this_thread::sleep_for(std::chrono::milliseconds(i % 7));
  });
  beside([&](std::size_t) {
    for (const char* what : {"INSERT", "DELETE"}) {
      const std::string request =
          updateOf(what + std::string(" DATA { GRAPH <") + std::string(rdf::vocabulary::kGraphOperator) +
                   "> { <https://e.org/a> rdfs:label \"a\" } }");
      requireAnswer(request, answerTo(request));
    }
  });
  beside([&](std::size_t) {
    service->tidy();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  });
  const scan::ScanSet added = mapping::scansOf({campus.files()[2]});
  const scan::ScanId id = added.load(0).id;
  for (int round = 0; round < 2; ++round) {
    mapping::extendMap(file, added, {.threads = 2}, mapping::silence());
    mapping::retractScans(file, {id}, {.threads = 2}, mapping::silence());
  }
  is_over = true;
  for (std::thread& thread : threads) thread.join();
  server->stop();
  run.get();
  EXPECT_THAT(failures, testing::IsEmpty());
  EXPECT_EQ(mapping::canonicalText(file), before);
}

}  // namespace
}  // namespace cluxel::serve
