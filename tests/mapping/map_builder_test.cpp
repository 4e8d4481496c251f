// SPDX-License-Identifier: Apache-2.0
// A map is a function of its scans and inputs: independent of order, threads, batches and killed builds.
#include "mapping/build/map_builder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <random>
#include <set>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "mapping/small_campus.hpp"
#include "test_paths.hpp"

namespace cluxel::mapping {

using namespace scan;
using namespace perception;
using namespace simulation;
using namespace rdf;
using namespace rules;
namespace {

namespace fs = std::filesystem;
using Files = std::vector<fs::path>;

class MapBuilder : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    campus = new SmallCampus({.seed = 3, .stops = 3, .size_m = 50, .points_per_stop = 3000});
    inputs = new MapInputs(shippedInputs());
    expected = new std::string(builtText(campus->files(), *inputs));
  }
  static void TearDownTestSuite() {
    delete campus;
    delete inputs;
    delete expected;
  }
  fs::path map() const { return folder.path() / "map.clx"; }
  BuildReport build(const Files& files, const BuildParams& params = {}) const {
    return buildMap(scansOf(files), *inputs, map(), params, silence());
  }
  /// The error of a build with these inputs, if any; no map file may exist afterwards.
  std::optional<ErrorKind> refusal(const MapInputs& changed) const {
    try {
      buildMap(scansOf(campus->files()), changed, map(), {}, silence());
    } catch (const Error& error) {
      EXPECT_FALSE(fs::exists(map())) << error.what();
      return error.kind();
    }
    return std::nullopt;
  }

  ScratchFolder folder;
  static inline SmallCampus* campus = nullptr;
  static inline MapInputs* inputs = nullptr;
  static inline std::string* expected = nullptr;
};

TEST_F(MapBuilder, FindsObjectsOnTheSmallCampus) {
  const BuildReport report = build(campus->files());
  EXPECT_EQ(report.scans, 3U);
  EXPECT_GT(report.objects, 1U);
  EXPECT_GT(report.primitives, report.objects);
  EXPECT_GT(report.cluxels, report.primitives);
  EXPECT_TRUE(MapReader(map()).summary().is_finished);
}

TEST_F(MapBuilder, TwentyOrdersAndBatchingsOfTheScansGiveTheSameMap) {
  const SmallCampus five({.seed = 8, .stops = 5, .size_m = 45, .points_per_stop = 1000});
  std::mt19937 random(7);
  Files files = five.files();
  const std::string expected = builtText(files, *inputs);
  std::set<Files> orders{files};
  for (int round = 0; round < 20; ++round) {
    while (!orders.insert(files).second) std::shuffle(files.begin(), files.end(), random);
    const BuildParams params{.threads = 1U + round % 2U,
                             .batch_points = random() % 3 == 0 ? 1U : 20'000'000U,
                             .stage_points = random() % 2 == 0 ? 1U : 20'000'000U};
    ASSERT_TRUE(builtText(files, *inputs, params) == expected)
        << "round " << round << ", first " << files[0] << ", " << params.threads << " threads, batch "
        << params.batch_points << ", parts of " << params.stage_points;
  }
}

TEST_F(MapBuilder, ThreadsDoNotChangeTheMap) {
  EXPECT_EQ(builtText(campus->files(), *inputs, {.threads = 2}), *expected);
  EXPECT_EQ(builtText(campus->files(), *inputs, {.threads = 5}), *expected);
}

TEST_F(MapBuilder, AScanThatIsGivenTwiceCountsOnce) {
  Files files = campus->files();
  files.push_back(folder.path() / "copy.pcd");
  fs::copy_file(files[0], files.back());
  EXPECT_EQ(builtText(files, *inputs), *expected);
}

/// Keeps the notes on scans that were given before.
class RepeatedScans : public ProgressSink {
 public:
  void note(std::string_view text) override {
    if (text.find("given before") != std::string_view::npos) notes.emplace_back(text);
  }
  std::vector<std::string> notes;
};

