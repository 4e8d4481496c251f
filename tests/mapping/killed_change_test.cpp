// SPDX-License-Identifier: Apache-2.0
// A change that is killed at any moment leaves the exact map before or after a commit; the same command finishes it.
#include "mapping/killed_change.hpp"

#include <algorithm>

#include "base/file_bytes.hpp"
#include "mapping/change/map_merge.hpp"
#include "mapping/change/map_update.hpp"
#include "mapping/change/rdf_loading.hpp"
#include "mapping/change/statement_change.hpp"
#include "mapping/facts/map_history.hpp"
#include "mapping/statements/statement.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {
namespace {

TEST_F(KilledChange, ExtendingGoesOn) {
  const std::string first = builtText({file(0)}, *inputs), two = builtText({file(0), file(1)}, *inputs),
                    all = builtText(campus->files(), *inputs);
  std::size_t local_commits = 0;
  expectExact([&] { build({file(0)}, map()); },
              [&](ProgressSink& sink) {
                ChangeParams in_two_batches = params();
                in_two_batches.batch_points = 1;
                local_commits += extendMap(map(), scansOf({file(1), file(2)}), in_two_batches, sink).local_commits;
              },
              {first, two, all}, all, [&] { return canonicalText(map()); });
  EXPECT_GT(local_commits, 0U) << "no change was computed around what changed";
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
        moveScans(map(), {{id, moved}}, params(), sink);
      },
      {before, after}, after, [&] { return canonicalText(map()); });
}

/// Scans that lie 80 m apart from each other in a row, as they are and all moved.
class ApartScans {
 public:
  std::size_t size() const { return campus_.files().size(); }
  /// The first `moved` of them moved.
  ScanSet scans(std::size_t moved) const {
    std::vector<PosedScan> posed;
    for (std::size_t i = 0; i < size(); ++i) posed.push_back({i, poseOf(i, i < moved)});
    return scansOf(campus_.files()).posed(posed);
  }
  /// All but `left_out` scans from the second one on.
  ScanSet withoutSome(std::size_t left_out) const {
    std::vector<PosedScan> posed{{0, poseOf(0, false)}};
    for (std::size_t i = 1 + left_out; i < size(); ++i) posed.push_back({i, poseOf(i, false)});
    return scansOf(campus_.files()).posed(posed);
  }
  /// Of all, in another order.
  std::vector<ScanPose> moves() const {
    std::vector<ScanPose> all;
    for (std::size_t i = size(); i-- > 0;) all.push_back({scansOf(campus_.files()).load(i).id, poseOf(i, true)});
    return all;
  }

 private:
  Eigen::Isometry3d poseOf(std::size_t i, bool is_moved) const {
    Eigen::Isometry3d pose = scansOf(campus_.files()).file(i).T_map_sensor;
    pose.translation().x() = 80 * static_cast<double>(i);
    if (is_moved) pose.pretranslate(Eigen::Vector3d(0.5, 0.25, 0));
    return pose;
  }
  SmallCampus campus_{{.seed = 8, .stops = 4, .size_m = 60, .points_per_stop = 1500, .max_range_m = 20}};
};

TEST_F(KilledChange, MovingManyScansGoesOnBatchByBatch) {
  const ApartScans apart;
  std::set<std::string> states;
  std::string after;
  for (std::size_t moved = 0; moved <= apart.size(); ++moved) {
    buildMap(apart.scans(moved), *inputs, map(), {.force = true}, silence());
    states.insert(after = canonicalText(map()));
  }
  EXPECT_EQ(states.size(), apart.size() + 1);
  const fs::path kept = folder.path() / "kept";
  buildMap(apart.scans(0), *inputs, kept, {}, silence());
  std::size_t local_commits = 0;
  const auto prepare = [&] { fs::copy_file(kept, map(), fs::copy_options::overwrite_existing); };
  const auto change = [&](ProgressSink& sink) {
    ChangeParams one_by_one = params();
    one_by_one.batch_points = 1;
    local_commits += moveScans(map(), apart.moves(), one_by_one, sink).local_commits;
  };
  expectExact(prepare, change, states, after, [&] { return canonicalText(map()); });
  EXPECT_GT(local_commits, 0U);

  // A dry run tells what all batches do.
  prepare();
  ChangeParams params{.batch_points = 1, .dry_run = true};
  const ChangeReport dry = moveScans(map(), apart.moves(), params, silence());
  EXPECT_TRUE(canonicalText(map()) == canonicalText(kept)) << "a dry run wrote";
  params.dry_run = false;
  const ChangeReport real = moveScans(map(), apart.moves(), params, silence());
  for (const ChangeReport* report : {&dry, &real}) EXPECT_EQ(report->scans_moved, apart.size());
  EXPECT_EQ(activitiesIn(MapReader(map()).quads()).size(), 1 + apart.size()) << "the build, and a commit for each scan";
  EXPECT_EQ(dry.objects.added, real.objects.added);
  EXPECT_EQ(dry.objects.gone, real.objects.gone);
  EXPECT_EQ(dry.objects.unchanged, real.objects.unchanged);
  EXPECT_EQ(dry.tiles_changed, real.tiles_changed);
}

