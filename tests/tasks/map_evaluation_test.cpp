// SPDX-License-Identifier: Apache-2.0
// Evaluation of a generated map, compared with a plain count over the points, and of answers equal to the truth.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

#include "base/file_bytes.hpp"
#include "tasks/campus_map_fixture.hpp"
#include "tasks/evaluation/evaluation.hpp"
#include "tasks/evaluation/shared_scans.hpp"
#include "test_paths.hpp"

namespace cluxel::tasks {

using namespace scan;
using namespace perception;
using namespace simulation;
using namespace rdf;
using namespace sparql;
using namespace rules;
using namespace mapping;
namespace {

/// A truth folder as `--truth` takes it, out of the campus's own truth.
class TruthFolder {
 public:
  TruthFolder() {
    const SmallCampus& campus = CampusMap::shared().campus();
    for (std::size_t i = 0; i < campus.scans().size(); ++i) {
      const PointTruth& truth = campus.scans()[i].truth;
      std::ofstream out(folder_.path() / (campus.files()[i].stem().string() + ".truth"));
      for (std::size_t p = 0; p < truth.primitive.size(); ++p)
        out << static_cast<int>(truth.primitive[p]) << ' ' << static_cast<int>(truth.object_class[p]) << ' '
            << truth.instance[p] << '\n';
    }
  }
  TruthSource source() const { return TruthSource::open(folder_.path(), DataHome(test::sourceFolder())); }