TEST_F(MapBuilder, ScansThatAreGivenTwiceAreNoted) {
  RepeatedScans once, twice, with_other_times;
  buildMap(scansOf(campus->files()), *inputs, map(), {}, once);
  EXPECT_TRUE(once.notes.empty());
  const fs::path copy = folder.path() / "copy.pcd";
  fs::copy_file(campus->files()[0], copy);
  const std::string same_scan = copy.string() + " is the same scan as " + campus->files()[0].string();
  buildMap(scansOf({campus->files()[0], copy}), *inputs, map(), {.force = true}, twice);
  EXPECT_EQ(twice.notes, std::vector{"1 of 2 scans were given before and are not added again (" + same_scan + ")"});

  std::ofstream manifest(folder.path() / "site.yaml");
  for (const auto& [file, time] : {std::pair(campus->files()[0], 100), {copy, 200}, {copy, 150}})
    manifest << (time == 100 ? "scans:\n" : "") << "  - {path: " << file.string() << ", time_s: " << time << "}\n";
  manifest.close();
  buildMap(scansOf({folder.path() / "site.yaml"}), *inputs, map(), {.force = true}, with_other_times);
  EXPECT_EQ(with_other_times.notes, std::vector{"2 of 3 scans were given before and are not added again (" + same_scan +
                                                ", ...); 2 of them have other times, of which the latest is kept"});
  EXPECT_EQ(MapReader(map()).clouds().at(0).time_s, 200);
}

TEST_F(MapBuilder, WhereTheInputFilesLieDoesNotChangeTheMap) {
  for (const char* name : {"ontology", "rules", "models/oakland"}) {
    fs::create_directories((folder.path() / name).parent_path());
    fs::copy(test::sourceFolder() / name, folder.path() / name, fs::copy_options::recursive);
  }
  EXPECT_TRUE(builtText(campus->files(), readMapInputs({}, DataHome(folder.path()))) == *expected);
}

TEST_F(MapBuilder, FewerScansGiveAnotherMap) {
  EXPECT_NE(builtText({campus->files()[0], campus->files()[1]}, *inputs), *expected);
}

TEST_F(MapBuilder, DoesNotOverwriteAFinishedMapWithoutForce) {
  build({campus->files()[0]});
  const std::string before = canonicalText(map());
  try {
    build(campus->files());
    FAIL() << "the finished map was taken as unfinished";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::InvalidArgument);
    EXPECT_EQ(error.remedy(), Remedy::ReplaceMap) << error.what();
  }
  EXPECT_EQ(canonicalText(map()), before);
  build(campus->files(), {.force = true});
  EXPECT_EQ(canonicalText(map()), *expected);
}

TEST_F(MapBuilder, WithForceTheOldMapSurvivesABuildThatFails) {
  build(campus->files());
  const fs::path broken = folder.path() / "broken.pcd";
  const std::string bytes = readFile(campus->files()[0]);
  writeFile(broken, bytes.substr(0, bytes.size() / 2));
  for (const std::uint64_t batch : {std::uint64_t{1}, std::uint64_t{20'000'000}}) {
    EXPECT_THROW(build({campus->files()[1], broken}, {.batch_points = batch, .force = true}), InputError);
    EXPECT_EQ(canonicalText(map()), *expected);
    EXPECT_TRUE(MapReader(map()).summary().is_finished);
  }
  build(campus->files(), {.force = true});
  EXPECT_EQ(canonicalText(map()), *expected);
}

TEST_F(MapBuilder, ABrokenScanInTheFirstBatchLeavesNoFile) {
  const fs::path broken = folder.path() / "broken.pcd";
  const std::string bytes = readFile(campus->files()[0]);
  writeFile(broken, bytes.substr(0, bytes.size() - 100));
  EXPECT_THROW(build({campus->files()[1], broken}), InputError);
  EXPECT_FALSE(fs::exists(map()));
}

