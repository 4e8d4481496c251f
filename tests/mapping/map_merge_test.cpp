// SPDX-License-Identifier: Apache-2.0
// Merging gives the map of a build from all scans, byte for byte.
#include "mapping/change/map_merge.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "mapping/build/operator_statements.hpp"
#include "mapping/change/map_change.hpp"
#include "mapping/change/map_update.hpp"
#include "mapping/small_campus.hpp"
#include "rdf/file/map_replacement.hpp"
#include "rdf/other_process.hpp"
#include "sparql/query_engine.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class MapMerge : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    campus = new SmallCampus({.seed = 6, .stops = 4, .size_m = 45, .points_per_stop = 1200});
    inputs = new MapInputs(shippedInputs());
    whole = new std::string(builtText(campus->files(), *inputs));
  }
  static void TearDownTestSuite() {
    delete campus;
    delete inputs;
    delete whole;
  }
  /// Builds a map of some stops, all moved by T.
  fs::path built(const std::vector<std::size_t>& stops, const std::string& name,
                 const Eigen::Isometry3d& T = Eigen::Isometry3d::Identity()) const {
    const ScanSet all = scansOf(campus->files());
    std::vector<PosedScan> chosen;
    for (const std::size_t stop : stops) chosen.push_back({stop, T * all.file(stop).T_map_sensor});
    buildMap(all.posed(chosen), *inputs, folder.path() / name, {}, silence());
    return folder.path() / name;
  }
  fs::path target() const { return folder.path() / "all.clx"; }
  ChangeReport merge(const std::vector<MapToMerge>& maps, const MergeParams& params = {}) const {
    return mergeMaps(maps, target(), params, silence());
  }
  std::string refusal(const std::vector<MapToMerge>& maps) const {
    try {
      merge(maps);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
  }

  ScratchFolder folder;
  inline static SmallCampus* campus = nullptr;
  inline static MapInputs* inputs = nullptr;
  inline static std::string* whole = nullptr;
};

TEST_F(MapMerge, OfTwoToFourMapsInAnyOrderIsTheBuildFromAllScans) {
  const fs::path a = built({0}, "a"), b = built({1}, "b"), c = built({2}, "c"), d = built({3}, "d");
  const fs::path bc = built({1, 2}, "bc"), ad = built({3, 0}, "ad"), abc = built({0, 1, 2}, "abc");
  const std::vector<std::vector<MapToMerge>> splits{{{a}, {bc}, {d}}, {{d}, {abc}}, {{bc}, {ad}}, {{d}, {c}, {b}, {a}}};
  for (const auto& maps : splits) {
    for (const unsigned threads : {1U, 2U}) {
      fs::remove(target());
      const ChangeReport report = merge(maps, {.change = {.threads = threads}, .use = std::nullopt, .force = false});
      EXPECT_EQ(report.scans, 4U);
      EXPECT_TRUE(canonicalText(target()) == *whole) << maps.front().file << ", " << threads << " threads";
      EXPECT_FALSE(fs::exists(target().string() + ".merging"));
    }
  }
}

TEST_F(MapMerge, CountsScansThatBothHoldOnce) {
  const ChangeReport report = merge({{built({0, 1, 2}, "a")}, {built({1, 2, 3}, "b")}});
  EXPECT_EQ(report.scans_already_there, 2U);
  EXPECT_TRUE(canonicalText(target()) == *whole);
}

TEST_F(MapMerge, BringsTheSecondMapIntoTheFrameOfTheFirst) {
  Eigen::Isometry3d shift = Eigen::Isometry3d::Identity();  // exact in binary, so that no coordinate is rounded twice
  shift.translation() = Eigen::Vector3d(64, -128, 0.5);
  Eigen::Isometry3d turned = shift;  // by a right angle, which is exact, too
  turned.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  const fs::path a = built({0, 1}, "a");
  for (const Eigen::Isometry3d& T : {shift, turned}) {
    const fs::path b = built({2, 3}, "b", T.inverse());
    fs::remove(target());
    merge({{a}, {b, T}});
    EXPECT_TRUE(canonicalText(target()) == *whole);
    fs::remove(b);
  }
}