TEST_F(KilledChange, AMergeIsThereWholeOrNotAtAll) {
  const fs::path a = folder.path() / "a", b = folder.path() / "b";
  build({file(0)}, a);
  build({file(1), file(2)}, b);
  const std::string all = builtText(campus->files(), *inputs);
  expectExact([&] { fs::remove(map()); },
              [&](ProgressSink& sink) {
                mergeMaps({{a}, {b}}, map(), {.change = params(), .use = std::nullopt, .force = false}, sink);
              },
              {"", all}, all, [&] { return fs::exists(map()) ? canonicalText(map()) : std::string(); });
  EXPECT_FALSE(fs::exists(map().string() + ".merging"));
}

TEST_F(KilledChange, AMergeOverAnOldMapLeavesThatOrTheWhole) {
  short_moments_ = 2;
  const fs::path a = folder.path() / "a", b = folder.path() / "b", old = folder.path() / "old";
  build({file(0)}, a);
  build({file(1), file(2)}, b);
  build({file(2)}, old);
  const std::string all = builtText(campus->files(), *inputs);
  expectExact([&] { fs::copy_file(old, map(), fs::copy_options::overwrite_existing); },
              [&](ProgressSink& sink) {
                mergeMaps({{a}, {b}}, map(), {.change = params(), .use = std::nullopt, .force = true}, sink);
              },
              {canonicalText(old), all}, all, [&] { return canonicalText(map()); });
  EXPECT_FALSE(fs::exists(map().string() + ".merging"));
}

TEST_F(KilledChange, AMergeOfAMapInAnotherFrameIsThereWholeOrNotAtAll) {
  short_moments_ = 2;
  const fs::path a = folder.path() / "a", b = folder.path() / "b";
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();  // exact in binary
  T.translation() = Eigen::Vector3d(64, -128, 0.5);
  build({file(0)}, a);
  const ScanSet others = scansOf({file(1), file(2)});
  std::vector<PosedScan> moved;
  for (std::size_t i = 0; i < others.size(); ++i) moved.push_back({i, T.inverse() * others.file(i).T_map_sensor});
  buildMap(others.posed(moved), *inputs, b, {}, silence());
  const std::string all = builtText(campus->files(), *inputs);
  expectExact([&] { fs::remove(map()); },
              [&](ProgressSink& sink) {
                mergeMaps({{a}, {b, T}}, map(), {.change = params(), .use = std::nullopt, .force = false}, sink);
              },
              {"", all}, all, [&] { return fs::exists(map()) ? canonicalText(map()) : std::string(); });
  EXPECT_FALSE(fs::exists(map().string() + ".merging"));
}

TEST_F(KilledChange, RetractingIsAllOrNothing) {
  build({file(0), file(1)}, map());
  const ScanId id = scansOf({file(1)}).load(0).id;
  expectAllOrNothing([&](ProgressSink& sink) { retractScans(map(), {id}, params(), sink); },
                     builtText({file(0)}, *inputs));
}

