// SPDX-License-Identifier: Apache-2.0
// `extend`, `retract`, `repose`, `merge` and `watch` as a user runs them: the maps are those of `build`, dry runs write
// nothing, and what was killed goes on when it is repeated.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "app/program_fixture.hpp"

namespace cluxel::app {
namespace {

using testing::HasSubstr;
using Json = nlohmann::json;

/// The first two scans are in `a.clx`, the other two in `b.clx`, and all four in `whole.clx`.
class ChangeCommands : public Program {
 protected:
  static void SetUpTestSuite() {
    folder = new ScratchFolder;
    ASSERT_EQ(run("simulate " + in("campus") + " --stops 4 --size 50 --points-per-stop 2000").code, 0);
    ASSERT_EQ(build(scan(0) + scan(1), "a.clx"), 0);
    ASSERT_EQ(build(scan(2) + scan(3), "b.clx"), 0);
    ASSERT_EQ(build(in("campus"), "whole.clx"), 0);
  }

  static std::string in(const std::string& name) { return path(name).string(); }
  static std::string scan(int number) { return in("campus/scan_00" + std::to_string(number) + ".pcd") + " "; }
  static int build(const std::string& scans, const std::string& map, const std::string& more = "") {
    return run("build " + scans + " -o " + in(map) + " --force " + more).code;
  }
  /// The map, copied to be changed.
  static std::string copied(const std::string& map) {
    fs::remove(path("copy.clx-lock"));
    fs::copy_file(path(map), path("copy.clx"), fs::copy_options::overwrite_existing);
    return in("copy.clx");
  }
  static std::string canonical(const std::string& map) {
    const Outcome outcome = run("export " + in(map) + " --canonical");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.out;
  }
  static bool isFinished(const std::string& map) {
    const Outcome outcome = run("info " + in(map) + " --json");
    return outcome.code == 0 && Json::parse(outcome.out).value("finished", false);
  }
  /// Copies the scans and moves the poses of every other one by `shift_m`.
  static std::string moved(const std::string& name, double shift_m, int every = 2) {
    fs::remove_all(path(name));
    fs::copy(path("campus"), path(name), fs::copy_options::recursive);
    std::istringstream lines(readFile(path("campus/poses.txt")));
    std::string text;
    int number = 0;
    for (std::string line; std::getline(lines, line);) {
      std::array<double, 16> pose{};
      std::istringstream numbers(line);
      if (line.starts_with('#')) continue;
      for (double& value : pose) numbers >> value;
      if (number++ % every == 0) pose[3] += shift_m;
      std::ostringstream out;
      out << std::setprecision(17);
      for (const double value : pose) out << value << ' ';
      text += out.str() + "\n";
    }
    writeFile(path(name) / "poses.txt", text);
    return in(name);
  }
};

TEST_F(ChangeCommands, ExtendGivesTheMapOfAllScans) {
  const std::string map = copied("a.clx"), before = readFile(map);
  const Outcome dry = run("extend " + map + " " + in("campus") + " --dry-run --json");
  ASSERT_EQ(dry.code, 0) << dry.err;
  EXPECT_TRUE(readFile(map) == before) << "a dry run wrote";
  const Outcome extended = run("extend " + map + " " + in("campus") + " --json");
  ASSERT_EQ(extended.code, 0) << extended.err;
  EXPECT_EQ(Json::parse(extended.out).at("scans_added"), 2);
  EXPECT_EQ(Json::parse(extended.out).at("objects"), Json::parse(dry.out).at("objects"));
  EXPECT_TRUE(canonical("copy.clx") == canonical("whole.clx"));
  EXPECT_THAT(run("extend " + map + " " + in("campus")).out, HasSubstr("nothing changes; all scans are there"));
}

TEST_F(ChangeCommands, NameTheRulesThatTheyEvaluateForTheWholeMap) {
  writeFile(path("count.rq"),
            "PREFIX clx: <https://w3id.org/cluxel/ontology#> CONSTRUCT { <https://example.org/site> "
            "<https://example.org/has> ?n } WHERE { { SELECT (COUNT(?thing) AS ?n) WHERE { ?thing a clx:Object } } }");
  ASSERT_EQ(build(scan(0) + scan(1), "counted.clx", "--sparql-rules " + in("count.rq")), 0);
  const Outcome extended = run("extend " + in("counted.clx") + " " + scan(2) + "--json");
  ASSERT_EQ(extended.code, 0) << extended.err;
  const Json expected{{{"rule", "count.rq"}, {"reason", "it aggregates over the map"}}};
  EXPECT_EQ(Json::parse(extended.out).at("rules_evaluated_whole"), expected);
  EXPECT_THAT(extended.err, HasSubstr("count.rq is evaluated for the whole map at each change"));
  const Outcome without = run("extend " + copied("a.clx") + " " + scan(2) + "--json");
  EXPECT_EQ(Json::parse(without.out).at("rules_evaluated_whole"), Json::array());
}

TEST_F(ChangeCommands, ExtendTellsOfOtherTimes) {
  const std::string map = copied("whole.clx"), later = moved("later", 0);
  const auto writeTimes = [&](int shift_s) {
    std::string text;
    std::istringstream lines(readFile(path("campus/times.txt")));
    for (std::string line; std::getline(lines, line);)
      if (!line.starts_with('#')) text += std::to_string(std::stod(line) + shift_s) + "\n";
    writeFile(path("later/times.txt"), text);
  };
  writeTimes(-60);
  const Outcome earlier = run("extend " + map + " " + later);
  EXPECT_THAT(earlier.out, HasSubstr("nothing changes"));
  EXPECT_THAT(earlier.err, HasSubstr("4 known scans are given earlier times; the later ones stay"));
  writeTimes(60);
  EXPECT_THAT(run("extend " + map + " " + later).err, HasSubstr("4 known scans have later times now"));
  ASSERT_EQ(build(later, "later.clx"), 0);
  EXPECT_TRUE(canonical("copy.clx") == canonical("later.clx"));
  const auto merged = [&](const std::string& maps) { return run("merge " + maps + " --force -o " + in("times.clx")); };
  EXPECT_THAT(merged(in("whole.clx") + " " + in("later.clx")).err, HasSubstr("4 known scans have later times now"));
  EXPECT_TRUE(canonical("times.clx") == canonical("later.clx"));
  EXPECT_THAT(merged(in("later.clx") + " " + in("whole.clx")).err, HasSubstr("4 known scans are given earlier times"));
  EXPECT_TRUE(canonical("times.clx") == canonical("later.clx"));
  expectError(run("extend " + map + " " + in("a.clx")), 2, "is a map, not a scan");
}

TEST_F(ChangeCommands, RetractTakesScansOutAndMayBeRepeated) {
  const std::string map = copied("whole.clx");
  const Outcome first = run("retract " + map + " scan_002.pcd scan_003.pcd");
  ASSERT_EQ(first.code, 0) << first.err;
  EXPECT_THAT(first.out, HasSubstr("2 removed"));
  EXPECT_TRUE(canonical("copy.clx") == canonical("a.clx"));
  const Outcome again = run("retract " + map + " scan_002.pcd scan_003.pcd");
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("nothing changes"));
  EXPECT_THAT(again.err, HasSubstr("was retracted already"));
  expectError(run("retract " + map + " scan_007.pcd"), 3, "has no cloud 'scan_007.pcd'");
  expectError(run("retract " + map + " elsewhere/scan_000.pcd"), 3, "or another path of the same file");
  expectError(run("retract " + map + " scan_000.pcd scan_001.pcd"), 2, "no scan would be left");
  ASSERT_EQ(run("extend " + map + " " + scan(2)).code, 0);
  const std::string other_path = in("campus/../campus/scan_002.pcd");
  EXPECT_THAT(run("retract " + map + " " + other_path).out, HasSubstr("1 removed"));
  EXPECT_THAT(run("retract " + map + " " + other_path).err, HasSubstr("was retracted already"));
}

TEST_F(ChangeCommands, WaitForNobodyWhoChangesTheMap) {
  const std::string map = copied("a.clx");
  const int lock = ::open((map + ".build-lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  ASSERT_EQ(::flock(lock, LOCK_EX), 0);
  for (const std::string& command : {"extend " + map + " " + scan(2), "retract " + map + " scan_001.pcd"})
    expectError(run(command), 5, "is changing it; wait until that has ended");
  ::close(lock);
  fs::remove(map + ".build-lock");
}

TEST_F(ChangeCommands, ChangesBetweenVisitsNeedTwoOfThem) {
  expectError(run("changes " + in("a.clx")), 2, "hint: --since TIME tells from when on scans count as later");
  ASSERT_EQ(build(scan(0), "one.clx"), 0);
  const Outcome one = run("changes " + in("one.clx"));
  expectError(one, 2, "the map has one scan only");
  EXPECT_EQ(one.err.find("--since"), std::string::npos) << one.err;
}

TEST_F(ChangeCommands, ReposeMovesScansThereAndBack) {
  const std::string elsewhere = moved("elsewhere", 0.5), map = copied("whole.clx");
  ASSERT_EQ(build(elsewhere, "elsewhere.clx"), 0);
  const std::string before = readFile(map);
  EXPECT_THAT(run("repose " + map + " " + elsewhere + " --dry-run").out, HasSubstr("2 moved"));
  EXPECT_TRUE(readFile(map) == before) << "a dry run wrote";
  const Outcome outcome = run("repose " + map + " " + elsewhere);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("2 moved"));
  EXPECT_TRUE(canonical("copy.clx") == canonical("elsewhere.clx"));
  EXPECT_THAT(run("repose " + map + " " + elsewhere).out, HasSubstr("nothing changes"));
  ASSERT_EQ(run("repose " + map + " " + in("campus")).code, 0);
  EXPECT_TRUE(canonical("copy.clx") == canonical("whole.clx"));
  expectError(run("repose " + copied("a.clx") + " " + in("campus")), 3, "does not hold the scan");
}

TEST_F(ChangeCommands, MergeMakesTheMapOfAllScansAndMayBeRepeated) {
  fs::remove(path("merged.clx"));
  const std::string maps = in("a.clx") + " " + in("b.clx"), merge = "merge " + maps + " -o " + in("merged.clx");
  EXPECT_EQ(run(merge + " --dry-run").code, 0);
  EXPECT_FALSE(fs::exists(path("merged.clx"))) << "a dry run wrote";
  ASSERT_EQ(run(merge).code, 0);
  EXPECT_TRUE(canonical("merged.clx") == canonical("whole.clx"));
  writeFile(path("identity.txt"), "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n");
  ASSERT_EQ(run("merge " + maps + " -o " + in("by_identity.clx") + " --transform " + in("identity.txt")).code, 0);
  EXPECT_TRUE(canonical("by_identity.clx") == canonical("whole.clx"));
  const std::string bytes = readFile(path("merged.clx"));
  const Outcome again = run(merge);
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_THAT(again.err, HasSubstr("is the merge of these maps already"));
  EXPECT_TRUE(readFile(path("merged.clx")) == bytes);
  ASSERT_EQ(run("update " + in("merged.clx") + " -e 'INSERT DATA { <https://e.org/a> <https://e.org/b> 1 }'").code, 0);
  expectError(run(merge), 2, "exists already");
  expectError(run("merge " + maps + " -o " + in("whole.clx")), 2, "exists already");  // of another history
  expectError(run(merge + " --force"), 2, "has operator statements");
  expectError(run(merge + " --drop-statements"), 2, "--force");
  EXPECT_EQ(run(merge + " --force --drop-statements").code, 0);
  EXPECT_TRUE(canonical("merged.clx") == canonical("whole.clx"));
}

TEST_F(ChangeCommands, MergeTakesATransformAndTheRulesThatAreNamed) {
  constexpr double kShift_m = 64;  // four tiles, and exact in binary
  ASSERT_EQ(build(moved("shifted", kShift_m, 1), "shifted.clx"), 0);
  ASSERT_EQ(run("retract " + in("shifted.clx") + " scan_000.pcd scan_001.pcd").code, 0);
  writeFile(path("back.txt"), "1 0 0 -64 0 1 0 0 0 0 1 0 0 0 0 1\n");
  const std::string merged = " -o " + in("shifted_back.clx") + " --force";
  const Outcome back =
      run("merge " + in("a.clx") + " " + in("shifted.clx") + merged + " --transform " + in("back.txt") + " --json");
  ASSERT_EQ(back.code, 0) << back.err;
  EXPECT_EQ(Json::parse(back.out).at("scans"), 4);

  std::string rules = readFile(test::sourceFolder() / "rules/outdoor.rules.yaml");
  const std::string threshold = "group: { near: 1.5 m }";
  rules.replace(rules.find(threshold), threshold.size(), "group: { near: 0.2 m }");
  writeFile(path("other.rules.yaml"), rules);
  ASSERT_EQ(build(scan(2) + scan(3), "other.clx", "--rules " + in("other.rules.yaml")), 0);
  ASSERT_EQ(build(in("campus"), "whole_other.clx", "--rules " + in("other.rules.yaml")), 0);
  const std::string maps = "merge " + in("a.clx") + " " + in("other.clx") + " -o " + in("used.clx") + " --force";
  expectError(run(maps), 2, "differs from");
  ASSERT_EQ(run(maps + " --use " + in("other.clx")).code, 0);
  EXPECT_TRUE(canonical("used.clx") == canonical("whole_other.clx"));
}

TEST_F(ChangeCommands, WatchAddsWhatArrives) {
  fs::remove(path("watched.clx"));
  const std::string watch = "watch " + in("campus") + " -o " + in("watched.clx") + " --interval 0.05 --idle 0.5";
  const Outcome first = run(watch + " --json");
  ASSERT_EQ(first.code, 0) << first.err;
  std::istringstream lines(first.out);
  std::size_t scans = 0;
  for (std::string line; std::getline(lines, line);) {
    const Json commit = Json::parse(line);
    scans = commit.at("scans");
    EXPECT_GT(commit.at("tiles_decided"), 0) << line;
    EXPECT_EQ(commit.at("objects_added") == commit.at("objects"), commit.at("added") == scans) << "by the build alone";
  }
  EXPECT_EQ(scans, 4U) << "of the last commit, each of which is one line: " << first.out;
  EXPECT_TRUE(canonical("watched.clx") == canonical("whole.clx"));
  fs::remove(path("watched.clx"));
  const Outcome told = run(watch);
  EXPECT_NE(told.out.find(" redecided, 0 gone, 0 from splits, 0 joined; "), std::string::npos) << told.out;
  EXPECT_NE(told.out.find(" tiles decided)"), std::string::npos) << told.out;
  EXPECT_EQ(run(watch).code, 3) << "nothing was added";
  EXPECT_EQ(run(watch + " --model oakland --rules outdoor.rules.yaml").code, 3) << "those of the map";
  expectError(run(watch + " --model campus"), 2, "change the map with 'cluxel rules apply'");
  expectError(run(watch + " --rules absent.rules.yaml"), 4, "absent.rules.yaml");
}

TEST_F(ChangeCommands, StateOnlyTellsInADryRun) {
  const std::string map = copied("whole.clx"), before = readFile(map);
  const Outcome ground = run("query " + map +
                             " --format csv -e 'PREFIX clx: <https://w3id.org/cluxel/ontology#> SELECT ?x { ?x a "
                             "clx:Ground } LIMIT 1'");
  const std::string object = ground.out.substr(ground.out.rfind("object/") + 7, 32);
  EXPECT_EQ(run("state " + map + " --object " + object + " --label yard --dry-run").code, 0);
  EXPECT_TRUE(readFile(map) == before);
  const std::string stated = "state " + map + " --object " + object + " --label yard";
  ASSERT_EQ(run(stated).code, 0);
  EXPECT_THAT(run(stated).err, HasSubstr("was made already"));
  const std::string id =
      Json::parse(run("state " + map + " --list --json").out).at("statements").at(0).at("id").get<std::string>();
  const std::string withdraw = "state " + map + " --withdraw " + id.substr(id.rfind('/') + 1, 8);
  ASSERT_EQ(run(withdraw).code, 0);
  const Outcome again = run(withdraw);
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_THAT(again.err, HasSubstr("was withdrawn already"));
  expectError(run("state " + map + " --withdraw 0123456789"), 3, "names no operator statement");
}

/// Each command is killed at random moments of its run, and then repeated.
TEST_F(ChangeCommands, GoOnAfterAKill) {
  struct Change {
    std::string command, from, expected;  // the map before; the map after
  };
  const std::string map = in("copy.clx"), elsewhere = moved("elsewhere", 0.5);
  ASSERT_EQ(build(elsewhere, "elsewhere.clx"), 0);
  const std::vector<Change> changes{
      {"build " + in("campus") + " -o " + map + " --batch-points 1", "", "whole.clx"},
      {"build " + in("campus") + " -o " + map + " --force --batch-points 1", "a.clx", "whole.clx"},
      {"extend " + map + " " + in("campus") + " --batch-points 1", "a.clx", "whole.clx"},
      {"retract " + map + " scan_002.pcd scan_003.pcd", "whole.clx", "a.clx"},
      {"repose " + map + " " + elsewhere, "whole.clx", "elsewhere.clx"},
      {"merge " + in("a.clx") + " " + in("b.clx") + " -o " + map, "", "whole.clx"},
      {"watch " + in("campus") + " -o " + map + " --interval 0.05 --idle 0.5", "a.clx", "whole.clx"}};
  std::mt19937 random(5);
  const int rounds = std::getenv("CLUXEL_LONG_TESTS") != nullptr ? 200 : 1;
  std::size_t killed_changes = 0;
  for (const Change& change : changes) {
    const auto prepare = [&] {
      for (const auto& entry : fs::directory_iterator(folder->path()))
        if (entry.path().filename().string().starts_with("copy.clx")) fs::remove(entry.path());
      if (!change.from.empty()) copied(change.from);
    };
    const auto isDone = [&] { return fs::exists(map) && canonical("copy.clx") == canonical(change.expected); };
    prepare();
    const auto started = std::chrono::steady_clock::now();
    ASSERT_EQ(run(change.command).code, 0) << change.command;
    const double elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    ASSERT_TRUE(isDone()) << change.command;
    bool was_killed = false;
    for (int i = 0; i < rounds || (!was_killed && i < rounds + 2); ++i) {
      prepare();
      const double after_s = elapsed_s * (0.1 + 0.9 * static_cast<double>(random() % 1000) / 1000);
      const std::string killed = "timeout -s KILL " + std::to_string(after_s) + " ";
      const int status = std::system((killed + program() + change.command + " > /dev/null 2>&1").c_str());
      ASSERT_NE(status, -1);
      // The program is killed together with `timeout`, or ended before.
      const bool is_killed = WIFSIGNALED(status) || WEXITSTATUS(status) == 128 + SIGKILL;
      was_killed = was_killed || is_killed;
      ASSERT_TRUE(is_killed || WEXITSTATUS(status) == 0) << change.command << ": " << status;
      const bool is_built = change.command == changes.front().command && isFinished("copy.clx");
      const Outcome again = run(change.command);
      if (is_built)
        expectError(again, 2, "--force");
      else
        EXPECT_TRUE(again.code == 0 || (again.code == 3 && change.command.starts_with("watch"))) << again.err;
      EXPECT_TRUE(isDone()) << change.command << " killed after " << after_s << " of " << elapsed_s << " s";
    }
    killed_changes += was_killed ? 1 : 0;
  }
  EXPECT_GE(2 * killed_changes, changes.size()) << "most changes were never killed";
}

}  // namespace
}  // namespace cluxel::app
