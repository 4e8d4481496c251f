// SPDX-License-Identifier: Apache-2.0
// A map in a process that was forked while a thread of its parent reads or writes the map, as Python's multiprocessing
// does.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <future>
#include <thread>

#include "api/facade_campus.hpp"

namespace cluxel {
namespace {

/// The exit status of `work` in a child process; a child that hangs is killed.
template <typename Work>
int inChild(const Work& work) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::alarm(60);
    int result = 99;
    try {
      result = work();
    } catch (const std::exception&) {
    }
    ::_exit(result);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

/// Stops the change at its first report.
class WaitingSink : public ProgressSink {
 public:
  void progress(std::string_view, std::size_t, std::size_t) override {
    if (has_begun_) return;
    has_begun_ = true;
    begun.set_value();
    may_go_on.get_future().wait();
  }
  std::promise<void> begun, may_go_on;

 private:
  bool has_begun_ = false;
};

class ForkedMap : public ::testing::Test {
 protected:
  static std::size_t countOf(const Map& map) { return map.query("SELECT * { ?s <http://e/p> ?o }").size(); }

  rdf::ScratchFolder folder;
  Map map = FacadeCampus::shared().copyIn(folder.path());
};

TEST_F(ForkedMap, IsReadAndWrittenByTheChildAfterAThreadOfTheParentHadBegunToWrite) {
  const std::string one = "INSERT DATA { <http://e/one> <http://e/p> 1 }";
  const std::size_t objects = map.objects().size();
  WaitingSink sink;
  ChangeOptions dry_run;
  dry_run.dry_run = true;
  std::thread writer([&] { map.retract({map.clouds().front().id}, dry_run, sink); });
  sink.begun.get_future().wait();
  int child_status = -1;
  std::thread other([&] {
    child_status = inChild([&] {
      if (map.objects().size() != objects) return 1;
      try {
        map.update(one);
        return 5;
      } catch (const Error& error) {
        if (error.kind() != ErrorKind::StoreUnavailable) return 2;  // the parent is writing
      }
      try {
        Map::open(map.file()).update(one);
        return 6;
      } catch (const Error& error) {
        if (error.kind() != ErrorKind::StoreUnavailable) return 3;
      }
      return map.summary().objects == objects ? 0 : 4;
    });
  });
  other.join();
  EXPECT_EQ(child_status, 0);
  sink.may_go_on.set_value();
  writer.join();
  EXPECT_EQ(inChild([&] { return map.update(one).inserted == 1 && countOf(map) == 1 ? 0 : 1; }), 0);
  EXPECT_EQ(countOf(map), 1U);
}

TEST_F(ForkedMap, IsReadByChildrenWhileThreadsOfTheParentReadAndWrite) {
  std::atomic<bool> is_over{false};
  std::thread reader([&] {
    while (!is_over) map.summary();
  });
  std::thread writer([&] {
    for (int i = 0; !is_over; ++i) map.update("INSERT DATA { <http://e/" + std::to_string(i) + "> <http://e/q> 1 }");
  });
  for (int i = 0; i < 10; ++i)
    EXPECT_EQ(inChild([&] { return map.summary().objects > 0 && countOf(map) == 0 ? 0 : 1; }), 0);
  is_over = true;
  reader.join();
  writer.join();
}

}  // namespace
}  // namespace cluxel