TEST_F(MapMerge, KeepsTheStatementsOfAllMaps) {
  const fs::path a = built({0, 1}, "a"), b = built({2, 3}, "b");
  const std::string label = "<http://www.w3.org/2000/01/rdf-schema#label>";
  updateMap(a, "INSERT DATA { <https://example.org/a> " + label + " \"first\" . _:x " + label + " \"one\" }", {},
            silence());
  updateMap(b, "INSERT DATA { <https://example.org/b> " + label + " \"second\" . _:x " + label + " \"two\" }", {},
            silence());
  merge({{a}, {b}});
  const std::string text = canonicalText(target());
  EXPECT_THAT(text, HasSubstr("<https://example.org/a> " + label + " \"first\""));
  EXPECT_THAT(text, HasSubstr("<https://example.org/b> " + label + " \"second\""));
  const MapReader map(target());
  const auto both =
      sparql::evaluateQuery(map.quads(), "ASK { ?x <http://www.w3.org/2000/01/rdf-schema#label> 'one', 'two' }", {});
  EXPECT_FALSE(both.boolean) << "blank nodes of two maps are two things";
}

TEST_F(MapMerge, SaysOnceWhatTheMapsSayOfBlankNodes) {
  const fs::path a = built({0, 1}, "a"), b = built({2, 3}, "b"), turned = folder.path() / "turned";
  const auto insert = [](const fs::path& map, const std::string& quads) {
    updateMap(map, "INSERT DATA { " + quads + " }", {}, silence());
  };
  insert(a, "[] <http://x/p> 'x' . [] <http://x/p> [ <http://x/q> 1 ]");
  insert(b, "[] <http://x/p> 'y'");
  insert(b, "[] <http://x/p> 'x'");
  const std::string tree = "a <" + rdf::vocabulary::clx("Tree") + ">";
  insert(b, "_:x " + tree + " ; <" + rdf::vocabulary::clx("near") + "> _:y . _:y " + tree);
  merge({{a}, {b}});
  mergeMaps({{b}, {a}}, turned, {}, silence());
  const std::string text = canonicalText(target());
  EXPECT_EQ(canonicalText(turned), text) << "in either order";
  EXPECT_THAT(text, HasSubstr("neighbourTree> _:c14n")) << "a rule has derived something";
  const MapReader map(target());
  EXPECT_EQ(operatorStatements(map.quads()).size(), 7U);
  const fs::path again = folder.path() / "again";
  mergeMaps({{target()}, {a}}, again, {}, silence());
  EXPECT_EQ(canonicalText(again), text) << "an old copy says nothing new";
  EXPECT_EQ(mergeMaps({{target()}, {a}}, again, {}, silence()).scans_added, 0U) << "it is known as the merge";
}

TEST_F(MapMerge, RefusesWhatHasNoOneAnswerAndLeavesNothing) {
  const fs::path a = built({0, 1}, "a");
  Eigen::Isometry3d shift = Eigen::Isometry3d::Identity();
  shift.translation().x() = 0.25;
  EXPECT_THAT(refusal({{a}}), HasSubstr("at least two"));
  EXPECT_THAT(refusal({{a}, {built({1, 2}, "moved", shift)}}), HasSubstr("with another pose"));
  MapInputs other = *inputs;
  other.rules.front().text += "\n# another comment\n";
  buildMap(scansOf({campus->files()[2]}), other, folder.path() / "other", {}, silence());
  EXPECT_THAT(refusal({{a}, {folder.path() / "other"}}), HasSubstr("differs from"));
  EXPECT_FALSE(fs::exists(target()));
  EXPECT_FALSE(fs::exists(target().string() + ".merging"));
}

TEST_F(MapMerge, TellsWhatIsWrongWithATransformOrTheScansOfTwoFrames) {
  Eigen::Isometry3d shift = Eigen::Isometry3d::Identity();
  shift.translation().x() = 0.1;
  const fs::path a = built({0, 1}, "a"), b = built({1, 2}, "b", shift);
  EXPECT_THAT(refusal({{a}, {b}}), testing::AllOf(HasSubstr("with another pose (0.100 m and 0.000 degrees away)"),
                                                  HasSubstr("give it the same pose in both")));
  shift.translation().x() = -0.1 + 1e-9;
  EXPECT_THAT(refusal({{a}, {b, shift, true}}), testing::AllOf(HasSubstr("with a pose that differs by rounding alone"),
                                                               HasSubstr("retract it from one of them")));
  for (const Eigen::Vector3d& far : {Eigen::Vector3d(1e8, 0, 0), Eigen::Vector3d(0, 0, 3e4)}) {
    shift.translation() = far;
    EXPECT_THAT(refusal({{a}, {b, shift, true}}), HasSubstr("check the translation of the transform"));
  }
  EXPECT_FALSE(fs::exists(target()));
  EXPECT_FALSE(fs::exists(target().string() + ".merging"));
}

