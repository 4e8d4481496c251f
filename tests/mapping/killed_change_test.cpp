// SPDX-License-Identifier: Apache-2.0
// A change that is killed at any moment leaves the exact map before or after a commit; the same command finishes it.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <random>
#include <set>

#include "mapping/build/map_update.hpp"
#include "mapping/change/map_change.hpp"
#include "mapping/change/map_merge.hpp"
#include "mapping/change/statement_change.hpp"
#include "mapping/small_campus.hpp"
#include "rdf/map_iris.hpp"

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

/// Kills this process when it has computed for so long. It tells when, never whether a test passes.
void killAfter(double cpu_s) {
  sigevent event{};
  event.sigev_notify = SIGEV_SIGNAL;
  event.sigev_signo = SIGKILL;
  timer_t timer{};
  const itimerspec time{{0, 0}, {static_cast<time_t>(cpu_s), 1 + static_cast<long>((cpu_s - std::floor(cpu_s)) * 1e9)}};
  if (::timer_create(CLOCK_PROCESS_CPUTIME_ID, &event, &timer) != 0 || ::timer_settime(timer, 0, &time, nullptr) != 0)
    ::_exit(1);
}

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

  /// Runs `change` in a process of its own, and returns how that ended.
  static int ended(const std::function<void()>& change, rusage& usage) {
    const pid_t child = ::fork();
    if (child == 0) {
      change();
      ::_exit(0);
    }
    int status = 0;
    if (child < 0 || ::wait4(child, &status, 0, &usage) != child) throw std::runtime_error("no process can be made");
    return status;
  }

  /// Prepares, kills `change` at random reports of progress and at random times between them, and expects one of
  /// `states` each time; then lets it finish.
  void expectExact(const std::function<void()>& prepare, const Change& change, const std::set<std::string>& states,
                   const std::string& finished, const std::function<std::string()>& state) const {
    CountCalls counting;
    prepare();
    change(counting);
    EXPECT_TRUE(state() == finished);
    prepare();
    rusage usage{};
    ASSERT_EQ(ended([&] { change(silence()); }, usage), 0);
    const auto seconds = [](const timeval& time) {
      return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    const double cpu_s = seconds(usage.ru_utime) + seconds(usage.ru_stime);
    std::mt19937 random(3);
    const int moments = std::getenv("CLUXEL_LONG_TESTS") != nullptr ? 200 : 6;
    int killed = 0;
    for (int i = 0; i < moments; ++i) {
      prepare();
      const bool at_report = counting.calls > 5 && i % 2 == 0;
      const std::size_t at = 1 + random() % std::max<std::size_t>(counting.calls, 1);
      const double after_s = cpu_s * static_cast<double>(random() % 10000) / 10000;
      const int status = ended(
          [&] {
            KillAt sink(at_report ? at : 0);
            if (!at_report) killAfter(after_s);
            change(sink);
          },
          usage);
      const std::string moment = at_report ? "call " + std::to_string(at) + " of " + std::to_string(counting.calls)
                                           : std::to_string(after_s) + " of " + std::to_string(cpu_s) + " s";
      killed += WIFSIGNALED(status) ? 1 : 0;
      EXPECT_TRUE(WIFSIGNALED(status) || (!at_report && status == 0)) << moment;
      const std::string found = state();
      EXPECT_TRUE(states.contains(found)) << "killed at " << moment;
      if (found != finished) change(silence());  // a command that removes something refuses to do so twice
      EXPECT_TRUE(state() == finished) << "after " << moment;
    }
    EXPECT_GT(killed, 0);
  }
  /// For changes of one map in one commit.
  void expectAllOrNothing(const Change& change, const std::string& finished) const {
    const fs::path kept = folder.path() / "kept";
    fs::copy_file(map(), kept);
    expectExact([&] { fs::copy_file(kept, map(), fs::copy_options::overwrite_existing); }, change,
                {canonicalText(kept), finished}, finished, [&] { return canonicalText(map()); });
  }
  Statement someStatement(const std::string& local) const {
    const MapReader reader(map());
    for (const rules::SemanticObject& object : reader.objects())
      if (object.class_iri != vocabulary::clx("Ground") && object.class_iri != vocabulary::clx(local))
        return {
            StatementKind::Is, "", Term::iri(vocabulary::clx(local)), anchorOf(reader.stagesWithPoints(), object), {}};
    throw std::runtime_error("the campus has nothing but ground");
  }
  /// The map after a change of a copy.
  std::string after(const Change& change) const {
    const fs::path kept = folder.path() / "before";
    fs::copy_file(map(), kept);
    change(silence());
    const std::string text = canonicalText(map());
    fs::rename(kept, map());
    return text;
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

TEST_F(KilledChange, RetractingIsAllOrNothing) {
  build({file(0), file(1)}, map());
  const ScanId id = scansOf({file(1)}).load(0).id;
  expectAllOrNothing([&](ProgressSink& sink) { retractScans(map(), {id}, {}, sink); }, builtText({file(0)}, *inputs));
}

TEST_F(KilledChange, ApplyingRulesIsAllOrNothing) {
  build({file(0), file(1)}, map());
  MapInputs other = *inputs;
  std::string& text = other.rules.front().text;
  const std::string threshold = "group: { near: 1.5 m }";
  text.replace(text.find(threshold), threshold.size(), "group: { near: 0.2 m }");
  expectAllOrNothing(
      [&](ProgressSink& sink) {
        applyInputs(
            map(), [&](const MapInputs&) { return other; }, {}, sink);
      },
      builtText({file(0), file(1)}, other));
}

TEST_F(KilledChange, StatingAndWithdrawingAreAllOrNothing) {
  build({file(0), file(1)}, map());
  const Statement first = someStatement("StreetSign"), second = someStatement("Barrier");
  changeStatements(map(), {{first}, {}, "anna"}, {}, silence());
  const Change change = [&](ProgressSink& sink) {
    changeStatements(map(), {{second}, {first.id()}, "anna"}, {}, sink);
  };
  expectAllOrNothing(change, after(change));
}

TEST_F(KilledChange, UpdatesAreAllOrNothing) {
  build({file(0), file(1)}, map());
  const std::string object = rdf::iriOfObject(MapReader(map()).objects().front().id);
  const Change change = [&](ProgressSink& sink) {
    updateMap(map(),
              "INSERT DATA { <" + object + "> <" + vocabulary::rdfs("label") + "> \"lawn\" . <https://example.org/a> " +
                  "<https://example.org/b> 1 }",
              {}, sink);
  };
  expectAllOrNothing(change, after(change));
}

}  // namespace
}  // namespace cluxel::mapping