/// Kills the process (SIGKILL) when the second scan begins.
class SuddenDeath : public ProgressSink {
 public:
  explicit SuddenDeath(std::size_t at) : at_(at) {}
  void progress(std::string_view stage, std::size_t done, std::size_t) override {
    if (stage == "scans" && done == at_) ::kill(::getpid(), SIGKILL);
  }

 private:
  std::size_t at_;
};

/// Builds in another process, which is killed while scan `at` (from 1) is added; one scan per batch.
void buildAndBeKilled(const Files& files, const MapInputs& inputs, const fs::path& map, std::size_t at) {
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    SuddenDeath sink(at);
    buildMap(scansOf(files), inputs, map, {.batch_points = 1}, sink);
    ::_exit(0);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status)) << "the build was not killed";
}

TEST_F(MapBuilder, AKilledBuildLeavesTheExactMapOfTheScansSoFarAndGoesOn) {
  buildAndBeKilled(campus->files(), *inputs, map(), 3);
  {
    const MapReader reader(map());
    EXPECT_FALSE(reader.summary().is_finished);
    EXPECT_EQ(reader.clouds().size(), 2U);
    EXPECT_EQ(canonicalText(reader), builtText({campus->files()[0], campus->files()[1]}, *inputs));
  }
  const BuildReport report = build(campus->files(), {.batch_points = 1});
  EXPECT_EQ(report.scans_already_there, 2U);
  EXPECT_EQ(report.scans, 3U);
  EXPECT_EQ(canonicalText(map()), *expected);
  EXPECT_TRUE(MapReader(map()).summary().is_finished);
}

TEST_F(MapBuilder, ABuildThatWasKilledBeforeItsFirstCommitStartsAnew) {
  buildAndBeKilled(campus->files(), *inputs, map(), 1);
  build(campus->files());
  EXPECT_EQ(canonicalText(map()), *expected);
}

TEST_F(MapBuilder, OtherInputsOnAnUnfinishedMapAreAnError) {
  buildAndBeKilled(campus->files(), *inputs, map(), 2);
  MapInputs others = *inputs;
  others.rules[0].text += "\n# another text\n";
  try {
    buildMap(scansOf(campus->files()), others, map(), {}, silence());
    FAIL() << "two sets of rules went into one map";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::InvalidArgument);
    EXPECT_NE(std::string(error.what()).find("unfinished"), std::string::npos) << error.what();
  }
  build(campus->files());
  EXPECT_EQ(canonicalText(map()), *expected);
}

TEST_F(MapBuilder, TheSameScanWithAnotherPoseIsAnErrorThatNamesBothFiles) {
  Scan moved = campus->scans()[0].scan;
  moved.T_map_sensor.translation().x() += 0.5;
  const fs::path copy = folder.path() / "moved.pcd";
  writeScanFile(moved, copy);
  try {
    build({campus->files()[0], copy});
    FAIL() << "one scan lies in the map at two places";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("stop0.pcd"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("moved.pcd"), std::string::npos) << error.what();
  }
  EXPECT_FALSE(fs::exists(map()));
}

TEST_F(MapBuilder, TheSameScanWithAndWithoutAPoseIsAnErrorInEitherOrder) {
  const fs::path lone = folder.path() / "lone.xyz", posed = folder.path() / "manifest.yaml";
  writeFile(lone, "1 2 0\n1.1 2 0\n1.2 2 0\n");
  writeFile(posed, "scans: [{path: lone.xyz, pose: {xyz: [0, 0, 0]}}]\n");
  for (const auto& inputs_in_order : {std::vector{lone, posed}, std::vector{posed, lone}}) {
    try {
      build(inputs_in_order);
      FAIL() << "which one was first decides whether the map knows where the sensor stood";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("is the same scan as"), std::string::npos) << error.what();
    }
  }
}