 private:
  ScratchFolder folder_;
};

std::filesystem::path written(const ScratchFolder& folder, const std::string& name, const std::string& text) {
  writeFile(folder.path() / name, text);
  return folder.path() / name;
}

const PointTruth& truthOf(const Cloud& cloud) {
  const SmallCampus& campus = CampusMap::shared().campus();
  const auto stem = std::filesystem::path(cloud.source).stem();
  for (std::size_t i = 0; i < campus.files().size(); ++i)
    if (campus.files()[i].stem() == stem) return campus.scans()[i].truth;
  throw std::out_of_range("no stop of the campus is named " + stem.string());
}

const MapEvaluation& evaluation() {
  static const MapEvaluation made = evaluateMap(CampusMap::shared().map(), TruthFolder().source());
  return made;
}

TEST(MapEvaluation, CountsEveryPointThatHasTruthOnce) {
  const MapReader& map = CampusMap::shared().map();
  std::map<std::pair<int, int>, std::uint64_t> primitives;
  std::uint64_t with_class = 0;
  for (const Cloud& cloud : map.clouds()) {
    const PointAnswers answers = map.answersFor(cloud);
    const PointTruth& truth = truthOf(cloud);
    ASSERT_EQ(truth.primitive.size(), answers.label.size()) << cloud.source;
    for (std::size_t i = 0; i < answers.label.size(); ++i) {
      if (truth.primitive[i] >= 0) ++primitives[{truth.primitive[i], answers.label[i]}];
      with_class += truth.object_class[i] >= 0 ? 1 : 0;
    }
  }
  ASSERT_FALSE(primitives.empty());
  for (const auto& [pair, count] : primitives)
    EXPECT_EQ(evaluation().primitives.at(static_cast<std::size_t>(pair.first), static_cast<std::size_t>(pair.second)),
              count)
        << pair.first << " taken for " << pair.second;
  EXPECT_EQ(evaluation().objects.total(), with_class);
}

TEST(MapEvaluation, FindsMostOfAGeneratedCampus) {
  const MapEvaluation& made = evaluation();
  EXPECT_TRUE(made.has_instances);
  EXPECT_GT(made.primitives.overallAccuracy(), 0.95);
  EXPECT_GT(made.objects.overallAccuracy(), 0.9);
  const auto tree =
      std::find_if(made.by_points.begin(), made.by_points.end(), [](const auto& s) { return s.name == "Tree"; });
  ASSERT_NE(tree, made.by_points.end());
  EXPECT_GT(tree->truth, 0U);
  EXPECT_GT(tree->recall(), 0.5);
  for (const auto* scores : {&made.by_points, &made.by_box})
    for (const ObjectScore& score : *scores) {
      EXPECT_LE(score.matched_truth, score.truth) << score.name;
      EXPECT_LE(score.matched_answers, score.answers) << score.name;
    }
}

TEST(MapEvaluation, CountsClassesThatOnlyALabelMapNames) {
  const ScratchFolder folder;
  const auto labels =
      written(folder, "m.yaml",
              "dataset: d\nlabels:\n  1: {name: lawn, object: Ground}\n  3: {name: street, object: Racetrack}\n");
  const MapReader& map = CampusMap::shared().map();
  std::uint64_t lawn = 0, street = 0;
  for (const Cloud& cloud : map.clouds())
    for (const std::uint32_t label : map.pointsOf(cloud.id).label) lawn += label == 1, street += label == 3;
  ASSERT_GT(street, 0U);
  const MapEvaluation made = evaluateMap(map, TruthSource::open(labels, DataHome(test::sourceFolder())));
  const auto track = static_cast<std::size_t>(
      std::find(made.objects.names.begin(), made.objects.names.end(), "Racetrack") - made.objects.names.begin());
  ASSERT_LT(track, made.objects.names.size());
  EXPECT_EQ(made.objects.total(), lawn + street);
  EXPECT_EQ(made.objects.truthCount(track), street);
  EXPECT_EQ(made.objects.at(track, track), 0U) << "no rule makes racetracks";
  EXPECT_LE(made.objects.overallAccuracy(), static_cast<double>(lawn) / static_cast<double>(lawn + street));
}

TEST(MapEvaluation, OfTwoMapsAddsTheirCounts) {
  MapEvaluation sum = evaluation();
  sum.add(evaluation());
  EXPECT_EQ(sum.objects.total(), 2 * evaluation().objects.total());
  EXPECT_EQ(sum.primitives.at(0, 0), 2 * evaluation().primitives.at(0, 0));
  EXPECT_EQ(sum.matched_whole, 2 * evaluation().matched_whole);
  EXPECT_EQ(sum.calibration.objects(), 2 * evaluation().calibration.objects());
  EXPECT_EQ(sum.crown_pairs.pairs, 2 * evaluation().crown_pairs.pairs);
  EXPECT_DOUBLE_EQ(sum.objects.macroF1(), evaluation().objects.macroF1());
  for (std::size_t i = 0; i < sum.by_points.size(); ++i) {
    EXPECT_EQ(sum.by_points[i].matched_truth, 2 * evaluation().by_points[i].matched_truth);
    EXPECT_EQ(sum.by_box[i].answers, 2 * evaluation().by_box[i].answers);
  }
  ASSERT_EQ(sum.kinds.size(), evaluation().kinds.size());
  for (std::size_t i = 0; i < sum.kinds.size(); ++i) EXPECT_EQ(sum.kinds[i].truth, 2 * evaluation().kinds[i].truth);
  MapEvaluation other{ConfusionMatrix({"scatter"}), ConfusionMatrix({"Tree"}), false, {}, {}, {}};
  EXPECT_THROW(other.add(evaluation()), Error);
}

TEST(SharedScans, AreThoseThatAnEarlierMapHolds) {
  const std::vector<Cloud> all = CampusMap::shared().map().clouds();
  ASSERT_GE(all.size(), 2U);
  const std::string first = all[0].id.hex(), second = all[1].id.hex();
  SharedScans scans;
  EXPECT_EQ(scans.add("a.clx", {all[0]}), std::nullopt);
  EXPECT_FALSE(scans.isOfEarlierMap(first)) << "the map itself is no earlier one";
  const auto shared = scans.add("b.clx", {all[0], all[1]});
  ASSERT_TRUE(shared.has_value());
  EXPECT_EQ(*shared, "b.clx: 1 of its 2 scans is in earlier maps, too (" + all[0].source + " in a.clx)");
  EXPECT_TRUE(scans.isOfEarlierMap(first));
  EXPECT_FALSE(scans.isOfEarlierMap(second));
}

TEST(MapEvaluation, CallsNearlyAllFoundObjectsByTheirOwnClass) {
  for (const KindAnswers& kind : evaluation().kinds) {
    const auto own = std::find_if(evaluation().by_points.begin(), evaluation().by_points.end(),
                                  [&](const ObjectScore& score) { return score.name == kind.name; });
    ASSERT_NE(own, evaluation().by_points.end()) << kind.name << ": truth files have no other kinds";
    EXPECT_EQ(kind.truth, own->truth);
    EXPECT_EQ(kind.found[static_cast<std::size_t>(own - evaluation().by_points.begin())], own->matched_truth);
    EXPECT_EQ(std::accumulate(kind.found.begin(), kind.found.end(), std::uint64_t{0}), kind.truth);
    EXPECT_EQ(std::accumulate(kind.boxed.begin(), kind.boxed.end(), std::uint64_t{0}), kind.truth);
    EXPECT_EQ(std::accumulate(kind.called.begin(), kind.called.end(), std::uint64_t{0}), kind.truth);
  }
}

TEST(MapEvaluation, ScoresOnlyLabelledObjectsWhereSomeAreLabelled) {
  // Two cars of eight points and a wall that nobody labelled; the numbers begin anew in each scan.
  const ScratchFolder folder;
  std::string points;
  for (int i = 0; i < 40; ++i)
    points += std::to_string(0.1 * i) + " 0 " + std::to_string(0.1 * (i % 7)) + (i < 8 ? " 3 0\n" : " 0 -1\n");
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 40\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar label\nproperty int number\nend_header\n";
  std::filesystem::create_directory(folder.path() / "b");
  const auto first = written(folder, "a.ply", header + points);
  const auto second = written(folder, "b/a.ply", header + "9" + points);
  const auto labels = written(folder, "m.yaml",
                              "coverage: some\ninstance_field: number\nlabels:\n"
                              "  0: {name: not_labelled}\n  3: {name: lorry, object: Vehicle}\n");
  const DataHome home(test::sourceFolder());
  const auto file = folder.path() / "m.clx";
  buildMap(scansOf({first, second}), readMapInputs({}, home), file, {}, silence());
  const MapEvaluation made = evaluateMap(MapReader(file), TruthSource::open(labels, home));
  EXPECT_FALSE(made.covers_all);
  ASSERT_EQ(made.kinds.size(), 1U);
  EXPECT_EQ(made.kinds[0].name, "lorry");
  EXPECT_EQ(made.kinds[0].truth, 2U) << "number 0 of either scan";
  EXPECT_EQ(made.objects.total(), 16U);
  EXPECT_NE(toText(made).find("Only some objects are labelled"), std::string::npos);
  std::filesystem::remove(second);
  EXPECT_THROW(evaluateMap(MapReader(file), TruthSource::open(labels, home)), InputError);
}

TEST(TruthSource, PrefersALabelMapOfTheHomeToAFolderOfItsName) {
  const ScratchFolder folder;
  const auto before = std::filesystem::current_path();
  std::filesystem::create_directories(folder.path() / "oakland");
  std::filesystem::create_directories(folder.path() / "elsewhere");
  std::filesystem::current_path(folder.path());
  const DataHome home(test::sourceFolder());
  EXPECT_EQ(locateTruth("oakland", home), test::sourceFolder() / "labels/oakland.yaml");
  EXPECT_EQ(locateTruth("elsewhere", home), "elsewhere");
  EXPECT_EQ(locateTruth("./oakland", home), "./oakland");
  std::filesystem::current_path(before);
}

TEST(TruthSource, MeansTheClassesThatItsLabelsStandFor) {
  const DataHome home(test::sourceFolder());
  const TruthClasses merged = TruthSource::open(locateTruth("nuscenes", home), home).classes();
  EXPECT_EQ(merged.meant, (std::set<std::string>{"Ground", "StaticOrPlant", "Person", "Vehicle"}));
  // Vegetation may be a tree or a bush there, a trunk is a tree's.
  const TruthClasses kitti = TruthSource::open(locateTruth("semantickitti", home), home).classes();
  EXPECT_TRUE(kitti.meant.contains("Tree"));
  EXPECT_FALSE(kitti.meant.contains("Bush"));
  const ScratchFolder folder;
  const TruthClasses files = TruthSource::open(folder.path(), home).classes();
  EXPECT_EQ(files.meant, std::set<std::string>(files.names.begin(), files.names.end()));
}

TEST(MapEvaluation, RefusesOneTruthFileForTwoScans) {
  const ScratchFolder folder;
  for (const char* place : {"a", "b"}) {
    std::filesystem::create_directory(folder.path() / place);
    std::string points;
    for (int i = 0; i < 50; ++i) points += std::to_string(0.1 * i) + " 0 " + (place[0] == 'a' ? "0" : "1") + "\n";
    written(folder, std::string(place) + "/scan.xyz", points);
  }
  std::filesystem::create_directory(folder.path() / "truth");
  std::string lines;
  for (int i = 0; i < 50; ++i) lines += "0 0 -1\n";
  written(folder, "truth/scan.truth", lines);
  const auto file = folder.path() / "m.clx";
  const DataHome home(test::sourceFolder());
  buildMap(scansOf({folder.path() / "a/scan.xyz", folder.path() / "b/scan.xyz"}), readMapInputs({}, home), file, {},
           silence());
  const auto evaluated = [&] { return evaluateMap(MapReader(file), TruthSource::open(folder.path() / "truth", home)); };
  EXPECT_THROW(evaluated(), InputError);
  std::filesystem::create_directory(folder.path() / "truth/b");
  written(folder, "truth/b/scan.truth", lines);
  EXPECT_EQ(evaluated().objects.total(), 100U);
}

TEST(MapEvaluation, DoesNotScoreGroundByObject) {
  for (const ObjectScore& score : evaluation().by_points) {
    if (score.name != "Ground") continue;
    EXPECT_EQ(score.truth, 0U);
    EXPECT_EQ(score.answers, 0U) << "the row `all` would count them as false";
  }
}

TEST(MapEvaluation, ShowsADashWhereThereIsNoTruthAndNullInJson) {
  MapEvaluation made{ConfusionMatrix({"scatter"}), ConfusionMatrix({"Tree", "Bush", "Vehicle"}), true, {}, {}};
  made.primitives.add(0, 0);
  made.objects.add(0, 0);
  made.objects.add(0, 1);  // a bush where there is none
  made.by_points = {{"Tree", 1, 1, 1, 1}, {"Bush", 0, 1, 0, 0}, {"Vehicle", 0, 0, 0, 0}};
  made.by_box = made.by_points;
  const std::string text = toText(made);
  EXPECT_NE(text.find("Bush                  0.000        -        -        -   0"), std::string::npos) << text;
  const std::string dash = "       -              ";
  EXPECT_NE(text.find("Bush                 0.000 (0.00-0.79)  " + dash + dash + "0\n"), std::string::npos) << text;
  const auto json = nlohmann::json::parse(toJson(made));
  EXPECT_TRUE(json.at("objects_by_point").at("classes")[1].at("recall").is_null());
  EXPECT_DOUBLE_EQ(json.at("objects_by_point").at("classes")[0].at("recall").get<double>(), 0.5);
  EXPECT_TRUE(json.at("objects_by_point_set")[2].at("precision").is_null());
}

}  // namespace
}  // namespace cluxel::tasks
