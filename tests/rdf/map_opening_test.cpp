// SPDX-License-Identifier: Apache-2.0
// Tests of maps that are moved, or whose user is stopped, in the very moment of their opening.
#include <dlfcn.h>
#include <fcntl.h>
#include <lmdb.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <future>
#include <string>
#include <utility>

#include "rdf/file/file_guards.hpp"
#include "rdf/file/lock_file.hpp"
#include "rdf/file/map_replacement.hpp"
#include "rdf/map_file_fixture.hpp"
#include "rdf/other_process.hpp"

namespace {

/// Runs once, after all checks and right before LMDB opens the next file.
std::function<void()> before_opening;

}  // namespace

/// Takes the place of LMDB's function, which it calls.
extern "C" int mdb_env_open(MDB_env* environment, const char* path, unsigned flags, mdb_mode_t mode) {
  static const auto original = reinterpret_cast<decltype(&mdb_env_open)>(::dlsym(RTLD_NEXT, "mdb_env_open"));
  if (const auto run = std::exchange(before_opening, {})) run();
  return original(environment, path, flags, mode);
}

namespace cluxel::rdf {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class MapOpening : public MapFile {
 protected:
  void SetUp() override { put(*create(), "one", "1"); }
  void TearDown() override { before_opening = {}; }

  fs::path named(const std::string& name) const { return folder_.path() / name; }
  /// The map is moved away in the next moment of opening.
  void moveAwayInBetween() {
    before_opening = [this] { fs::rename(file_, named("away.clx")); };
  }
};

TEST_F(MapOpening, MakesNoFileWhereAMapWasMovedAway) {
  for (const OpenMode mode : {OpenMode::ReadOnly, OpenMode::ReadWrite}) {
    moveAwayInBetween();
    EXPECT_THAT(refusal(mode), HasSubstr("there is no such file"));
    EXPECT_FALSE(fs::exists(file_));
    fs::rename(named("away.clx"), file_);
    EXPECT_EQ(open(mode)->read().block("t", "one"), "1");
  }
}

TEST_F(MapOpening, MakesNoFileWhenTheTemporaryFolderIsMissing) {
  EXPECT_EQ(inChild([&] {
              ::setenv("TMPDIR", named("missing").c_str(), 1);
              moveAwayInBetween();
              const bool is_refused = refusal().find("there is no such file") != std::string::npos;
              return is_refused && !fs::exists(file_) ? 0 : 1;
            }),
            0);
}

TEST_F(MapOpening, TakesTheMapThatCameInItsPlace) {
  const fs::path other = named("other.clx");
  put(*Environment::open(other, OpenMode::Create), "one", "2");
  before_opening = [&] { fs::rename(other, file_); };
  EXPECT_EQ(open()->read().block("t", "one"), "2");
}

TEST_F(MapOpening, LeavesNothingInTheTemporaryFolder) {
  EXPECT_EQ(inChild([&] {
              const fs::path temporary = named("temporary");
              fs::create_directory(temporary);
              ::setenv("TMPDIR", temporary.c_str(), 1);
              return open()->read().block("t", "one") == "1" && fs::is_empty(temporary) ? 0 : 1;
            }),
            0);
}

/// As when a process is stopped: whoever waits for it says so and ends.
TEST_F(MapOpening, DoesNotWaitWithoutEndForAProcessThatIsStopped) {
  const fs::path opened = named("opened.clx"), replaced = named("replaced.clx"), fresh = named("fresh.clx");
  for (const fs::path& map : {opened, replaced, fresh}) put(*Environment::open(map, OpenMode::Create), "one", "1");
  fs::remove(lockFileOf(opened));
  OtherProcess replacing([&](const Pause& pause) {
    const Descriptor map(::open(file_.c_str(), O_RDWR | O_CLOEXEC));
    const NameLock lock(map.get(), NameLock::Kind::Replacing, file_);
    pause();
    return 0;
  });
  OtherProcess opening([&](const Pause& pause) {
    const Descriptor map(::open(replaced.c_str(), O_RDWR | O_CLOEXEC));
    const NameLock lock(map.get(), NameLock::Kind::Opening, replaced);
    pause();
    return 0;
  });
  OtherProcess within_lmdb([&](const Pause& pause) {
    before_opening = pause;
    Environment::open(opened, OpenMode::ReadWrite);
    return 0;
  });
  const auto refused = [](const std::function<void()>& work) {
    return std::async(std::launch::async, [work] { return refusalOf(work); });
  };
  auto first = refused([&] { Environment::open(file_, OpenMode::ReadOnly); });
  auto second = refused([&] { replaceMapFile(fresh, replaced); });
  auto third = std::async(std::launch::async, [&] {
    return inChild([&] {
      return refusalOf([&] { Environment::open(opened, OpenMode::ReadOnly); }).find("one or more processes") !=
                     std::string::npos
                 ? 0
                 : 1;
    });
  });
  EXPECT_THAT(first.get(), HasSubstr("map.clx: one or more processes have been opening or replacing the map"));
  EXPECT_THAT(second.get(), HasSubstr("replaced.clx: one or more processes have been opening or replacing the map"));
  EXPECT_EQ(third.get(), 0);
  EXPECT_EQ(within_lmdb.end(), 0);  // the last first: it has copies of the pipes of the others
  EXPECT_EQ(opening.end(), 0);
  EXPECT_EQ(replacing.end(), 0);
  EXPECT_EQ(Environment::open(opened, OpenMode::ReadOnly)->read().block("t", "one"), "1");
  EXPECT_TRUE(fs::exists(fresh));
}

TEST_F(MapOpening, LeavesTheNameToOthersWhileItWaitsForItsTurn) {
  OtherProcess within_lmdb([&](const Pause& pause) {
    const Descriptor lock_file(::open(lockFileOf(file_).c_str(), O_RDWR | O_CLOEXEC));
    const auto turn = NameLock::withoutWaiting(lock_file.get());
    pause();
    return turn ? 0 : 1;
  });
  auto waiting =
      std::async(std::launch::async, [&] { return open(OpenMode::ReadOnly)->read().block("t", "one") == "1"; });
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_EQ(refusalOf([&] {
              const Descriptor map(::open(file_.c_str(), O_RDWR | O_CLOEXEC));
              const NameLock lock(map.get(), NameLock::Kind::Replacing, file_);
            }),
            "no refusal");
  EXPECT_EQ(waiting.wait_for(std::chrono::seconds(0)), std::future_status::timeout);
  EXPECT_EQ(within_lmdb.end(), 0);
  EXPECT_TRUE(waiting.get());
}

TEST_F(MapOpening, WaitsForAnExchangeThatIsUnderWay) {
  OtherProcess replacing([&](const Pause& pause) {
    const Descriptor map(::open(file_.c_str(), O_RDWR | O_CLOEXEC));
    const NameLock lock(map.get(), NameLock::Kind::Replacing, file_);
    pause();
    return 0;
  });
  auto ending = std::async(std::launch::async, [&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    return replacing.end();
  });
  EXPECT_EQ(open()->read().block("t", "one"), "1");
  EXPECT_EQ(ending.get(), 0);
}

}  // namespace
}  // namespace cluxel::rdf
