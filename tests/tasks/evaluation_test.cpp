// SPDX-License-Identifier: Apache-2.0
// Scores compared with values counted by hand.
#include "tasks/evaluation.hpp"

#include <gtest/gtest.h>

#include "rdf/vocabulary.hpp"
#include "tasks/object_matching.hpp"
#include "tasks/truth_class.hpp"

namespace cluxel::tasks {

using namespace scan;
using namespace perception;
using namespace rdf;
using namespace rules;
using namespace mapping;
namespace {

TEST(ConfusionMatrix, GivesTheFiguresThatAHandCounts) {
  ConfusionMatrix matrix({"Tree", "Bush", "Ground"});
  for (int i = 0; i < 6; ++i) matrix.add(0, 0);
  for (int i = 0; i < 2; ++i) matrix.add(0, 1);
  matrix.add(0, 3);  // no answer
  for (int i = 0; i < 3; ++i) matrix.add(1, 1);
  matrix.add(1, 0);
  EXPECT_EQ(matrix.total(), 13U);
  EXPECT_EQ(matrix.truthCount(0), 9U);
  EXPECT_EQ(matrix.answerCount(0), 7U);
  EXPECT_DOUBLE_EQ(matrix.precision(0), 6.0 / 7);
  EXPECT_DOUBLE_EQ(matrix.recall(0), 6.0 / 9);
  EXPECT_DOUBLE_EQ(matrix.f1(0), 12.0 / 16);
  EXPECT_DOUBLE_EQ(matrix.iou(0), 6.0 / 10);
  EXPECT_DOUBLE_EQ(matrix.f1(1), 6.0 / 9);
  EXPECT_DOUBLE_EQ(matrix.overallAccuracy(), 9.0 / 13);
  EXPECT_DOUBLE_EQ(matrix.macroF1(), (12.0 / 16 + 6.0 / 9) / 2) << "a class without truth does not count";
  EXPECT_DOUBLE_EQ(matrix.macroIou(), (6.0 / 10 + 3.0 / 6) / 2);
}

TEST(ConfusionMatrix, WithoutTruthIsZeroAndNotANumber) {
  const ConfusionMatrix matrix({"Tree"});
  EXPECT_EQ(matrix.overallAccuracy(), 0);
  EXPECT_EQ(matrix.precision(0), 0);
  EXPECT_EQ(matrix.f1(0), 0);
  EXPECT_EQ(matrix.macroF1(), 0);
}

TEST(TruthClasses, AreTheOwnOnesOrTheNearestAbove) {
  using vocabulary::clx;
  const ClassCatalogue catalogue{{{clx("Thing"), {}, {}},
                                  {clx("Small"), {clx("Thing")}, {}},
                                  {clx("Barrier"), {clx("Small")}, {}},
                                  {clx("Fence"), {clx("Barrier"), clx("Plant")}, {}},
                                  {clx("Plant"), {clx("Thing")}, {}},
                                  {clx("Circle"), {clx("Round")}, {}},
                                  {clx("Round"), {clx("Circle")}, {}}}};
  std::vector<SemanticObject> objects;
  for (const char* name : {"Small", "Barrier", "Fence", "Plant", "Thing", "Circle", "Stranger"})
    objects.emplace_back().class_iri = clx(name);
  using Numbers = std::vector<std::size_t>;
  EXPECT_EQ(truthClassesOf(objects, {"Plant", "Small"}, catalogue), (Numbers{1, 1, 0, 0, 2, 2, 2}));
  EXPECT_EQ(truthClassesOf(objects, {"Small", "Barrier"}, catalogue), (Numbers{0, 1, 1, 2, 2, 2, 2}));
  EXPECT_EQ(truthClassesOf(objects, {"Barrier", "Plant", "Thing"}, catalogue), (Numbers{2, 0, 0, 1, 2, 3, 3}));
  EXPECT_EQ(truthClassesOf(objects, {}, catalogue), Numbers(objects.size(), 0));
}

constexpr std::size_t kTree = 0, kBush = 1;

/// Truth and answers as points on a line, one metre apart.
class ObjectMatchingByHand : public testing::Test {
 protected:
  /// `count` points from `first_m` on.
  static void add(ObjectMatching& matching, double first_m, int count, std::size_t truth_class, std::int32_t instance,
                  std::uint32_t object) {
    for (int i = 0; i < count; ++i) matching.add({first_m + i, 0, 0}, truth_class, instance, object);
  }
  const std::vector<std::string> names{"Tree", "Bush"};
  const std::vector<std::size_t> two_trees_and_a_bush{kTree, kTree, kBush};
  const EvaluationParams params{};
};

TEST_F(ObjectMatchingByHand, APerfectAnswerScoresOne) {
  ObjectMatching matching(names, two_trees_and_a_bush, {});
  add(matching, 0, 10, kTree, 7, 0);
  add(matching, 100, 4, kTree, 8, 1);
  add(matching, 200, 5, kBush, 9, 2);
  for (const auto& scores : {matching.scoreByBox(params), matching.scoreByPoints(params)})
    for (const ObjectScore& score : scores) {
      EXPECT_EQ(score.precision(), 1.0) << score.name;
      EXPECT_EQ(score.recall(), 1.0) << score.name;
      EXPECT_EQ(score.f1(), 1.0) << score.name;
    }
}

TEST_F(ObjectMatchingByHand, ATreeInTwoHalvesIsOneMatchAtMost) {
  ObjectMatching matching(names, two_trees_and_a_bush, {});
  add(matching, 0, 6, kTree, 7, 0);  // IoU 6/10
  add(matching, 6, 4, kTree, 7, 1);  // IoU 4/10
  const ObjectScore trees = matching.scoreByPoints(params)[kTree];
  EXPECT_EQ(trees.truth, 1U);
  EXPECT_EQ(trees.answers, 2U);
  EXPECT_EQ(trees.matched_truth, 1U);
  EXPECT_EQ(trees.matched_answers, 1U);
  EXPECT_DOUBLE_EQ(trees.precision(), 0.5);
  EXPECT_DOUBLE_EQ(trees.recall(), 1.0);
}

TEST_F(ObjectMatchingByHand, OtherClassesAreNoPartners) {
  ObjectMatching matching(names, two_trees_and_a_bush, {});
  add(matching, 0, 10, kTree, 7, 2);
  const auto scores = matching.scoreByPoints(params);
  EXPECT_EQ(scores[kTree].truth, 1U);
  EXPECT_EQ(scores[kTree].matched_truth, 0U);
  EXPECT_EQ(scores[kBush].answers, 1U);
  EXPECT_EQ(scores[kBush].matched_answers, 0U);
}

TEST_F(ObjectMatchingByHand, AmbiguousInstancesCountNeitherWay) {
  ObjectMatching matching(names, two_trees_and_a_bush, {7});
  add(matching, 0, 10, kTree, 7, 0);                   // found: its answer does not count either
  add(matching, 100, 10, kTree, 8, kNoObjectOfPoint);  // missed
  const ObjectScore trees = matching.scoreByPoints(params)[kTree];
  EXPECT_EQ(trees.truth, 1U);
  EXPECT_EQ(trees.answers, 0U);
  EXPECT_EQ(trees.matched_truth, 0U);
}

TEST_F(ObjectMatchingByHand, AnAnswerOnPointsOfItsClassWithoutInstanceCountsNeitherWay) {
  ObjectMatching matching(names, two_trees_and_a_bush, {});
  add(matching, 0, 6, kTree, -1, 0);
  add(matching, 10, 4, kTree, 3, 0);
  add(matching, 50, 6, kTree, -1, 2);  // a bush where truth says tree: it does count
  const auto scores = matching.scoreByPoints(params);
  EXPECT_EQ(scores[kTree].answers, 0U);
  EXPECT_EQ(scores[kBush].answers, 1U);
}

TEST_F(ObjectMatchingByHand, BoxesMatchFromEightTenthsOn) {
  // Boxes of 10 m and of 8 m (or 7 m) in one line, padded by 0.2 m: IoU 8.4/10.4 = 0.808 and 7.4/10.4 = 0.71.
  for (const auto& [found, matches] : {std::pair{9, 1U}, std::pair{8, 0U}}) {
    ObjectMatching matching(names, two_trees_and_a_bush, {});
    add(matching, 0, found, kTree, 7, 0);
    add(matching, found, 11 - found, kTree, 7, kNoObjectOfPoint);
    EXPECT_EQ(matching.scoreByBox(params)[kTree].matched_truth, matches) << found;
  }
}

}  // namespace
}  // namespace cluxel::tasks