TEST_F(KilledChange, RetractingManyScansGoesOnBatchByBatch) {
  const ApartScans apart;
  const std::size_t gone = apart.size() - 1;
  std::set<std::string> states;
  std::string after;
  for (std::size_t scans = 0; scans <= gone; ++scans) {
    buildMap(apart.withoutSome(scans), *inputs, map(), {.force = true}, silence());
    states.insert(after = canonicalText(map()));
  }
  EXPECT_EQ(states.size(), gone + 1);
  const fs::path kept = folder.path() / "kept";
  buildMap(apart.scans(0), *inputs, kept, {}, silence());
  std::vector<ScanId> ids;
  for (const ScanPose& move : apart.moves()) ids.push_back(move.scan);
  ids.pop_back();  // the first one
  const auto prepare = [&] { fs::copy_file(kept, map(), fs::copy_options::overwrite_existing); };
  std::size_t local_commits = 0;
  const auto change = [&](ProgressSink& sink) {
    ChangeParams one_by_one = params();
    one_by_one.batch_points = 1;
    local_commits += retractScans(map(), ids, one_by_one, sink).local_commits;
  };
  expectExact(prepare, change, states, after, [&] { return canonicalText(map()); });
  EXPECT_GT(local_commits, 0U);

  // All but none may go, and nothing goes before that is known.
  prepare();
  for (const ScanPose& move : apart.moves())
    if (std::find(ids.begin(), ids.end(), move.scan) == ids.end()) ids.push_back(move.scan);
  EXPECT_THROW(retractScans(map(), ids, {.batch_points = 1}, silence()), Error);
  EXPECT_TRUE(canonicalText(map()) == canonicalText(kept));
  ids.pop_back();
  ChangeParams params{.batch_points = 1, .dry_run = true};
  const ChangeReport dry = retractScans(map(), ids, params, silence());
  EXPECT_TRUE(canonicalText(map()) == canonicalText(kept)) << "a dry run wrote";
  params.dry_run = false;
  const ChangeReport real = retractScans(map(), ids, params, silence());
  for (const ChangeReport* report : {&dry, &real}) EXPECT_EQ(report->scans_removed, gone);
  EXPECT_EQ(activitiesIn(MapReader(map()).quads()).size(), 1 + gone) << "the build, and a commit for each scan";
  EXPECT_EQ(dry.objects.gone, real.objects.gone);
  EXPECT_EQ(dry.tiles_changed, real.tiles_changed);
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
            map(), [&](const MapInputs&) { return other; }, params(), sink);
      },
      builtText({file(0), file(1)}, other));
}

TEST_F(KilledChange, ApplyingAModelAndAnOntologyIsAllOrNothing) {
  build({file(0), file(1)}, map());
  MapInputFiles with_model;
  with_model.model = test::sourceFolder() / "models/campus/model.json";
  MapInputs other = readMapInputs(with_model, DataHome(test::sourceFolder()));
  ASSERT_NE(other.model.text, inputs->model.text);
  other.ontology.back().text += "\n<" + vocabulary::clx("Tree") + "> a <https://example.org/Plant> .\n";
  expectAllOrNothing(
      [&](ProgressSink& sink) {
        applyInputs(
            map(), [&](const MapInputs&) { return other; }, params(), sink);
      },
      builtText({file(0), file(1)}, other));
}

TEST_F(KilledChange, StatingAndWithdrawingAreAllOrNothing) {
  build({file(0), file(1)}, map());
  const Statement first = someStatement("StreetSign"), second = someStatement("Barrier");
  changeStatements(map(), {{first}, {}, "anna"}, {}, silence());
  const Change change = [&](ProgressSink& sink) {
    changeStatements(map(), {{second}, {first.id()}, "anna"}, params(), sink);
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

TEST_F(KilledChange, LoadingIsAllOrNothing) {
  build({file(0), file(1)}, map());
  const fs::path statements = folder.path() / "statements.nt";
  writeFile(statements, "<" + rdf::iriOfObject(MapReader(map()).objects().front().id) + "> <" +
                            vocabulary::rdfs("label") + "> \"lawn\" .\n");
  const Change change = [&](ProgressSink& sink) { loadRdfFiles(map(), {statements}, {}, sink); };
  expectAllOrNothing(change, after(change));
}

}  // namespace
}  // namespace cluxel::mapping
