// SPDX-License-Identifier: Apache-2.0
// Builds beside other builds, updates, files of killed builds and foreign files: nothing is lost or mixed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <lmdb.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <functional>
#include <thread>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "mapping/change/map_update.hpp"
#include "mapping/map_state.hpp"
#include "mapping/small_campus.hpp"
#include "rdf/file/map_check.hpp"

namespace cluxel::mapping {

using namespace scan;
using namespace perception;
using namespace simulation;
using namespace rdf;
using namespace sparql;
using namespace rules;
namespace {
namespace fs = std::filesystem;
using Files = std::vector<fs::path>;
/// Calls a function when a stage reports a given count.
class DoAt : public ProgressSink {
 public:
  DoAt(std::string stage, std::size_t done, std::function<void()> action)
      : stage_(std::move(stage)), done_(done), action_(std::move(action)) {}
  void progress(std::string_view stage, std::size_t done, std::size_t) override {
    if (stage == stage_ && done == done_ && action_) std::exchange(action_, nullptr)();
  }

 private:
  std::string stage_;
  std::size_t done_;
  std::function<void()> action_;
};

std::string statement(const std::string& name) {
  return "<https://example.org/" + name + "> a <https://w3id.org/cluxel/ontology#Tree>";
}

class UnfinishedBuild : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    campus = new SmallCampus({.seed = 5, .stops = 2, .size_m = 45, .points_per_stop = 1500});
    inputs = new MapInputs(shippedInputs());
    expected = new std::string(builtText(campus->files(), *inputs));
  }
  static void TearDownTestSuite() {
    delete campus;
    delete inputs;
    delete expected;
  }
  fs::path map() const { return folder.path() / "map.clx"; }
  fs::path building() const { return folder.path() / "map.clx.building"; }
  BuildReport build(const BuildParams& params = {}, ProgressSink& sink = silence()) const {
    return buildMap(scansOf(campus->files()), *inputs, map(), params, sink);
  }
  /// The message of a build that must fail.
  std::string refusal(ErrorKind code, const BuildParams& params = {}, const Files& files = campus->files(),
                      ProgressSink& sink = silence()) const {
    try {
      buildMap(scansOf(files), *inputs, map(), params, sink);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), code) << error.what();
      return error.what();
    }
    ADD_FAILURE() << "was not refused";
    return "";
  }
  void state(const std::string& name, const fs::path& file) const {
    updateMap(file, "INSERT DATA { " + statement(name) + " }", {}, silence());
  }
  void takeBack(const std::string& name) const {
    updateMap(map(), "DELETE DATA { GRAPH <https://w3id.org/cluxel/graph/operator> { " + statement(name) + " } }", {},
              silence());
  }
  bool isStated(const std::string& name) const {
    return canonicalText(map()).find("<https://example.org/" + name + ">") != std::string::npos;
  }
  /// Builds in a process that is killed (SIGKILL) while scan `at` is added.
  void buildAndBeKilled(std::size_t at, BuildParams params = {}) const {
    params.batch_points = 1;
    const pid_t child = ::fork();
    if (child == 0) {
      DoAt sink("scans", at, [] { ::kill(::getpid(), SIGKILL); });
      build(params, sink);
      ::_exit(0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status)) << "the build was not killed";
  }

  ScratchFolder folder;
  static inline SmallCampus* campus = nullptr;
  static inline MapInputs* inputs = nullptr;
  static inline std::string* expected = nullptr;
};

