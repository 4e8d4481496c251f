// SPDX-License-Identifier: Apache-2.0
// Properties of reasoning for any rules: order independence, disjointness, partition, confidence, monotonicity.
#include <gmock/gmock.h>

#include <algorithm>
#include <random>
#include <set>

#include "rdf/map_iris.hpp"
#include "rules/box_world.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
using namespace rules;
namespace {

TEST(Reasoning, FindsOneOfEverythingInAStreet) {
  const BuiltBoxScene built = sceneOfBoxes(streetOfBoxes());
  const ReasoningResult result = reason(built.scene, outdoorRules());
  EXPECT_THAT(inWords(built, result),
              ::testing::UnorderedElementsAre(
                  "Ground{Ground: ground}", "Building{Facade: facade_left facade_right}",
                  "Tree{TreeTop: crowns misfit; TreeTrunk: trunk_a}", "Tree{TreeTop: crowns; TreeTrunk: trunk_b}",
                  "StreetLamp{LampHead: lamp_head; LampPole: lamp_pole}",
                  "StreetSign{SignPlate: sign_plate; SignPole: sign_pole}", "UtilityPole{PoleMast: mast}",
                  "Vehicle{Vehicle: car_back car_front}", "Bush{Bush: bush}", "SmallObject{SmallObject: bin}"));
}

TEST(Reasoning, DoesNotDependOnTheOrderOfBoxes) {
  const RuleSet rules = outdoorRules();
  BoxScene street = streetOfBoxes();
  const BuiltBoxScene first = sceneOfBoxes(street);
  const ReasoningResult expected = reason(first.scene, rules);
  std::mt19937 random(7);
  for (int round = 0; round < 5; ++round) {
    std::shuffle(street.boxes.begin(), street.boxes.end(), random);
    const BuiltBoxScene built = sceneOfBoxes(street);
    const ReasoningResult result = reason(built.scene, rules);
    ASSERT_EQ(result.objects.size(), expected.objects.size());
    for (std::size_t i = 0; i < result.objects.size(); ++i) {
      EXPECT_EQ(result.objects[i].id, expected.objects[i].id);
      EXPECT_EQ(result.objects[i].confidence, expected.objects[i].confidence);
    }
  }
}

/// Renumbers the primitives of a scene; ids and cluxels are unchanged.
Scene renumbered(const Scene& scene, const std::vector<PrimitiveIndex>& old_of_new) {
  Scene other = scene;
  std::vector<PrimitiveIndex> new_of_old(old_of_new.size());
  for (PrimitiveIndex i = 0; i < old_of_new.size(); ++i) {
    new_of_old[old_of_new[i]] = i;
    other.primitives[i] = scene.primitives[old_of_new[i]];
  }
  for (PrimitiveIndex& primitive : other.cluxels.primitive) primitive = new_of_old[primitive];
  for (Relation& relation : other.relations) {
    relation.from = new_of_old[relation.from];
    relation.to = new_of_old[relation.to];
  }
  indexRelations(other);
  return other;
}

TEST(Reasoning, DoesNotDependOnTheNumbersOfPrimitives) {
  const RuleSet rules = outdoorRules();
  const Scene scene = sceneOfBoxes(streetOfBoxes()).scene;
  const ReasoningResult expected = reason(scene, rules);
  std::vector<PrimitiveIndex> order(scene.primitives.size());
  for (PrimitiveIndex i = 0; i < order.size(); ++i) order[i] = i;
  std::mt19937 random(11);
  for (int round = 0; round < 5; ++round) {
    std::shuffle(order.begin(), order.end(), random);
    const ReasoningResult result = reason(renumbered(scene, order), rules);
    ASSERT_EQ(result.objects.size(), expected.objects.size());
    for (std::size_t i = 0; i < result.objects.size(); ++i) EXPECT_EQ(result.objects[i].id, expected.objects[i].id);
  }
}

TEST(Reasoning, DoesNotDependOnTheNumberOfThreads) {
  const Scene scene = sceneOfBoxes(streetOfBoxes()).scene;
  const ReasoningResult expected = reason(scene, outdoorRules()),
                        result = reason(scene, outdoorRules(), {.threads = 3});
  ASSERT_EQ(result.objects.size(), expected.objects.size());
  for (std::size_t i = 0; i < result.objects.size(); ++i) EXPECT_EQ(result.objects[i].id, expected.objects[i].id);
  ASSERT_EQ(result.decisions.size(), expected.decisions.size());
  for (std::size_t i = 0; i < result.decisions.size(); ++i)
    EXPECT_EQ(std::tie(result.decisions[i].rule_id, result.decisions[i].seeds),
              std::tie(expected.decisions[i].rule_id, expected.decisions[i].seeds));
}

TEST(Reasoning, GivesEachCluxelToAtMostOneObject) {
  const Scene scene = sceneOfBoxes(streetOfBoxes()).scene;
  const ReasoningResult result = reason(scene, outdoorRules());
  std::vector<int> owners(scene.cluxels.size(), 0);
  for (const SemanticObject& object : result.objects)
    for (const ObjectPart& part : object.parts)
      for (std::uint32_t cluxel : part.cluxels) ++owners[cluxel];
  EXPECT_LE(*std::max_element(owners.begin(), owners.end()), 1);
}

TEST(Reasoning, PartsASharedCrownWithoutRest) {
  const BuiltBoxScene built = sceneOfBoxes(streetOfBoxes());
  const ReasoningResult result = reason(built.scene, outdoorRules());
  const auto crown = std::find(built.names.begin(), built.names.end(), "crowns") - built.names.begin();
  const auto& members = built.scene.primitives[static_cast<std::size_t>(crown)].cluxels;
  std::vector<std::uint32_t> given;
  for (const SemanticObject& object : result.objects)
    for (const ObjectPart& part : object.parts)
      for (std::uint32_t cluxel : part.cluxels)
        if (built.scene.cluxels.primitive[cluxel] == static_cast<PrimitiveIndex>(crown)) given.push_back(cluxel);
  std::sort(given.begin(), given.end());
  EXPECT_EQ(given, members);
  // Each half lies around its own trunk.
  for (const SemanticObject& object : result.objects) {
    if (object.class_iri != clx("Tree")) continue;
    const auto middle = [&](const ObjectPart& part) {
      double sum = 0;
      for (std::uint32_t cluxel : part.cluxels) sum += built.scene.cluxels.center[cluxel].x();
      return sum / static_cast<double>(part.cluxels.size());
    };
    EXPECT_NEAR(middle(object.parts[0]), middle(object.parts[1]), 1.0);
  }
}

TEST(Reasoning, KeepsConfidenceBetweenZeroAndOne) {
  const ReasoningResult result = reason(sceneOfBoxes(streetOfBoxes()).scene, outdoorRules());
  for (const SemanticObject& object : result.objects) {
    EXPECT_GT(object.confidence, 0.0);
    EXPECT_LE(object.confidence, 1.0);
  }
}

TEST(Reasoning, RecordsWhyItAcceptedAndRejected) {
  const BuiltBoxScene built = sceneOfBoxes(streetOfBoxes());
  const ReasoningResult result = reason(built.scene, outdoorRules());
  for (const SemanticObject& object : result.objects) {
    const Decision& decision = result.decisions.at(object.decision);
    EXPECT_TRUE(decision.accepted);
    EXPECT_EQ(decision.rule_id, object.rule_id);
    EXPECT_FALSE(decision.path.empty());
  }
  const auto rejected = std::count_if(result.decisions.begin(), result.decisions.end(), [&](const Decision& decision) {
    return !decision.accepted && built.names[decision.seed] == "sign_pole" && decision.rule_id == "tree/trunk-and-top";
  });
  EXPECT_EQ(rejected, 1);
}

/// Points of the tree when a misfit with `share` of its edges to the crown is beside it.
std::vector<std::string> withMisfit(double share) {
  BoxScene scene;
  scene.boxes = {box("ground", kGroundLabel, {0, 0, 0}, {20, 20, 0.1}),
                 box("trunk", kColumn, {0, 0, 1.2}, {0.4, 0.4, 2.4}), box("crown", kScatter, {0, 0, 4}, {4, 4, 3.2}),
                 box("misfit", kWall, {2.1, 0, 4}, {0.2, 1, 1})};
  scene.boxes.back().adjacency = {{"crown", share}};
  const BuiltBoxScene built = sceneOfBoxes(scene);
  return inWords(built, reason(built.scene, outdoorRules()));
}

TEST(Absorbing, GrowsWithTheEvidence) {
  bool absorbed = false;
  for (double share : {0.1, 0.3, 0.49, 0.5, 0.7, 0.9}) {
    const auto words = withMisfit(share);
    const bool now =
        std::find(words.begin(), words.end(), "Tree{TreeTop: crown misfit; TreeTrunk: trunk}") != words.end();
    EXPECT_TRUE(now || !absorbed) << "more evidence took the misfit away at " << share;
    EXPECT_EQ(now, share >= 0.5) << share;
    absorbed = now;
  }
}

TEST(Absorbing, DoesNotSwallowALampThatTheCrownsBoxEncloses) {
  BoxScene scene;
  scene.boxes = {
      box("ground", kGroundLabel, {0, 0, 0}, {20, 20, 0.1}), box("trunk", kColumn, {0, 0, 1.2}, {0.4, 0.4, 2.4}),
      box("crown", kScatter, {0, 0, 4}, {4, 4, 3.2}), box("bough", kScatter, {3.4, 0, 5.2}, {2.9, 0.6, 0.5}),
      // Inside the box around crown and bough, but touching neither.
      box("pole", kColumn, {4.2, 0, 1.9}, {0.14, 0.14, 3.8}), box("head", kSmall, {4.2, 0, 4.0}, {0.5, 0.5, 0.3})};
  const BuiltBoxScene built = sceneOfBoxes(scene);
  const auto words = inWords(built, reason(built.scene, outdoorRules()));
  EXPECT_THAT(words, ::testing::Contains("StreetLamp{LampHead: head; LampPole: pole}"));
  EXPECT_THAT(words, ::testing::Contains("Tree{TreeTop: bough crown; TreeTrunk: trunk}"));
}

TEST(Grouping, JoinsATrunkThatLeavesCutInTwo) {
  BoxScene scene;
  scene.boxes = {box("ground", kGroundLabel, {0, 0, 0}, {20, 20, 0.1}),
                 box("foot", kColumn, {0, 0, 0.5}, {0.4, 0.4, 1.0}),
                 box("upper", kColumn, {0, 0, 2.2}, {0.35, 0.35, 1.0}), box("crown", kScatter, {0, 0, 4.2}, {4, 4, 3})};
  const BuiltBoxScene built = sceneOfBoxes(scene);
  EXPECT_THAT(inWords(built, reason(built.scene, outdoorRules())),
              ::testing::Contains("Tree{TreeTop: crown; TreeTrunk: foot upper}"));
}

TEST(Grouping, DoesNotJoinTwoParkedCars) {
  BoxScene scene;
  scene.boxes = {box("ground", kGroundLabel, {0, 0, 0}, {20, 20, 0.1}),
                 box("first", kSmall, {0, 0, 0.7}, {4.2, 1.7, 1.3}),
                 box("second", kSmall, {4.6, 0, 0.7}, {4.2, 1.7, 1.3})};
  const BuiltBoxScene built = sceneOfBoxes(scene);
  EXPECT_THAT(inWords(built, reason(built.scene, outdoorRules())),
              ::testing::IsSupersetOf({"Vehicle{Vehicle: first}", "Vehicle{Vehicle: second}"}));
}

TEST(Slices, FindTheStemOfATreeThatIsAllScatter) {
  BoxScene scene;
  scene.boxes = {box("ground", kGroundLabel, {0, 0, 0}, {20, 20, 0.1}),
                 box("stem", kScatter, {0, 0, 1.0}, {0.4, 0.4, 2.0}), box("crown", kScatter, {0, 0, 3.8}, {4, 4, 3.6})};
  // One primitive: the stem's cluxels become the crown's, but for one, because no primitive is empty.
  BuiltBoxScene built = sceneOfBoxes(scene);
  const auto number = [&](const std::string& name) {
    return static_cast<PrimitiveIndex>(std::find(built.names.begin(), built.names.end(), name) - built.names.begin());
  };
  Scene& all = built.scene;
  auto& crown = all.primitives[number("crown")];
  auto& stem = all.primitives[number("stem")];
  for (std::size_t i = 1; i < stem.cluxels.size(); ++i) all.cluxels.primitive[stem.cluxels[i]] = number("crown");
  crown.cluxels.insert(crown.cluxels.end(), stem.cluxels.begin() + 1, stem.cluxels.end());
  std::sort(crown.cluxels.begin(), crown.cluxels.end());
  stem.cluxels.resize(1);
  stem.attributes = {};
  stem.label = PrimitiveLabel::HorizontalPlane;
  crown.min.z() = 0;
  const ReasoningResult result = reason(all, outdoorRules());
  const auto tree = std::find_if(result.objects.begin(), result.objects.end(),
                                 [](const SemanticObject& object) { return object.rule_id == "tree/stem-in-scatter"; });
  ASSERT_NE(tree, result.objects.end());
  ASSERT_EQ(tree->parts.size(), 2U);
  EXPECT_EQ(tree->parts[0].part_class, clx("TreeTop"));
  EXPECT_GT(tree->parts[0].cluxels.size(), tree->parts[1].cluxels.size());
}

class CountingOracle : public AskOracle {
 public:
  explicit CountingOracle(std::string yes_for) : yes_for_(std::move(yes_for)) {}
  bool ask(const std::string& query, const std::map<std::string, std::string>& bindings) override {
    last_query = query;
    return bindings.at("thing") == yes_for_;
  }
  std::string last_query;

