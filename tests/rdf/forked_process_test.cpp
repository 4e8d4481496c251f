// SPDX-License-Identifier: Apache-2.0
// Tests of a process that was forked while its parent has a map open, as Python's multiprocessing does.
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <functional>
#include <future>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "rdf/file/map_replacement.hpp"
#include "rdf/map_file_fixture.hpp"
#include "rdf/other_process.hpp"

namespace cluxel::rdf {
namespace {

using testing::HasSubstr;

class ForkedProcess : public MapFile {
 protected:
  void SetUp() override { put(*create(), "one", "1"); }

  /// As inChild(); a child that hangs is killed.
  template <typename Work>
  static int inTimelyChild(const Work& work) {
    return inChild([&] {
      ::alarm(30);
      return work();
    });
  }
};

TEST_F(ForkedProcess, OpensTheMapForItself) {
  const auto parents = open();
  EXPECT_EQ(inTimelyChild([&] {
              const auto own = open();
              put(*own, "two", "2");
              return own != parents && own->read().block("t", "one") == "1" ? 0 : 1;
            }),
            0);
  EXPECT_EQ(parents->read().block("t", "two"), "2");
  put(*parents, "three", "3");
  EXPECT_EQ(parents->read().block("t", "three"), "3");
}

TEST_F(ForkedProcess, IsToldThatWhatTheParentOpenedIsNotItsOwn) {
  const auto parents = open();
  EXPECT_EQ(inTimelyChild([&] {
              const std::string reading = refusalOf([&] { parents->read(); });
              const std::string writing = refusalOf([&] { parents->write(); });
              return reading.find("open it again in this process") != std::string::npos && reading == writing ? 0 : 1;
            }),
            0);
  EXPECT_EQ(parents->read().block("t", "one"), "1");
}

/// The thread that writes does not exist in the child.
TEST_F(ForkedProcess, IsRefusedWhileAThreadOfTheParentWritesAndWritesAfterwards) {
  const auto parents = open();
  std::promise<void> has_begun, may_end;
  std::thread writer([&] {
    WriteTransaction transaction = parents->write();
    transaction.putBlock("t", "two", "2");
    has_begun.set_value();
    may_end.get_future().wait();
    transaction.commit();
  });
  has_begun.get_future().wait();
  int refused = -1;
  {
    OtherProcess child([&](const Pause& pause) {
      const std::string refusal = refusalOf([&] { writeMap(file_); });
      pause();
      put(*open(), "three", "3");
      return refusal.find("another process is writing") != std::string::npos ? 0 : 1;
    });
    may_end.set_value();
    writer.join();
    refused = child.end();
  }
  EXPECT_EQ(refused, 0);
  EXPECT_EQ(parents->read().block("t", "two"), "2");
  EXPECT_EQ(parents->read().block("t", "three"), "3");
}

TEST_F(ForkedProcess, OpensAMapAlsoWhenAThreadOfTheParentWasOpeningAndClosing) {
  std::atomic<bool> is_over{false};
  std::thread opening([&] {
    while (!is_over) open(OpenMode::ReadOnly);
  });
  for (int i = 0; i < 20; ++i)
    EXPECT_EQ(inTimelyChild([&] { return open(OpenMode::ReadOnly)->read().block("t", "one") == "1" ? 0 : 1; }), 0);
  is_over = true;
  opening.join();
}

/// The child has copies of the parent's transactions. That they end there must not end them for the parent.
TEST_F(ForkedProcess, LeavesItsParentsSnapshotAsItIs) {
  const std::string old(40'000, 'o');
  auto parents = open();
  put(*parents, "long", old);
  std::optional<ReadTransaction> snapshot(parents->read());
  EXPECT_EQ(inTimelyChild([&] {
              snapshot.reset();
              parents.reset();
              return 0;
            }),
            0);
  EXPECT_EQ(inTimelyChild([&] {
              const auto own = open();
              for (int i = 0; i < 8; ++i) put(*own, "long", std::string(40'000, static_cast<char>('a' + i)));
              return 0;
            }),
            0);
  EXPECT_EQ(snapshot->block("t", "long"), old);
  EXPECT_NE(parents->read().block("t", "long"), old);
}

/// Both would write the same pages.
TEST_F(ForkedProcess, CannotGoOnWithATransactionOfItsParent) {
  auto parents = open();
  WriteTransaction transaction = parents->write();
  transaction.putBlock("t", "two", "2");
  const ReadTransaction snapshot = transaction.before();
  EXPECT_EQ(inTimelyChild([&] {
              const std::string remedy = "open it again in this process";
              const std::vector<std::function<void()>> uses{
                  [&] { transaction.commit(); }, [&] { transaction.putBlock("t", "three", "3"); },
                  [&] { transaction.writeIndexes(); }, [&] { transaction.before(); },
                  [&] { snapshot.block("t", "one"); }};
              for (std::size_t i = 0; i < uses.size(); ++i)
                if (refusalOf(uses[i]).find(remedy) == std::string::npos) return static_cast<int>(i) + 1;
              return 0;
            }),
            0);
  transaction.commit();
  EXPECT_EQ(parents->read().block("t", "two"), "2");
  EXPECT_EQ(parents->read().block("t", "three"), std::nullopt);
}

/// The locks of the parent would live on in its child.
TEST_F(ForkedProcess, WritesAfterItsParentWasKilledWhileItWrote) {
  int from_child[2], to_child[2];
  ASSERT_EQ(::pipe(from_child) | ::pipe(to_child), 0);
  const pid_t parent = ::fork();
  if (parent == 0) {
    ::alarm(30);
    const auto parents = open();
    WriteTransaction transaction = parents->write();
    transaction.putBlock("t", "two", "2");
    const pid_t own = ::getpid();
    if (::fork() != 0) {
      ::kill(own, SIGKILL);
      ::_exit(1);
    }
    ::alarm(30);
    while (::getppid() == own) ::usleep(1000);
    const std::string refusal = refusalOf([&] { put(*open(), "three", "3"); });
    char outcome = refusal == "no refusal" && open()->read().block("t", "two") == std::nullopt ? 'y' : 'n';
    (void)!::write(from_child[1], &outcome, 1);
    ::close(to_child[1]);
    (void)!::read(to_child[0], &outcome, 1);  // the test writes beside it
    ::_exit(0);
  }
  ::close(from_child[1]);
  ::close(to_child[0]);
  int status = 0;
  ::waitpid(parent, &status, 0);
  char outcome = 0;
  EXPECT_EQ(::read(from_child[0], &outcome, 1), 1);
  ::close(from_child[0]);
  EXPECT_EQ(outcome, 'y');
  const auto mine = open();
  put(*mine, "four", "4");
  EXPECT_EQ(mine->read().block("t", "three"), "3");
  ::close(to_child[1]);
}

}  // namespace
}  // namespace cluxel::rdf
