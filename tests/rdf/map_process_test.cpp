// SPDX-License-Identifier: Apache-2.0
// Tests with several processes, killed writers and full disks.
#include <signal.h>
#include <sys/resource.h>

#include <random>

#include "rdf/map_file_fixture.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::rdf {
namespace {

using testing::HasSubstr;

TEST_F(MapFile, RefusesASecondWritingProcessAndLetsItWriteAfterwards) {
  create().reset();
  int to_child[2];
  int to_parent[2];
  ASSERT_EQ(::pipe(to_child) | ::pipe(to_parent), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    char byte = 'r';
    {
      const auto environment = open();
      WriteTransaction transaction = environment->write();
      transaction.putBlock("t", "child", "1");
      const bool told = ::write(to_parent[1], &byte, 1) == 1 && ::read(to_child[0], &byte, 1) == 1;
      if (told) transaction.commit();
    }
    ::_exit(0);
  }
  char byte = 0;
  ASSERT_EQ(::read(to_parent[0], &byte, 1), 1);
  {
    const auto environment = open();
    try {
      environment->write();
      ADD_FAILURE() << "two processes write";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::StoreUnavailable);
      EXPECT_THAT(error.what(), HasSubstr("another process is writing"));
    }
    EXPECT_EQ(environment->read().block("t", "child"), std::nullopt);
    ASSERT_EQ(::write(to_child[1], &byte, 1), 1);
    int status = 0;
    ::waitpid(child, &status, 0);
    put(*environment, "parent", "1");
    EXPECT_EQ(environment->read().block("t", "child"), "1");
  }
}

TEST_F(MapFile, IsAnEarlierCommitAfterTheWriterWasKilled) {
  create().reset();
  std::mt19937 random(3);
  for (int round = 0; round < 6; ++round) {
    int pipe_ends[2];
    ASSERT_EQ(::pipe(pipe_ends), 0);
    const pid_t child = ::fork();
    if (child == 0) {
      const auto environment = open();
      for (TermId n = 0;; ++n) {
        WriteTransaction transaction = environment->write();
        QuadWriter writer(transaction);
        const QuadReader reader(transaction);
        const auto count = static_cast<TermId>(reader.size());
        for (TermId i = 1; i <= 500; ++i) writer.add(QuadIds{count + i, 1, i, 0});
        writer.intern(Term::literal("number " + std::to_string(count)));
        writer.flush();
        transaction.putBlock("t", "count", std::to_string(count + 500));
        transaction.commit();
        if (::write(pipe_ends[1], "c", 1) != 1) ::_exit(1);
      }
    }
    char byte = 0;
    for (int commits = 0; commits < 2; ++commits) ASSERT_EQ(::read(pipe_ends[0], &byte, 1), 1);
    ::usleep(static_cast<useconds_t>(random() % 3000));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    ::close(pipe_ends[0]);
    ::close(pipe_ends[1]);
    const auto environment = open();
    const ReadTransaction transaction = environment->read();
    const QuadReader reader(transaction);
    EXPECT_EQ(std::to_string(reader.size()), transaction.block("t", "count"));
    EXPECT_EQ(reader.size() % 500, 0U);
    EXPECT_EQ(reader.termCount(), reader.size() / 500);
    for (const QuadOrder order : {QuadOrder::Posg, QuadOrder::Ospg, QuadOrder::Gspo}) {
      std::uint64_t count = 0;
      QuadCursor cursor = reader.scan({}, order);
      for (QuadIds quad; cursor.next(quad);) ++count;
      EXPECT_EQ(count, reader.size());
    }
  }
}

TEST_F(MapFile, KeepsItsLastCommitWhenTheDiskIsFull) {
  create().reset();
  const int result = inChild([&] {
    const auto environment = open();
    put(*environment, "a", "kept");
    const auto size = std::filesystem::file_size(file_);
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{1U << 20U, 1U << 20U};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    try {
      put(*environment, "b", std::string(8U << 20U, 'x'));
    } catch (const Error& error) {
      if (std::string_view(error.what()).find("no space is left") == std::string_view::npos) return 1;
      return std::filesystem::file_size(file_) == size ? 0 : 3;  // the disk has its room again
    }
    return 2;
  });
  EXPECT_EQ(result, 0);
  EXPECT_EQ(open()->read().block("t", "a"), "kept");
  EXPECT_EQ(open()->read().block("t", "b"), std::nullopt);
}

TEST_F(MapFile, LosesWithTheNextCommitWhatAKilledOneLeftBehindItsLastPage) {
  put(*create(), "a", "kept");
  const auto size = std::filesystem::file_size(file_);
  std::filesystem::resize_file(file_, size + 1'000'000);
  put(*open(), "b", "1");
  EXPECT_LT(std::filesystem::file_size(file_), size + 100'000);
  EXPECT_EQ(open()->read().block("t", "a"), "kept");
}

TEST_F(MapFile, WorksInLittleAddressSpace) {
  create().reset();
#ifdef CLUXEL_SANITIZED
  GTEST_SKIP() << "sanitizers need the address space themselves";
#endif
  const int result = inChild([&] {
    const rlimit limit{4ULL << 30U, 4ULL << 30U};
    ::setrlimit(RLIMIT_AS, &limit);
    const auto environment = open();
    put(*environment, "a", std::string(1U << 20U, 'x'));
    return environment->read().block("t", "a")->size() == 1U << 20U ? 0 : 1;
  });
  EXPECT_EQ(result, 0);
}

}  // namespace
}  // namespace cluxel::rdf
