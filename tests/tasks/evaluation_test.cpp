// SPDX-License-Identifier: Apache-2.0
// Scores compared with values counted by hand.
#include "tasks/evaluation/evaluation.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>

#include "rdf/vocabulary.hpp"
#include "tasks/evaluation/evaluation_shares.hpp"
#include "tasks/evaluation/object_matching.hpp"
#include "tasks/evaluation/truth_class.hpp"

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
  EXPECT_EQ(truthClassesOf(objects, {{"Plant", "Small"}}, catalogue), (Numbers{1, 1, 0, 0, 2, 2, 2}));
  EXPECT_EQ(truthClassesOf(objects, {{"Small", "Barrier"}}, catalogue), (Numbers{0, 1, 1, 2, 2, 2, 2}));
  EXPECT_EQ(truthClassesOf(objects, {{"Barrier", "Plant", "Thing"}}, catalogue), (Numbers{2, 0, 0, 1, 2, 3, 3}));
  EXPECT_EQ(truthClassesOf(objects, {{}}, catalogue), Numbers(objects.size(), 0));
}

TEST(TruthClasses, AreNotThoseOfANamesakeInAnotherNamespace) {
  using vocabulary::clx;
  const ClassCatalogue catalogue{{{clx("Tree"), {clx("Plant")}, {}},
                                  {clx("Plant"), {}, {}},
                                  {"http://town/Tree", {clx("Plant")}, {}},
                                  {"http://town/Kiosk", {}, {}},
                                  {"http://town/Car", {clx("Plant")}, {}},
                                  {"http://store/Car", {clx("Plant")}, {}}}};
  std::vector<SemanticObject> objects;
  for (const std::string& iri : {clx("Tree"), std::string("http://town/Tree"), std::string("http://town/Kiosk"),
                                 std::string("http://town/Car"), std::string("http://store/Car")})
    objects.emplace_back().class_iri = iri;
  EXPECT_EQ(truthClassesOf(objects, {{"Tree", "Kiosk", "Car", "Plant"}}, catalogue),
            (std::vector<std::size_t>{0, 3, 1, 3, 3}));
}

TEST(TruthClasses, CountAsTheTruthSaysBeforeTheirOwnName) {
  using vocabulary::clx;
  const ClassCatalogue catalogue{{{clx("Structure"), {}, {}},
                                  {clx("House"), {clx("Structure")}, {}},
                                  {clx("Pole"), {}, {}},
                                  {clx("Lamp"), {clx("Pole")}, {}}}};
  std::vector<SemanticObject> objects;
  for (const char* name : {"Structure", "House", "Pole", "Lamp"}) objects.emplace_back().class_iri = clx(name);
  using Numbers = std::vector<std::size_t>;
  const std::vector<std::string> names{"Lamp", "Fixed"};
  EXPECT_EQ(truthClassesOf(objects, {names, {{"Structure", "Fixed"}}}, catalogue), (Numbers{1, 1, 2, 0}));
  EXPECT_EQ(truthClassesOf(objects, {names, {{"Lamp", "Fixed"}}}, catalogue), (Numbers{2, 2, 2, 1}));
  EXPECT_EQ(truthClassesOf(objects, {names, {{"Pole", "Fixed"}}}, catalogue), (Numbers{2, 2, 1, 0}));
}

