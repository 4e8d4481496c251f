// SPDX-License-Identifier: Apache-2.0
// Label maps whose classes match no answer of a map.
#include "tasks/evaluation/label_map_check.hpp"

#include <gtest/gtest.h>

#include "cluxel/error.hpp"
#include "mapping/map_inputs.hpp"
#include "rdf/vocabulary.hpp"
#include "scan/truth/truth_parsers.hpp"
#include "test_paths.hpp"

namespace cluxel::tasks {

using namespace scan;
using namespace rdf;
using namespace rules;
using namespace mapping;
namespace {

/// The classes of the doubtful label map below, as the shipped ontology has them.
ClassCatalogue smallCatalogue() {
  using vocabulary::clx;
  return {{{clx("Object"), {}, {}},
           {clx("Tree"), {clx("Object")}, {clx("TreeTrunk"), clx("TreeTop")}},
           {clx("SmallObject"), {clx("Object")}, {}},
           {clx("Person"), {clx("Object")}, {}},
           {clx("TreeTrunk"), {clx("Part")}, {}},
           {clx("TreeTop"), {clx("Part")}, {}},
           {clx("Avenue"), {clx("Place")}, {}}}};
}

std::vector<std::string> doubtsAbout(const std::string& text) {
  const LabelMap labels(parseLabelMap(text, "my.yaml"));
  const ClassCatalogue catalogue = smallCatalogue();
  return LabelMapCheck(labels, catalogue, "my.yaml").run();
}

TEST(LabelMapCheck, TellsOfClassesThatMatchNoAnswer) {
  const auto about = [](const std::string& label) {
    return doubtsAbout("labels: { 1: { name: x, " + label + " } }\n");
  };
  EXPECT_TRUE(about("object: Tree, part: TreeTrunk").empty());
  for (const auto& [label, doubt] : std::vector<std::pair<std::string, std::string>>{
           {"object: Treee",
            "my.yaml: the ontology of the map has no class 'Treee', so no answer is of it; did you "
            "mean 'Tree'?"},
           {"object: TreeTop", "'object: TreeTop' is no class of objects"},
           {"object: Avenue", "'object: Avenue' is no class of objects"},
           {"object: Tree, part: TreeTrank",
            "'part: TreeTrank' is no part of Tree in the ontology of the map; did you "
            "mean 'TreeTrunk'?"}}) {
    const std::vector<std::string> doubts = about(label);
    ASSERT_EQ(doubts.size(), 1U) << label;
    EXPECT_NE(doubts.front().find(doubt), std::string::npos) << doubts.front();
  }
}

TEST(LabelMapCheck, TellsWhichClassALocalNameOfSeveralMeans) {
  const LabelMap labels(
      parseLabelMap("labels: { 1: { name: x, object: Tree }, 2: { name: y, object: Car } }\n", "my.yaml"));
  ClassCatalogue catalogue = smallCatalogue();
  for (const char* iri : {"http://town/Tree", "http://town/Car", "http://store/Car"})
    catalogue.classes.push_back({iri, {vocabulary::clx("Object")}, {}});
  const std::vector<std::string> doubts = LabelMapCheck(labels, catalogue, "my.yaml").run();
  ASSERT_EQ(doubts.size(), 2U);
  EXPECT_EQ(doubts[0], "my.yaml: 'Tree' means <" + vocabulary::clx("Tree") +
                           "> alone; answers of <http://town/Tree> count as their superclass");
  EXPECT_EQ(doubts[1],
            "my.yaml: 'Car' is the local name of several classes in the ontology of the map: <http://store/Car>, "
            "<http://town/Car>; no answer is of it, and each counts as its superclass");
}

TEST(LabelMapCheck, TakesClassesOfTheTruthThatAnswersCountAs) {
  EXPECT_TRUE(
      doubtsAbout("counts_as: { Tree: StaticOrPlant }\nlabels: { 1: { name: x, object: StaticOrPlant } }\n").empty());
  const auto doubts = doubtsAbout("labels: { 1: { name: x, object: StaticOrPlant } }\n");
  EXPECT_EQ(doubts.size(), 1U);
}

TEST(LabelMapCheck, TellsOfClassesInCountsAsThatTheMapLacks) {
  const std::string labels = " }\nlabels: { 1: { name: x, object: SmallObject } }\n";
  auto doubts = doubtsAbout("counts_as: { Persn: SmallObject" + labels);
  ASSERT_EQ(doubts.size(), 1U) << "a slip, or a class of another map";
  EXPECT_EQ(doubts.front(),
            "my.yaml: counts_as: the ontology of the map has no class 'Persn', so no answer is of it; did you mean "
            "'Person'?");
  doubts = doubtsAbout("counts_as: { Escalator: SmallObject" + labels);
  ASSERT_EQ(doubts.size(), 1U) << "a class of another ontology";
  EXPECT_NE(doubts.front().find("no class 'Escalator'"), std::string::npos);
}

TEST(LabelMapCheck, FindsNothingInTheShippedLabelMaps) {
  const DataHome home(test::sourceFolder());
  const ClassCatalogue catalogue = classCatalogueOf(readMapInputs({}, home).ontology);
  std::size_t maps = 0;
  for (const auto& entry : std::filesystem::directory_iterator(test::sourceFolder() / "labels")) {
    if (entry.path().extension() != ".yaml") continue;
    const LabelMap labels = LabelMap::load(entry.path());
    const auto doubts = LabelMapCheck(labels, catalogue, entry.path().string()).run();
    EXPECT_TRUE(doubts.empty()) << doubts.front();
    ++maps;
  }
  EXPECT_GE(maps, 5U);
}

}  // namespace
}  // namespace cluxel::tasks