 private:
  std::string yes_for_;
};

TEST(Reasoning, PartsNothingFromWhatIsBoundForReferenceOnly) {
  const RuleSet rules = rulesOf("[clx:Building, clx:Tree]", R"(
  - id: building/wall
    class: clx:Building
    seed: { label: vertical_plane }
    tree:
      test: { attribute: height, op: ">=", value: 1 m }
      yes: { accept: { confidence: 0.9 } }
      no: { reject: low }
  - id: tree/ivy
    class: clx:Tree
    seed: { label: scatter, as: top }
    tree:
      find: { as: trunk, object: clx:Building, where: [ { gap_to: top, op: "<=", value: 20 m } ] }
      found: { accept: { parts: { trunk: clx:TreeTrunk, top: clx:TreeTop }, confidence: 0.5, split: { shared: top, from: trunk, reach: 8 m } } }
      missing: { reject: no wall }
)");
  BoxScene scene;
  scene.boxes = {box("wall", kWall, {0, 0, 2}, {6, 0.2, 4}), box("a", kScatter, {0, 1, 1}, {1, 1, 1}),
                 box("b", kScatter, {4, 1, 1}, {1, 1, 1})};
  const ReasoningResult result = reason(sceneOfBoxes(scene).scene, rules);
  ASSERT_EQ(result.objects.size(), 1U);
  EXPECT_EQ(result.objects[0].class_iri, clx("Building"));
}

TEST(Reasoning, MeasuresToAnyObjectAsFarAsTheTestSays) {
  const auto rulesWith = [](const std::string& test) {
    return rulesOf("[clx:Building, clx:SmallObject]", R"(
  - id: building/wall
    class: clx:Building
    seed: { label: vertical_plane }
    tree:
      test: { attribute: height, op: ">=", value: 1 m }
      yes: { accept: { confidence: 0.9 } }
      no: { reject: low }
  - id: small_object/beside
    class: clx:SmallObject
    seed: { label: small_structure }
    tree:
      test: { gap_to: { object: clx:Building }, )" + test +
                                                          R"( }
      yes: { accept: { confidence: 0.5 } }
      no: { reject: not there }
)");
  };
  BoxScene scene;
  scene.boxes = {box("wall", kWall, {0, 0, 2}, {6, 0.2, 4}), box("bin", kSmall, {0, 14, 0.5}, {1, 1, 1})};
  const BuiltBoxScene built = sceneOfBoxes(scene);
  EXPECT_EQ(reason(built.scene, rulesWith("op: \"<=\", value: 15 m")).objects.size(), 2U);
  EXPECT_EQ(reason(built.scene, rulesWith("op: \"<=\", value: 12 m")).objects.size(), 1U);
  EXPECT_EQ(reason(built.scene, rulesWith("op: \">\", value: 12 m")).objects.size(), 2U);
  EXPECT_EQ(reason(built.scene, rulesWith("op: \">\", value: 15 m")).objects.size(), 1U);
}

TEST(Asking, DecidesByTheOracleAndBindsThePrimitivesIri) {
  const RuleSet rules = rulesOf("[clx:SmallObject]", R"(
  - id: small_object/asked
    class: clx:SmallObject
    seed: { label: small_structure, as: thing }
    tree:
      ask: "ASK { ?thing clx:near ?other }"
      yes: { accept: { confidence: 0.5 } }
      no: { reject: the map says no }
)");
  BoxScene scene;
  scene.boxes = {box("a", kSmall, {0, 0, 0.5}, {1, 1, 1}), box("b", kSmall, {5, 0, 0.5}, {1, 1, 1})};
  const BuiltBoxScene built = sceneOfBoxes(scene);
  CountingOracle oracle(rdf::iriOfPrimitive(built.scene.primitives[0].id));
  const ReasoningResult result = reason(built.scene, rules, {.oracle = &oracle});
  ASSERT_EQ(result.objects.size(), 1U);
  EXPECT_EQ(result.objects[0].parts[0].primitives, std::vector<PrimitiveIndex>{0});
  EXPECT_THAT(oracle.last_query, ::testing::StartsWith("PREFIX clx: <https://w3id.org/cluxel/ontology#>\nASK"));
  EXPECT_THROW(reason(built.scene, rules), Error);
}

TEST(Asking, IsKnownOfTheRulesWhereverItStands) {
  const std::string ask = R"({ ask: "ASK { ?thing clx:near ?other }" })",
                    gap = "{ gap_to: thing, op: \"<=\", value: 1 m }";
  const auto asksMap = [](const std::string& test, const std::string& find, const std::string& absorb) {
    return rulesOf("[clx:SmallObject]", R"(
  - id: small_object/asked
    class: clx:SmallObject
    seed: { label: small_structure, as: thing }
    tree:
      not: )" + test + R"(
      yes:
        find: { as: other, label: scatter, where: [ )" +
                                            find + R"( ] }
        found: { accept: { confidence: 0.5, absorb: { from: { label: scatter }, when: [ )" +
                                            absorb + R"( ], max_fraction_of_points: 0.5 } } }
        missing: { reject: nothing beside it }
      no: { reject: the map says so }
)")
        .asks_map;
  };
  const std::string tall = "{ attribute: height, op: \">=\", value: 1 m }";
  EXPECT_FALSE(asksMap(tall, gap, gap));
  EXPECT_TRUE(asksMap(ask, gap, gap));
  EXPECT_TRUE(asksMap(tall, gap + ", " + ask, gap));
  EXPECT_TRUE(asksMap(tall, gap, gap + ", " + ask));
}

}  // namespace
}  // namespace cluxel::testing