TEST_F(MapMerge, ReplacesNoFileThatIsNoMap) {
  const std::vector<MapToMerge> maps{{built({0}, "a")}, {built({1}, "b")}};
  writeFile(target(), "what somebody wrote\n");
  for (const bool force : {false, true}) {
    MergeParams params;
    params.force = force;
    EXPECT_THROW(mergeMaps(maps, target(), params, silence()), Error);
    EXPECT_EQ(readFile(target()), "what somebody wrote\n");
  }
}

/// What took hours would be lost.
TEST_F(MapMerge, WaitsForWhoWritesTheFileThatItReplaces) {
  const fs::path a = built({0, 1}, "a"), b = built({2, 3}, "b");
  fs::copy_file(a, target());
  rdf::OtherProcess writer([&](const rdf::Pause& pause) {
    const rdf::WriteTransaction transaction = rdf::writeMap(target());
    pause();
    return 0;
  });
  class EndingSink : public ProgressSink {
   public:
    explicit EndingSink(rdf::OtherProcess& writer) : writer_(writer) {}
    void note(std::string_view text) override {
      if (text.find("another process writes") == std::string_view::npos) return;
      ++waits;
      writer_.end();
    }
    int waits = 0;

   private:
    rdf::OtherProcess& writer_;
  };
  EndingSink sink(writer);
  MergeParams params;
  params.force = true;
  mergeMaps({{a}, {b}}, target(), params, sink);
  EXPECT_EQ(sink.waits, 1);
  EXPECT_EQ(canonicalText(target()), *whole);
}

TEST_F(MapMerge, DoesNotCareWhereTheInputsWereRead) {
  const fs::path a = built({0, 1}, "a"), b = folder.path() / "b";
  MapInputs elsewhere = *inputs;
  for (auto* texts : {&elsewhere.ontology, &elsewhere.rules, &elsewhere.sparql_rules})
    for (NamedText& text : *texts) text.name = "/usr/share/cluxel/" + fs::path(text.name).filename().string();
  elsewhere.model.name = "/usr/share/cluxel/model.json";
  buildMap(scansOf({campus->files()[2], campus->files()[3]}), elsewhere, b, {}, silence());
  merge({{a}, {b}});
  EXPECT_TRUE(canonicalText(target()) == *whole);
}

TEST_F(MapMerge, RefusesOneFileTwiceAndATargetThatIsOneOfTheMaps) {
  const fs::path a = built({0, 1}, "a"), b = built({2, 3}, "b"), link = folder.path() / "link";
  fs::create_symlink(a, link);
  EXPECT_THAT(refusal({{a}, {link}}), HasSubstr("is named twice"));
  const std::string before = readFile(a);
  try {
    mergeMaps({{a}, {b}}, link, {.change = {}, .use = std::nullopt, .force = true}, silence());
    ADD_FAILURE() << "was not refused";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("is one of the maps"));
  }
  EXPECT_TRUE(readFile(a) == before);
}

TEST_F(MapMerge, UsesTheRulesOfTheMapThatIsNamed) {
  MapInputs other = *inputs;
  const std::string threshold = "group: { near: 1.5 m }";
  std::string& text = other.rules.front().text;
  text.replace(text.find(threshold), threshold.size(), "group: { near: 0.2 m }");
  const fs::path a = built({0, 1, 2}, "a"), b = folder.path() / "b";
  buildMap(scansOf({campus->files()[3]}), other, b, {}, silence());
  merge({{a}, {b}}, {.change = {}, .use = 1, .force = false});
  EXPECT_TRUE(canonicalText(target()) == builtText(campus->files(), other));
}

}  // namespace
}  // namespace cluxel::mapping