/// A build in another process that blocks in its first scan until it is released.
class WaitingBuild {
 public:
  explicit WaitingBuild(const std::function<void(ProgressSink&)>& build) {
    if ((::pipe(to_child_) | ::pipe(to_parent_)) != 0) std::abort();
    process_ = ::fork();
    if (process_ == 0) {
      char byte = 'r';
      DoAt sink("scans", 1, [&] { (void)!::write(to_parent_[1], &byte, 1), (void)!::read(to_child_[0], &byte, 1); });
      int result = 0;
      try {
        build(sink);
      } catch (...) {
        result = 1;
      }
      ::_exit(result);
    }
    char byte = 0;
    (void)!::read(to_parent_[0], &byte, 1);
  }
  pid_t process() const { return process_; }
  int goOnAndEnd() {
    (void)!::write(to_child_[1], "g", 1);
    int status = 0;
    ::waitpid(process_, &status, 0);
    return status;
  }

 private:
  pid_t process_ = 0;
  int to_child_[2] = {}, to_parent_[2] = {};
};

TEST_F(UnfinishedBuild, OfTwoBuildsAtOnceTheSecondIsToldOfTheFirst) {
  for (const bool force : {false, true}) {
    const BuildParams params{.force = force};
    WaitingBuild first([&](ProgressSink& sink) { build(params, sink); });
    const std::string message = refusal(ErrorKind::StoreUnavailable, params);
    EXPECT_NE(message.find("process " + std::to_string(first.process())), std::string::npos) << message;
    if (force) {
      EXPECT_EQ(canonicalText(map()), *expected) << "the old map stays until the new one is whole";
    }
    EXPECT_EQ(first.goOnAndEnd(), 0);
    EXPECT_EQ(canonicalText(map()), *expected);
    EXPECT_FALSE(fs::exists(building()));
    EXPECT_FALSE(fs::exists(map().string() + ".build-lock"));
  }
}

TEST_F(UnfinishedBuild, UpdatesOfTheOldMapDuringABuildOfItsSuccessorAreKept) {
  build();
  state("old", map());
  state("taken_back", map());
  WaitingBuild successor([&](ProgressSink& sink) { build({.force = true}, sink); });
  state("new", map());
  takeBack("taken_back");
  EXPECT_EQ(successor.goOnAndEnd(), 0);
  EXPECT_TRUE(isStated("old"));
  EXPECT_TRUE(isStated("new"));
  EXPECT_FALSE(isStated("taken_back"));
}

TEST_F(UnfinishedBuild, AFinishedSuccessorThatWasNotMovedYetBecomesTheMap) {
  build();
  state("kept", map());
  fs::rename(map(), building());
  EXPECT_EQ(build().scans_already_there, 2U);
  EXPECT_TRUE(isStated("kept"));
  EXPECT_FALSE(fs::exists(building()));
}

TEST_F(UnfinishedBuild, AFinishedSuccessorTakesTheStatementsThatTheMapHasNow) {
  build();
  state("then", map());
  fs::copy_file(map(), building());
  takeBack("then");
  state("now", map());
  build({.force = true});
  EXPECT_TRUE(isStated("now"));
  EXPECT_FALSE(isStated("then"));
  EXPECT_FALSE(fs::exists(building()));
}

TEST_F(UnfinishedBuild, ASuccessorOfOtherInputsIsNotThrownAway) {
  build();
  fs::rename(map(), building());
  MapInputs others = *inputs;
  others.rules[0].text += "\n# another text\n";
  try {
    buildMap(scansOf(campus->files()), others, map(), {}, silence());
    FAIL() << "built beside it";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::InvalidArgument);
    EXPECT_NE(std::string(error.what()).find("map.clx.building"), std::string::npos) << error.what();
  }
  EXPECT_EQ(canonicalText(building()), *expected);
  EXPECT_FALSE(fs::exists(map()));
}

TEST_F(UnfinishedBuild, OfOtherScansIsNotGoneOnWith) {
  buildAndBeKilled(2);
  const std::string message = refusal(ErrorKind::InvalidArgument, {}, {campus->files()[1]});
  EXPECT_NE(message.find("other scans"), std::string::npos) << message;
  EXPECT_NE(message.find("stop0.pcd"), std::string::npos) << message;
  build();
  EXPECT_EQ(canonicalText(map()), *expected);
}

