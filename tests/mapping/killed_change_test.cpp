// SPDX-License-Identifier: Apache-2.0
// A change that is killed at any moment leaves the exact map before or after a commit; the same command finishes it.
#include "mapping/killed_change.hpp"

#include "mapping/build/map_update.hpp"
#include "mapping/build/rdf_loading.hpp"
#include "mapping/change/map_merge.hpp"
#include "mapping/change/statement_change.hpp"
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

TEST_F(KilledChange, MovingManyScansGoesOnBatchByBatch) {
  build({file(0), file(1)}, map());
  const ScanSet both = scansOf({file(0), file(1)});
  std::vector<ScanPose> moves;
  std::vector<PosedScan> posed;
  for (const std::size_t i : {0U, 1U}) {
    Eigen::Isometry3d pose = both.file(i).T_map_sensor;
    pose.pretranslate(Eigen::Vector3d(0.5, 0.25, 0));
    moves.push_back({both.load(i).id, pose});
    posed.push_back({i, pose});
  }
  std::set<std::string> states;
  for (const bool first : {false, true})
    for (const bool second : {false, true}) {
      const fs::path moved = folder.path() / "moved";
      fs::remove(moved);
      const auto poseOf = [&](std::size_t i, bool is_moved) {
        return is_moved ? posed[i] : PosedScan{i, both.file(i).T_map_sensor};
      };
      buildMap(both.posed({poseOf(0, first), poseOf(1, second)}), *inputs, moved, {}, silence());
      states.insert(canonicalText(moved));
    }
  const std::string after = canonicalText(folder.path() / "moved");
  const fs::path kept = folder.path() / "kept";
  fs::copy_file(map(), kept);
  expectExact([&] { fs::copy_file(kept, map(), fs::copy_options::overwrite_existing); },
              [&](ProgressSink& sink) {
                ChangeParams one_by_one = params();
                one_by_one.batch_points = 1;
                moveScans(map(), moves, one_by_one, sink);
              },
              states, after, [&] { return canonicalText(map()); });
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

TEST_F(KilledChange, RetractingIsAllOrNothing) {
  build({file(0), file(1)}, map());
  const ScanId id = scansOf({file(1)}).load(0).id;
  expectAllOrNothing([&](ProgressSink& sink) { retractScans(map(), {id}, params(), sink); },
                     builtText({file(0)}, *inputs));
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