TEST_F(MapBuilder, TheSameScanWithAnotherPoseIsToldHowFarAwayItIs) {
  writeFile(folder.path() / "lone.xyz", "1 2 0\n1.1 2 0\n1.2 2 0\n");
  const auto posed = [&](const std::string& name, const std::string& x) {
    writeFile(folder.path() / name, "scans: [{path: lone.xyz, pose: {xyz: [" + x + ", 0, 0]}}]\n");
    return folder.path() / name;
  };
  const auto refusal = [&](const std::string& x) -> std::string {
    try {
      build({posed("one.yaml", "10"), posed("other.yaml", x)});
    } catch (const InputError& error) {
      return error.what();
    }
    return "built";
  };
  EXPECT_THAT(refusal("10.25"), testing::HasSubstr("0.250 m and 0.000 degrees away"));
  EXPECT_THAT(refusal("10.0000000001"), testing::HasSubstr("differs by rounding alone"));
}

TEST_F(MapBuilder, FaultyInputsWriteNothing) {
  const auto with = [&](auto change) {
    MapInputs changed = *inputs;
    change(changed);
    return refusal(changed);
  };
  EXPECT_EQ(with([](MapInputs& i) { i.rules[0].text = "rules: [\n"; }), ErrorKind::FaultyInput);
  EXPECT_EQ(with([](MapInputs& i) { i.ontology[0].text += "\nclx:Tree a owl:Class"; }), ErrorKind::FaultyInput);
  EXPECT_EQ(with([](MapInputs& i) { i.model.text.resize(i.model.text.size() / 2); }), ErrorKind::FaultyInput);
  EXPECT_EQ(with([](MapInputs& i) {
              i.sparql_rules = {{"x.rq", "SELECT ?s WHERE { ?s ?p ?o }"}};
            }),
            ErrorKind::FaultyInput);
  EXPECT_EQ(with([](MapInputs& i) {
              i.sparql_rules = {{"x.rq", "CONSTRUCT { ?s ?p } WHERE {}"}};
            }),
            ErrorKind::FaultyInput);
}

TEST_F(MapBuilder, NoScansAreAnErrorOfUsage) {
  EXPECT_THROW(buildMap(ScanSet(), *inputs, map(), {}, silence()), Error);
  EXPECT_FALSE(fs::exists(map()));
}

fs::path kittiFolder() {
  return test::outsideDataFolder() / "kitti00";
}

/// The first frames of KITTI, each in a separate folder with its pose, so that they can be given in any order.
Files kittiFrames(const fs::path& folder, std::size_t count) {
  const ScanSet all = ScanSet::open({kittiFolder()}, {}, silence());
  Files files;
  for (std::size_t i = 0; i < std::min(count, all.size()); ++i) {
    files.push_back(folder / ("frame" + std::to_string(i) + ".pcd"));
    writeScanFile(all.load(i), files.back());
  }
  return files;
}

TEST_F(MapBuilder, KittiFramesInAnyOrderGiveTheSameMap) {
  if (!fs::exists(kittiFolder())) GTEST_SKIP() << "outside data absent: " << kittiFolder();
  const bool is_long = std::getenv("CLUXEL_LONG_TESTS") != nullptr;
  Files files = kittiFrames(folder.path(), is_long ? 16 : 3);
  const std::string first = builtText(files, *inputs, {.threads = 2});
  std::reverse(files.begin(), files.end());
  EXPECT_TRUE(builtText(files, *inputs, {.threads = 1, .batch_points = is_long ? 500'000U : 1U}) == first)
      << "last frame first";
  std::mt19937 random(16);
  for (int round = 0; round < (is_long ? 2 : 0); ++round) {
    std::shuffle(files.begin(), files.end(), random);
    EXPECT_TRUE(builtText(files, *inputs, {.threads = 2, .batch_points = 700'000U}) == first) << "shuffle " << round;
  }
}

}  // namespace
}  // namespace cluxel::mapping
