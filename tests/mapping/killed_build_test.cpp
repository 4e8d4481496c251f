// SPDX-License-Identifier: Apache-2.0
// A build, a watch or a compaction that is killed at any moment leaves an exact map; the same command finishes it.
#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "mapping/build/early_commit.hpp"
#include "mapping/build/work_file.hpp"
#include "mapping/change/map_compaction.hpp"
#include "mapping/change/map_update.hpp"
#include "mapping/change/rdf_loading.hpp"
#include "mapping/change/statement_change.hpp"
#include "mapping/free_space.hpp"
#include "mapping/killed_change.hpp"
#include "mapping/watch/folder_watch.hpp"

namespace cluxel::mapping {
namespace {

class KilledBuild : public KilledChange {
 protected:
  unsigned threads() const { return params().threads; }
  std::uint64_t stagePoints() const { return params().stage_points; }
};

TEST_F(KilledBuild, GoesOn) {
  const std::string first = builtText({file(0)}, *inputs), two = builtText({file(0), file(1)}, *inputs),
                    all = builtText(campus->files(), *inputs);
  expectExact([&] { fs::remove(map()); },
              [&](ProgressSink& sink) {
                if (committedText(map()) == all) return;  // a finished map is not built again
                buildMap(scansOf(campus->files()), *inputs, map(),
                         {.threads = threads(), .batch_points = 1, .stage_points = stagePoints()}, sink);
              },
              {"", first, two, all}, all, [&] { return committedText(map()); });
  EXPECT_TRUE(MapReader(map()).isFinished());
}

/// Points and outputs of such a batch are committed before the map.
TEST_F(KilledBuild, OfOneLargeBatchIsAllOrNothing) {
  const std::string all = builtText(campus->files(), *inputs);
  std::size_t left = 0;
  expectExact([&] { fs::remove(map()); },
              [&](ProgressSink& sink) {
                if (committedText(map()) == all) return;
                if (fs::exists(map()) && !fs::is_empty(map()))
                  left += hasEarlyCommit(Environment::open(map(), OpenMode::ReadOnly)->read());
                buildMap(scansOf(campus->files()), *inputs, map(), {.threads = threads(), .stage_points = 1}, sink);
              },
              {"", all}, all, [&] { return committedText(map()); });
  EXPECT_TRUE(MapReader(map()).isFinished());
  EXPECT_FALSE(hasEarlyCommit(Environment::open(map(), OpenMode::ReadOnly)->read()));
  EXPECT_GT(left, 0U) << "no build was killed after an early commit";
}

class EarlyCommitLeft : public KilledChange {
 protected:
  bool isLeft() const { return hasEarlyCommit(Environment::open(map(), OpenMode::ReadOnly)->read()); }
  /// Kills a large batch at the last report of progress before its commit, when the stages are done.
  void leave(const std::function<void()>& prepare, const Change& change) const {
    CountCalls counting;
    prepare();
    change(counting);
    bool is_left = false;
    for (std::size_t call = counting.calls; call > 0 && !is_left; --call) {
      prepare();
      rusage usage{};
      ended(
          [&] {
            KillAt sink(call);
            change(sink);
          },
          usage);
      is_left = isLeft();
    }
    ASSERT_TRUE(is_left) << "no report of progress follows an early commit";
  }
  void leaveByExtension() const {
    leave([&] { build({file(0)}, map()); },
          [&](ProgressSink& sink) {
            extendMap(map(), scansOf({file(1), file(2)}), {.stage_points = 1}, sink);
          });
  }
};

TEST_F(EarlyCommitLeft, OfAFirstBuildIsNoMap) {
  const auto build_all = [&](ProgressSink& sink) {
    buildMap(scansOf(campus->files()), *inputs, map(), {.stage_points = 1}, sink);
  };
  leave([&] { fs::remove(map()); }, build_all);
  EXPECT_TRUE(hasBuildToDo(map()));
  EXPECT_THROW(refuseUncommittedBuild(Environment::open(map(), OpenMode::ReadOnly)->read(), map()), Error);
  const fs::path statements = folder.path() / "statements.nt";
  writeFile(statements, "<http://a> <http://b> <http://c> .\n");
  EXPECT_THROW(loadRdfFiles(map(), {statements}, {}, silence()), Error);
  EXPECT_THROW(compactMap(map()), Error);
  EXPECT_THROW(copyCompacted(map(), folder.path() / "copy.clx"), Error);
  EXPECT_TRUE(isLeft());
  build_all(silence());
  EXPECT_FALSE(isLeft());
  EXPECT_TRUE(canonicalText(map()) == builtText(campus->files(), *inputs));
}

/// Where the tiles of such a map lie is stored before the first scan.
TEST_F(EarlyCommitLeft, OfAFirstBuildWithAnOriginBetweenTilesIsNoMap) {
  const fs::path manifest = folder.path() / "scans.yaml";
  std::string text = "map_origin: [5, 0, 0]\nscans:\n";
  for (const fs::path& file : campus->files()) text += "  - " + file.string() + "\n";
  writeFile(manifest, text);
  const auto build_all = [&](ProgressSink& sink) {
    buildMap(scansOf({manifest}), *inputs, map(), {.stage_points = 1}, sink);
  };
  leave([&] { fs::remove(map()); }, build_all);
  EXPECT_TRUE(hasBuildToDo(map()));
  EXPECT_THROW(refuseUncommittedBuild(Environment::open(map(), OpenMode::ReadOnly)->read(), map()), Error);
  build_all(silence());
  EXPECT_FALSE(isLeft());
  EXPECT_TRUE(canonicalText(map()) == builtText({manifest}, *inputs));
}

TEST_F(EarlyCommitLeft, GoesWithACompaction) {
  leaveByExtension();
  EXPECT_TRUE(canonicalText(map()) == builtText({file(0)}, *inputs));
  const fs::path copy = folder.path() / "copy.clx";
  copyCompacted(map(), copy);
  EXPECT_TRUE(isLeft());
  EXPECT_FALSE(fs::exists(copy.string() + "-lock"));
  compactMap(map());
  EXPECT_FALSE(isLeft());
  EXPECT_TRUE(canonicalText(map()) == builtText({file(0)}, *inputs));
  EXPECT_FALSE(hasEarlyCommit(Environment::open(copy, OpenMode::ReadOnly)->read()));
  EXPECT_EQ(fs::file_size(copy), fs::file_size(map()));
  EXPECT_TRUE(canonicalText(copy) == canonicalText(map()));
}

TEST_F(EarlyCommitLeft, IsNotTakenForOutputsOfTheMap) {
  leaveByExtension();
  extendMap(map(), scansOf({file(1)}), {}, silence());
  EXPECT_FALSE(isLeft());
  EXPECT_TRUE(canonicalText(map()) == builtText({file(0), file(1)}, *inputs));
  leaveByExtension();
  Eigen::Isometry3d pose = scansOf({file(1)}).file(0).T_map_sensor;  // where the killed command had another scan
  const ScanId id = scansOf({file(0)}).load(0).id;
  moveScans(map(), {{id, pose}}, {}, silence());
  EXPECT_FALSE(isLeft());
  const std::string moved = canonicalText(map());
  build({file(0)}, map());
  moveScans(map(), {{id, pose}}, {}, silence());
  EXPECT_TRUE(canonicalText(map()) == moved);
}

TEST_F(KilledBuild, AFaultyScanOfALargeBatchLeavesNothing) {
  build({file(0)}, map());
  const std::string before = canonicalText(map());
  const fs::path broken = folder.path() / "broken.pcd";
  const std::string bytes = readFile(file(2));
  writeFile(broken, bytes.substr(0, bytes.size() / 2));
  EXPECT_THROW(extendMap(map(), scansOf({file(1), file(2), broken}), {.stage_points = 1}, silence()), Error);
  EXPECT_TRUE(canonicalText(map()) == before);
  EXPECT_FALSE(hasEarlyCommit(Environment::open(map(), OpenMode::ReadOnly)->read()));
}

TEST_F(KilledBuild, ThatReplacesAMapKeepsTheOldOneToTheEnd) {
  build({file(0), file(1)}, map());
  const Statement sign = someStatement("StreetSign");
  const auto state = [&](const fs::path& file) { changeStatements(file, {{sign}, {}, "anna"}, {}, silence()); };
  state(map());
  const fs::path whole = folder.path() / "whole";
  build(campus->files(), whole);
  state(whole);
  expectAllOrNothing(
      [&](ProgressSink& sink) {
        buildMap(scansOf(campus->files()), *inputs, map(), {.threads = threads(), .batch_points = 1, .force = true},
                 sink);
      },
      canonicalText(whole));
  EXPECT_FALSE(fs::exists(map().string() + ".building"));
}

TEST_F(KilledBuild, AWatchGoesOn) {
  const fs::path scans = folder.path() / "scans";
  const auto arrive = [&](std::size_t stop) {
    // By a rename, so that a killed process leaves no half of a file.
    fs::copy_file(file(stop), scans / "arriving", fs::copy_options::overwrite_existing);
    fs::rename(scans / "arriving", scans / file(stop).filename());
  };
  const std::string two = builtText({file(0), file(1)}, *inputs), all = builtText(campus->files(), *inputs);
  expectExact(
      [&] {
        fs::remove(map());
        fs::remove_all(scans);
        fs::create_directory(scans);
        arrive(0), arrive(1);
      },
      [&](ProgressSink& sink) {
        std::size_t in_map = committedText(map()) == all ? 3 : 0;
        WatchCallbacks callbacks;
        callbacks.inputs = [] { return *inputs; };
        callbacks.committed = [&](const WatchCommit& commit) {
          in_map = commit.scans;
          if (in_map == 2) arrive(2);
        };
        callbacks.is_stopped = [&] { return in_map == 3; };
        if (committedText(map()) == two) arrive(2);  // it was killed before it told of its commit
        watchFolder(scans, map(), {.threads = threads(), .interval_s = 0.01, .idle_s = 120}, callbacks, sink);
      },
      {"", two, all}, all, [&] { return committedText(map()); });
}

TEST_F(KilledBuild, ACompactionKeepsTheMap) {
  build({file(0), file(1)}, map());
  leaveFree(map(), 8'000'000);
  const auto sparse = fs::file_size(map());
  expectAllOrNothing([&](ProgressSink&) { compactMap(map()); }, canonicalText(map()));
  EXPECT_LT(fs::file_size(map()) + 7'000'000, sparse);
}

TEST_F(KilledBuild, AChangeThatIsCompactedIsAllOrNothing) {
  build({file(0), file(1)}, map());
  leaveFree(map(), 20'000'000);
  const auto sparse = fs::file_size(map());
  const ScanId id = scansOf({file(1)}).load(0).id;
  expectAllOrNothing([&](ProgressSink& sink) { retractScans(map(), {id}, params(), sink); },
                     builtText({file(0)}, *inputs));
  const fs::path kept = folder.path() / "kept";
  fs::copy_file(kept, map(), fs::copy_options::overwrite_existing);
  retractScans(map(), {id}, {}, silence());
  EXPECT_LT(fs::file_size(map()) + 19'000'000, sparse) << "the change was not compacted";
}

TEST_F(KilledBuild, LeavesAFileThatIsNotUpdatedBeforeItsFirstCommit) {
  rdf::Environment::open(map(), rdf::OpenMode::Create);
  writeFile(map().string() + ".build-lock", "");
  EXPECT_THROW(updateMap(map(), "INSERT DATA { <urn:a> <urn:b> 1 }", {}, silence()), Error);
  EXPECT_TRUE(hasBuildToDo(map()));
}

}  // namespace
}  // namespace cluxel::mapping
