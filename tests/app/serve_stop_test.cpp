// SPDX-License-Identifier: Apache-2.0
// How `cluxel serve` stops while a task runs.
#include <memory>
#include <vector>

#include "app/serve_fixture.hpp"

namespace cluxel::app {
namespace {

/// A data home with one more question, which takes longer than any test.
fs::path homeWithEndlessTask(const fs::path& home) {
  fs::create_directories(home / "queries");
  for (const auto& entry : fs::directory_iterator(test::sourceFolder()))
    if (entry.path().filename() != "queries") fs::create_symlink(entry.path(), home / entry.path().filename());
  for (const auto& entry : fs::directory_iterator(test::sourceFolder() / "queries"))
    fs::create_symlink(entry.path(), home / "queries" / entry.path().filename());
  writeFile(home / "queries" / "endless.rq",
            "#! title: Is there no end?\n#! column: n [1] how many\n"
            "SELECT (COUNT(*) AS ?n) { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i FILTER(?c != ?f && ?i != ?a) }\n");
  return home;
}

/// Whether `holds` does within some seconds.
bool comes(const std::function<bool()>& holds) {
  for (int i = 0; i < 400; ++i) {
    if (holds()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return false;
}

TEST_F(ServeCommand, ASignalIsHeardWhileATaskRunsAndASecondEndsIt) {
  const fs::path home = homeWithEndlessTask(path("home"));
  Served served((test::buildFolder() / "cluxel").string() + " --home " + home.string() +
                    " --threads 1 serve --port 0 --quiet --deadline 600 --running 1 --queue 0 " +
                    path("map.clx").string(),
                path("stop.log"));
  std::vector<std::unique_ptr<Connection>> askers;  // one of them finds the service free between two looks at it
  ASSERT_TRUE(comes([&] {
    askers.push_back(std::make_unique<Connection>(served.port()));
    askers.back()->send("GET /tasks/endless HTTP/1.1\r\nHost: localhost\r\n\r\n");
    return served.get("/maps").status == 503;
  })) << "the task runs";
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));  // the service looks for new commits once a second
  served.signal(SIGTERM);
  EXPECT_TRUE(comes([&] { return !Connection(served.port()).isOpen(); })) << "no new connections";
  EXPECT_TRUE(served.isRunning()) << "the task goes on";
  served.signal(SIGTERM);
  EXPECT_TRUE(comes([&] { return !served.isRunning(); })) << "the second signal ends it";
}

}  // namespace
}  // namespace cluxel::app
