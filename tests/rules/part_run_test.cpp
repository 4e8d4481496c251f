// SPDX-License-Identifier: Apache-2.0
// What a run over a part of the scene tells is what the whole run tells, or it is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "perception/segments/scene_part.hpp"
#include "rules/box_world.hpp"
#include "rules/explain/part_run.hpp"
#include "rules/objects/known_splits.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
using namespace rules;
namespace {

/// Four streets one behind the other.
BoxScene longStreet() {
  BoxScene all;
  for (int i = 0; i < 4; ++i)
    for (BoxPrimitive made : streetOfBoxes().boxes) {
      made.name += std::to_string(i);
      made.center.x() += 80 * i;
      all.boxes.push_back(made);
    }
  return all;
}

struct StreetRun {
  Scene scene = sceneOfBoxes(longStreet()).scene;
  RuleSet rules = outdoorRules();
  ReasoningResult result = reason(scene, rules);
  std::vector<std::uint64_t> traces = result.traces;
  WholeRun whole() const { return {traces, result.objects}; }
};

TEST(PartRun, ExplainsObjectsAndPrimitivesAsTheWholeRunDoes) {
  const StreetRun street;
  std::size_t in_part = 0, asked = 0;
  for (const SemanticObject& object : street.result.objects) {
    ++asked;
    const auto run = runInPart(street.scene, street.rules, street.whole(), primitivesOf(object));
    if (!run) continue;
    ++in_part;
    EXPECT_LT(run->part->cluxels.size(), street.scene.cluxels.size());
    const auto near = explanationIn(run->result, street.rules, object.id);
    const auto whole = explain(street.scene, street.rules, {}, object);
    ASSERT_TRUE(near && whole);
    EXPECT_EQ(textOf(*near, street.rules, *run->part), textOf(*whole, street.rules, street.scene));
    EXPECT_EQ(jsonOf(*near, street.rules, *run->part), jsonOf(*whole, street.rules, street.scene));
  }
  for (PrimitiveIndex i = 0; i < street.scene.primitives.size(); i += 3) {
    ++asked;
    const auto run = runInPart(street.scene, street.rules, street.whole(), {i});
    if (!run) continue;
    ++in_part;
    const auto near = explanationIn(run->result, street.rules, run->primitives.front());
    EXPECT_EQ(textOf(near, street.rules, *run->part),
              textOf(explain(street.scene, street.rules, {}, i), street.rules, street.scene));
  }
  EXPECT_GE(4 * in_part, 3 * asked) << "most things are explained from a part";
}

TEST(PartRun, TakesKnownSplitsOfCrownsAndTellsTheSame) {
  const StreetRun street;
  KnownSplits made;
  reason(street.scene, street.rules, {.splits = &made});
  ASSERT_GT(made.count(), 0U) << "a street of trees whose crowns touch";
  std::size_t reused = 0;
  for (const SemanticObject& object : street.result.objects) {
    KnownSplits known(made.stored());
    const auto with =
        runInPart(street.scene, street.rules, {street.traces, street.result.objects, &known}, primitivesOf(object));
    const auto without = runInPart(street.scene, street.rules, street.whole(), primitivesOf(object));
    ASSERT_EQ(with.has_value(), without.has_value());
    reused += known.reused();
    if (!with) continue;
    EXPECT_EQ(with->result.traces, without->result.traces);
    EXPECT_EQ(textOf(*explanationIn(with->result, street.rules, object.id), street.rules, *with->part),
              textOf(*explanationIn(without->result, street.rules, object.id), street.rules, *without->part));
  }
  EXPECT_GT(reused, 0U);
}

/// A tree rule that looks far from its trunk, and a crown that it finds.
RuleSet farLookingRules() {
  return rulesOf("[clx:Building, clx:Tree]", R"(
  - id: building/wall
    class: clx:Building
    seed: { label: vertical_plane }
    tree:
      test: height >= 3 m
      yes: { accept: { confidence: 0.9 } }
      no: { reject: low }
  - id: tree/found-crown
    class: clx:Tree
    seed: { label: column, as: trunk }
    tree:
      find: { as: crown, label: scatter, where: [ gap to trunk <= 2 m ] }
      missing: { reject: no crown }
      found:
        test: gap of trunk to clx:Building <= 45 m
        yes: { accept: { parts: { trunk: clx:TreeTrunk, crown: clx:TreeTop }, confidence: 0.8 } }
        no: { accept: { parts: { trunk: clx:TreeTrunk, crown: clx:TreeTop }, confidence: 0.8 } }
)");
}

TEST(PartRun, TellsOfAFoundCrownWhatTheWholeRunMeasuredAtItsTrunk) {
  BoxScene boxes;
  for (int i = 0; i < 6; ++i) {
    boxes.boxes.push_back(box("trunk" + std::to_string(i), kColumn, {60.0 * i, 0, 1.2}, {0.3, 0.3, 2.4}));
    boxes.boxes.push_back(box("crown" + std::to_string(i), kScatter, {60.0 * i, 0, 4}, {4, 4, 3}));
    boxes.boxes.push_back(box("wall" + std::to_string(i), kWall, {60.0 * i, 20, 3}, {8, 0.3, 6}));
  }
  const BuiltBoxScene built = sceneOfBoxes(boxes);
  const RuleSet rules = farLookingRules();
  const ReasoningResult result = reason(built.scene, rules);
  ASSERT_EQ(result.objects.size(), 12U);
  const std::vector<std::uint64_t> traces = result.traces;
  std::size_t in_part = 0;
  for (PrimitiveIndex i = 0; i < built.scene.primitives.size(); ++i) {
    const auto run = runInPart(built.scene, rules, {traces, result.objects}, {i});
    if (!run) continue;
    ++in_part;
    EXPECT_EQ(textOf(explanationIn(run->result, rules, run->primitives.front()), rules, *run->part),
              textOf(explain(built.scene, rules, {}, i), rules, built.scene))
        << built.names[i];
  }
  EXPECT_GE(in_part, 12U) << "the parts of 30 m hold the wall";
}

TEST(PartRun, SeesALongNeighbourChangeItsOwner) {
  StreetRun street;
  const auto tree = std::find_if(street.result.objects.begin(), street.result.objects.end(),
                                 [](const SemanticObject& object) { return object.class_iri == clx("Tree"); });
  ASSERT_NE(tree, street.result.objects.end());
  const std::vector<PrimitiveIndex> primitives = primitivesOf(*tree);
  ASSERT_TRUE(runInPart(street.scene, street.rules, street.whole(), primitives));
  // The ground sticks out of every box; the whole run is said to have given it to another rule.
  for (SemanticObject& object : street.result.objects)
    if (object.class_iri == clx("Ground")) object.rule_id = tree->rule_id;
  EXPECT_FALSE(runInPart(street.scene, street.rules, street.whole(), primitives));
}

TEST(PartRun, IsRefusedWhereTheWholeRunDecidedOtherwise) {
  StreetRun street;
  const std::vector<PrimitiveIndex> primitives = primitivesOf(street.result.objects.front());
  ASSERT_TRUE(runInPart(street.scene, street.rules, street.whole(), primitives));
  street.traces[primitives.front()] ^= 1U;
  EXPECT_FALSE(runInPart(street.scene, street.rules, street.whole(), primitives));
  street.traces.pop_back();
  EXPECT_FALSE(runInPart(street.scene, street.rules, street.whole(), primitives)) << "of another scene";
}

TEST(DecisionTraces, TellWhatWasMeasuredAndNotHowThingsAreNumbered) {
  const StreetRun street;
  const auto measured =
      std::find_if(street.result.decisions.begin(), street.result.decisions.end(), [](const Decision& decision) {
        return !decision.path.empty() && decision.path.front().measured.value_or(0) != 0;
      });
  ASSERT_NE(measured, street.result.decisions.end());
  Scene other = street.scene;
  for (double& value : other.primitives[measured->seed].attributes) value *= 1 + 1e-9;
  EXPECT_NE(reason(other, street.rules).traces[measured->seed], street.traces[measured->seed]);
  // All primitives but the first: the others get new numbers.
  std::vector<PrimitiveIndex> kept(street.scene.primitives.size() - 1);
  std::iota(kept.begin(), kept.end(), 1U);
  const Scene part = partOf(street.scene, kept);
  const std::vector<std::uint64_t> traces = reason(part, street.rules).traces;
  std::size_t same = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) same += traces[i] == street.traces[kept[i]] ? 1 : 0;
  EXPECT_GE(4 * same, 3 * kept.size());
}