TEST(WilsonInterval, IsThatOfTheFormulaAndStaysBetweenZeroAndOne) {
  // Newcombe, Statistics in Medicine 17 (1998), table I, method 3.
  for (const auto& [hits, total, low, high] : {std::array{81.0, 263.0, 0.2553, 0.3662},
                                               {15.0, 148.0, 0.0624, 0.1605},
                                               {0.0, 20.0, 0.0, 0.1611},
                                               {1.0, 29.0, 0.0061, 0.1718}}) {
    const ShareInterval interval = wilsonInterval(hits, total);
    EXPECT_NEAR(interval.low, low, 5e-5) << hits << " of " << total;
    EXPECT_NEAR(interval.high, high, 5e-5) << hits << " of " << total;
    const ShareInterval other = wilsonInterval(total - hits, total);
    EXPECT_NEAR(other.low, 1 - interval.high, 1e-12);
  }
  EXPECT_EQ(wilsonInterval(0, 0).low, 0);
  EXPECT_EQ(wilsonInterval(0, 0).high, 1);
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

TEST_F(ObjectMatchingByHand, GroundIsNoAnswerAndHasNoTrueObjects) {
  const std::vector<std::string> with_ground{"Tree", "Ground"};
  ObjectMatching matching(with_ground, {0, 1, 1}, {});
  add(matching, 0, 5, 0, 7, 0);
  add(matching, 10, 50, 1, 3, 1);
  add(matching, 70, 50, 0, 8, 2);  // ground that is a tree
  for (const auto& scores : {matching.scoreByBox(params), matching.scoreByPoints(params)}) {
    EXPECT_EQ(scores[0].truth, 2U);
    EXPECT_EQ(scores[1].truth, 0U);
    EXPECT_EQ(scores[1].answers, 0U);
  }
}

TEST_F(ObjectMatchingByHand, PointsOfUnknownTruthCountNeitherWayUnlessAskedFor) {
  ObjectMatching matching(names, two_trees_and_a_bush, {});
  add(matching, 0, 6, kTree, 7, 0);
  add(matching, 10, 4, kTree, 8, 1);
  for (int i = 0; i < 5; ++i) matching.addWithoutTruth(0), matching.addWithoutTruth(1);
  EXPECT_EQ(matching.scoreByPoints(params)[kTree].matched_truth, 2U);
  EXPECT_EQ(matching.matchedWhole(params), 1U) << "IoU 6/11 and 4/9";
}

TEST_F(ObjectMatchingByHand, TrueObjectsAreCalledWhatTheirPartnerIsAndWhatHasMostOfThem) {
  ObjectMatching matching(names, {kTree, kBush, names.size()}, {5});
  add(matching, 0, 6, kTree, 1, 1);  // a trunk that is a bush
  add(matching, 6, 4, kTree, 1, kNoObjectOfPoint);
  add(matching, 10, 4, kTree, 2, 0);  // a trunk in pieces, most of them a tree
  add(matching, 14, 3, kTree, 2, 2);
  add(matching, 17, 2, kTree, 2, kNoObjectOfPoint);
  add(matching, 20, 5, kBush, 3, 2);  // another class
  add(matching, 30, 3, kBush, 4, kNoObjectOfPoint);
  add(matching, 40, 9, kBush, 5, 0);  // ambiguous
  const auto kinds = matching.answersByKind({{1, "trunk"}, {2, "trunk"}, {3, "shrub"}, {5, "shrub"}}, params);
  using Counts = std::vector<std::uint64_t>;  // Tree, Bush, another class, none
  ASSERT_EQ(kinds.size(), 3U);
  EXPECT_EQ(kinds[0].name, "Bush") << "a kind without a name is its class";
  EXPECT_EQ(kinds[0].found, (Counts{0, 0, 0, 1}));
  EXPECT_EQ(kinds[0].called, (Counts{0, 0, 0, 1}));
  EXPECT_EQ(kinds[1].name, "shrub");
  EXPECT_EQ(kinds[1].truth, 1U);
  EXPECT_EQ(kinds[1].found, (Counts{0, 0, 1, 0})) << "5 of 8 points";
  EXPECT_EQ(kinds[2].name, "trunk");
  EXPECT_EQ(kinds[2].found, (Counts{0, 1, 0, 1}));
  EXPECT_EQ(kinds[2].called, (Counts{1, 1, 0, 0}));
}

TEST(Calibration, ErrorIsTheGapBetweenConfidenceAndWhatIsRight) {
  Calibration calibration;
  EXPECT_EQ(calibration.expectedError(), 0);
  for (int i = 0; i < 10; ++i) calibration.add(0.85, i < 8);  // 0.05 too sure
  EXPECT_NEAR(calibration.expectedError(), 0.05, 1e-12);
  for (int i = 0; i < 10; ++i) calibration.add(0.35, i < 5);  // 0.15 too unsure
  EXPECT_NEAR(calibration.expectedError(), 0.10, 1e-12);
  Calibration sum = calibration;
  sum.add(calibration);
  EXPECT_EQ(sum.objects(), 40U);
  EXPECT_NEAR(sum.expectedError(), 0.10, 1e-12);
  Calibration ends;
  ends.add(1.0, true);
  ends.add(0.0, false);
  EXPECT_EQ(ends.expectedError(), 0);
}

TEST(Calibration, ErrorByChanceIsWhatExactConfidencesMeasure) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> share(0, 1);
  for (const int objects : {60, 200, 1000}) {
    double measured = 0, foretold = 0;
    constexpr int kRounds = 400;
    for (int round = 0; round < kRounds; ++round) {
      Calibration calibration;
      for (int i = 0; i < objects; ++i) {
        const double confidence = share(random);
        calibration.add(confidence, share(random) < confidence);
      }
      measured += calibration.expectedError() / kRounds;
      foretold += calibration.errorByChance() / kRounds;
    }
    EXPECT_NEAR(foretold, measured, 0.05 * measured) << objects << " objects";
  }
}