TEST_F(UnfinishedBuild, WhetherStatementsAreDroppedIsForTheLastCommandToSay) {
  for (const bool drop : {false, true}) {
    build({.force = true});
    state("mine", map());
    buildAndBeKilled(2, {.force = true, .drop_statements = !drop});
    EXPECT_TRUE(isStated("mine"));
    build({.force = true, .drop_statements = drop});
    EXPECT_EQ(isStated("mine"), !drop);
  }
}

TEST_F(UnfinishedBuild, AStoreThatNoBuildMadeIsNotBuiltInto) {
  {
    const auto store = Environment::open(map(), OpenMode::Create);
    WriteTransaction transaction = store->write();
    QuadWriter writer(transaction);
    writer.add(Quad{Term::iri("https://example.org/mine"), Term::iri("https://example.org/p"), Term::literal("x"),
                    Term::iri("")});
    writer.flush();
    transaction.commit();
  }
  EXPECT_NE(refusal(ErrorKind::InvalidArgument).find("no build has made"), std::string::npos);
  EXPECT_EQ(QuadReader(Environment::open(map(), OpenMode::ReadOnly)->read()).size(), 1U);
  build({.force = true});
  EXPECT_EQ(canonicalText(map()), *expected);
}

TEST_F(UnfinishedBuild, AnEmptyFileIsBuiltInto) {
  writeFile(map(), "");
  build();
  EXPECT_EQ(canonicalText(map()), *expected);
}

/// A process that is killed between the head of the file and its first commit leaves this.
TEST_F(UnfinishedBuild, AFileWithoutACommitIsBuiltInto) {
  const auto begin = [](const fs::path& file) {
    MDB_env* raw = nullptr;
    ASSERT_EQ(mdb_env_create(&raw), MDB_SUCCESS);
    EXPECT_EQ(mdb_env_open(raw, file.c_str(), MDB_NOSUBDIR, 0666), MDB_SUCCESS);
    mdb_env_close(raw);
    EXPECT_TRUE(rdf::hasNoCommit(file));
  };
  begin(map());
  build();
  EXPECT_FALSE(rdf::hasNoCommit(map()));
  EXPECT_EQ(canonicalText(map()), *expected);
  begin(map().string() + ".building");
  build({.force = true});
  EXPECT_EQ(canonicalText(map()), *expected);
}

TEST_F(UnfinishedBuild, DoesNotWriteThroughALinkWithTheNameOfItsLock) {
  const fs::path other = map().parent_path() / "other.txt", lock = map().string() + ".build-lock";
  writeFile(other, "important");
  fs::create_symlink(other, lock);
  EXPECT_THAT([&] { build(); }, testing::ThrowsMessage<Error>(testing::HasSubstr("is a symbolic link")));
  EXPECT_EQ(readFile(other), "important");
  fs::remove(lock);
}

TEST_F(UnfinishedBuild, ThatCannotBeMovedIntoPlaceIsNamedAndKept) {
  build();
  DoAt sink("facts", 1, [&] {
    fs::remove(map());
    fs::create_directories(map() / "full");
  });
  const std::string message = refusal(ErrorKind::StoreUnavailable, {.force = true}, campus->files(), sink);
  EXPECT_NE(message.find("map.clx.building"), std::string::npos) << message;
  EXPECT_EQ(canonicalText(building()), *expected);
}

TEST_F(UnfinishedBuild, ThroughALinkReplacesWhatTheLinkLeadsTo) {
  fs::create_directory(folder.path() / "far");
  const fs::path far = folder.path() / "far/real.clx";
  buildMap(scansOf({campus->files()[0]}), *inputs, far, {}, silence());
  fs::create_symlink(far, map());
  build({.force = true});
  EXPECT_TRUE(fs::is_symlink(map()));
  EXPECT_TRUE(fs::is_regular_file(far));
  EXPECT_EQ(canonicalText(far), *expected);
}

}  // namespace
}  // namespace cluxel::mapping