TEST(ScenePart, HoldsTheKeptPrimitivesAsTheyAre) {
  const Scene scene = sceneOfBoxes(streetOfBoxes()).scene;
  std::vector<PrimitiveIndex> kept;
  for (PrimitiveIndex i = 1; i < scene.primitives.size(); i += 2) kept.push_back(i);
  const Scene part = partOf(scene, kept);
  ASSERT_EQ(part.primitives.size(), kept.size());
  std::size_t cluxels = 0, edges = 0, relations = 0;
  std::vector<std::uint32_t> old_number;
  for (std::uint32_t i = 0; i < scene.cluxels.size(); ++i)
    if (std::binary_search(kept.begin(), kept.end(), scene.cluxels.primitive[i])) old_number.push_back(i);
  ASSERT_EQ(part.cluxels.size(), old_number.size());
  for (std::size_t i = 0; i < kept.size(); ++i) {
    EXPECT_EQ(part.primitives[i].id, scene.primitives[kept[i]].id);
    EXPECT_EQ(part.primitives[i].attributes, scene.primitives[kept[i]].attributes);
    for (const std::uint32_t cluxel : part.primitives[i].cluxels) {
      EXPECT_EQ(part.cluxels.primitive[cluxel], i);
      EXPECT_EQ(part.cluxels.name[cluxel], scene.cluxels.name[old_number[cluxel]]);
      EXPECT_EQ(part.cluxels.center[cluxel], scene.cluxels.center[old_number[cluxel]]);
    }
    cluxels += part.primitives[i].cluxels.size();
    for (const Relation& relation : scene.relationsOf(kept[i]))
      relations += std::binary_search(kept.begin(), kept.end(), relation.to) ? 1 : 0;
    for (const Relation& relation : part.relationsOf(static_cast<PrimitiveIndex>(i))) {
      Relation old = relation;
      old.from = kept[relation.from], old.to = kept[relation.to];
      const auto all = scene.relationsOf(old.from);
      EXPECT_NE(std::find(all.begin(), all.end(), old), all.end());
    }
  }
  EXPECT_EQ(cluxels, part.cluxels.size());
  EXPECT_EQ(relations, part.relations.size());
  for (std::uint32_t i = 0; i < part.cluxels.size(); ++i) {
    for (const std::uint32_t neighbour : scene.cluxels.neighbours(old_number[i]))
      edges += std::binary_search(old_number.begin(), old_number.end(), neighbour) ? 1 : 0;
    for (const std::uint32_t neighbour : part.cluxels.neighbours(i)) {
      const auto all = scene.cluxels.neighbours(old_number[i]);
      EXPECT_NE(std::find(all.begin(), all.end(), old_number[neighbour]), all.end());
    }
  }
  EXPECT_EQ(edges, part.cluxels.edge_target.size());
}

}  // namespace
}  // namespace cluxel::testing
