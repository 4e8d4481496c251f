// SPDX-License-Identifier: Apache-2.0
// Changes of maps in processes that are killed at random moments.
#pragma once

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

#include "mapping/change/map_change.hpp"
#include "mapping/map_state.hpp"
#include "mapping/small_campus.hpp"

namespace cluxel::mapping {

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
inline void killAfter(double cpu_s) {
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

/// The canonical text of the last commit; empty before the first one.
inline std::string committedText(const fs::path& map) {
  if (!fs::exists(map) || fs::file_size(map) == 0) return "";
  return storedState(Environment::open(map, OpenMode::ReadOnly)->read()) ? canonicalText(map) : "";
}

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

  /// In turn with one thread and the whole map, where it is small, and with two threads around the change; every third
  /// time as a large batch, which commits points and outputs early.
  ChangeParams params() const {
    ChangeParams params;
    if (moment_ / 2 % 2 != 0) params.threads = 2, params.max_window_share = 2;
    if (moment_ % 3 == 1) params.stage_points = 1, params.whole_cluxels = 100;
    return params;
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
  /// `states` each time; then repeats it.
  void expectExact(const std::function<void()>& prepare, const Change& change, const std::set<std::string>& states,
                   const std::string& finished, const std::function<std::string()>& state) {
    CountCalls counting;
    moment_ = 2;  // through the window
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
    const int moments = std::getenv("CLUXEL_LONG_TESTS") != nullptr ? 200 : short_moments_;
    int killed = 0;
    for (int i = 0; i < moments; ++i) {
      moment_ = i;
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
      EXPECT_TRUE(WIFSIGNALED(status) || status == 0) << moment;
      EXPECT_TRUE(states.contains(state())) << "killed at " << moment;
      change(silence());  // the same command, also when it was killed after its commit
      EXPECT_TRUE(state() == finished) << "after " << moment;
    }
    EXPECT_GT(killed, 0);
  }
  /// For changes of one map in one commit.
  void expectAllOrNothing(const Change& change, const std::string& finished) {
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
  int moment_ = 0;
  int short_moments_ = 6;  ///< at which a change is killed, unless the tests are long
  inline static SmallCampus* campus = nullptr;
  inline static MapInputs* inputs = nullptr;
};

}  // namespace cluxel::mapping
