// SPDX-License-Identifier: Apache-2.0
// A change that is killed at any moment leaves the exact map before or after a commit; the same command finishes it.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <functional>
#include <random>
#include <set>

#include "mapping/change/map_change.hpp"
#include "mapping/change/map_merge.hpp"
#include "mapping/small_campus.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;

/// Kills its process at the n-th report of progress.
class KillAt : public ProgressSink {
 public:
  explicit KillAt(std::size_t call) : call_(call) {}
  void progress(std::string_view, std::size_t, std::size_t) override {
    if (++calls_ == call_) ::kill(::getpid(), SIGKILL);
  }

 private:
  std::size_t call_, calls_ = 0;
};

class CountCalls : public ProgressSink {
 public:
  void progress(std::string_view, std::size_t, std::size_t) override { ++calls; }
  std::size_t calls = 0;
};

using Change = std::function<void(ProgressSink&)>;

class KilledChange : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    campus = new SmallCampus({.seed = 8, .stops = 3, .size_m = 45, .points_per_stop = 1000});
    inputs = new MapInputs(shippedInputs());
  }
  static void TearDownTestSuite() {
    delete campus;
    delete inputs;
  }

  fs::path map() const { return folder.path() / "map.clx"; }
  fs::path file(std::size_t stop) const { return campus->files()[stop]; }
  void build(const std::vector<fs::path>& files, const fs::path& target) const {
    buildMap(scansOf(files), *inputs, target, {.force = true}, silence());
  }

  /// Prepares, kills `change` at random moments, and expects one of `states` each time; then lets it finish.
  void expectExact(const std::function<void()>& prepare, const Change& change, const std::set<std::string>& states,
                   const std::string& finished, const std::function<std::string()>& state) const {
    CountCalls counting;
    prepare();
    change(counting);
    EXPECT_TRUE(state() == finished);
    ASSERT_GT(counting.calls, 5U);
    std::mt19937 random(3);
    const int moments = std::getenv("CLUXEL_LONG_TESTS") != nullptr ? 200 : 6;
    for (int i = 0; i < moments; ++i) {
      prepare();
      const std::size_t at = 1 + random() % counting.calls;
      const pid_t child = ::fork();
      ASSERT_GE(child, 0);
      if (child == 0) {
        KillAt sink(at);
        change(sink);
        ::_exit(0);
      }
      int status = 0;
      ASSERT_EQ(::waitpid(child, &status, 0), child);
      EXPECT_TRUE(WIFSIGNALED(status)) << "call " << at << " of " << counting.calls;
      EXPECT_TRUE(states.contains(state())) << "killed at call " << at << " of " << counting.calls;
      change(silence());
      EXPECT_TRUE(state() == finished) << "after call " << at;
    }
  }

  ScratchFolder folder;
  inline static SmallCampus* campus = nullptr;
  inline static MapInputs* inputs = nullptr;
};

TEST_F(KilledChange, ExtendingGoesOn) {
  const std::string first = builtText({file(0)}, *inputs), two = builtText({file(0), file(1)}, *inputs),
                    all = builtText(campus->files(), *inputs);
  expectExact([&] { build({file(0)}, map()); },
              [&](ProgressSink& sink) {
                extendMap(map(), scansOf({file(1), file(2)}), {.threads = 1, .batch_points = 1}, sink);
              },
              {first, two, all}, all, [&] { return canonicalText(map()); });
}

TEST_F(KilledChange, MovingScansIsAllOrNothing) {
  build({file(0), file(1)}, map());
  const std::string before = canonicalText(map());
  Eigen::Isometry3d moved = scansOf({file(1)}).file(0).T_map_sensor;
  moved.pretranslate(Eigen::Vector3d(0.5, 0.25, 0));
  const ScanSet both = scansOf({file(0), file(1)});
  const ScanId id = both.load(1).id;
  buildMap(both.posed({{0, both.file(0).T_map_sensor}, {1, moved}}), *inputs, folder.path() / "moved", {}, silence());
  const std::string after = canonicalText(folder.path() / "moved");
  expectExact(
      [&] {
        build({file(0), file(1)}, map());
      },
      [&](ProgressSink& sink) {
        moveScans(map(), {{id, moved}}, {}, sink);
      },
      {before, after}, after, [&] { return canonicalText(map()); });
}

TEST_F(KilledChange, AMergeIsThereWholeOrNotAtAll) {
  const fs::path a = folder.path() / "a", b = folder.path() / "b";
  build({file(0)}, a);
  build({file(1), file(2)}, b);
  const std::string all = builtText(campus->files(), *inputs);
  expectExact([&] { fs::remove(map()); },
              [&](ProgressSink& sink) {
                mergeMaps({{a}, {b}}, map(), {.change = {}, .use = std::nullopt, .force = true}, sink);
              },
              {"", all}, all, [&] { return fs::exists(map()) ? canonicalText(map()) : std::string(); });
  EXPECT_FALSE(fs::exists(map().string() + ".merging"));
}

}  // namespace
}  // namespace cluxel::mapping