TEST(ClassVotes, CallAClassRightThatMostPointsHave) {
  std::vector<SemanticObject> objects(4);
  for (SemanticObject& object : objects) object.confidence = 0.95;
  ClassVotes votes(objects.size());
  for (int i = 0; i < 5; ++i) votes.add(0, i < 3 ? 1 : 0);
  for (int i = 0; i < 5; ++i) votes.add(1, i < 2 ? 1 : 0);
  votes.add(2, 0);  // of a class that is left out; object 3 has no point with truth
  const CalibrationBin bin = votes.calibrationOf(objects, {1, 1, 0, 1}, 2, 0).bins[9];
  EXPECT_EQ(bin.objects, 2U);
  EXPECT_EQ(bin.right, 1U);
}

TEST(ClassVotes, LeaveOutObjectsThatTheTruthHardlyCovers) {
  std::vector<SemanticObject> objects(2);
  for (SemanticObject& object : objects) object.confidence = 0.95;
  ClassVotes votes(objects.size());
  for (std::uint32_t object : {0U, 1U})
    for (int i = 0; i < 3; ++i) votes.add(object, 0);
  for (int i = 0; i < 3; ++i) votes.addWithoutTruth(0);
  for (int i = 0; i < 4; ++i) votes.addWithoutTruth(1);
  EXPECT_EQ(votes.calibrationOf(objects, {0, 0}, 1, 1).objects(), 1U);
}

TEST(CrownPairs, ArePartedWhenTwoObjectsHaveMostOfThem) {
  // Trees in a row, 3 m apart, with crowns of 3 m: each touches the next. The last stands 1 m from its neighbour.
  const auto rowOfTrees = [](const std::vector<std::uint32_t>& object_of_tree) {
    CrownPairs crowns;
    const std::array trunks{0.0, 3.0, 6.0, 7.0};
    for (std::size_t tree = 0; tree < trunks.size(); ++tree) {
      const auto instance = static_cast<std::int32_t>(tree) + 10;
      crowns.add({trunks[tree], 0, 1}, instance, true, object_of_tree[tree]);
      for (double x = -1.5; x <= 1.5; x += 0.1)
        crowns.add({trunks[tree] + x, 0, 4}, instance, false, object_of_tree[tree]);
    }
    return crowns;
  };
  const CrownPairScore apart = rowOfTrees({0, 1, 2, 3}).score({});
  EXPECT_EQ(apart.pairs, 2U) << "the last two trunks stand too near";
  EXPECT_EQ(apart.parted, 2U);
  EXPECT_EQ(rowOfTrees({0, 0, 2, 3}).score({}).parted, 1U);
  EXPECT_EQ(rowOfTrees({0, kNoObjectOfPoint, 2, 3}).score({}).parted, 0U);
  EXPECT_EQ(rowOfTrees({0, 1, 2, 3}).score({11}).pairs, 0U) << "the second tree is ambiguous";
}

}  // namespace
}  // namespace cluxel::tasks
