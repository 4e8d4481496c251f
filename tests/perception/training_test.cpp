// SPDX-License-Identifier: Apache-2.0
// Training as a whole, on made-up places: what it reaches, that it repeats, and that its figures are honest.
#include "cluxel/perception/training.hpp"

#include <gtest/gtest.h>

#include "cluxel/base/diagnostic.hpp"
#include "cluxel/perception/virtual_sensor.hpp"
#include "perception/labelling_fixture.hpp"

namespace cluxel {
namespace {

std::vector<TrainingPlace> threePlaces() { return {made_up::place(1, 0), made_up::place(2, 1), made_up::place(3, 2)}; }

TrainingReport trained(const std::vector<TrainingPlace>& places, const TrainParams& params, unsigned threads = 1) {
  ProgressSink sink;
  return train("made up", places, PerceptionParams{}, params, threads, sink);
}

TEST(Training, GainsByThePairwiseTermWhereNeighboursAreAlike) {
  const TrainingReport report = trained(threePlaces(), made_up::quickTraining());
  EXPECT_GT(report.left_out_unary.macroF1(), 0.6);
  EXPECT_GT(report.left_out.macroF1(), report.left_out_unary.macroF1() + 0.05);
  EXPECT_GT(report.model.pairs.pair_scale, 0.0F);
}

TEST(Training, StatesProbabilitiesThatHoldOnAPlaceItNeverSaw) {
  const TrainingReport report = trained(threePlaces(), made_up::quickTraining());
  const std::vector<TrainingPlace> unseen{made_up::place(77, 9)};
  const Evaluation evaluation = evaluate(report.model, unseen, LabellingParams{}, 1);
  EXPECT_GT(evaluation.scores.macroF1(), 0.7);
  EXPECT_LT(evaluation.calibration_error, 0.1);
}

TEST(Training, MakesTheSameModelWithOneAndTwoThreads) {
  const auto one = trained(threePlaces(), made_up::quickTraining(), 1), two = trained(threePlaces(), made_up::quickTraining(), 2);
  EXPECT_EQ(modelText(one.model), modelText(two.model));
}

TEST(Training, LeavesThePairwiseTermOutWhenToldTo) {
  TrainParams params = made_up::quickTraining();
  params.pairwise = false;
  const TrainingReport report = trained(threePlaces(), params);
  EXPECT_EQ(report.model.pairs.pair_scale, 0.0F);
  EXPECT_EQ(report.left_out.confusion, report.left_out_unary.confusion);
}

TEST(Training, ScoresNoPlaceThatIsOnlyForTraining) {
  auto places = threePlaces();
  places.push_back(made_up::place(4, 3));
  places.back().only_for_training = true;
  EXPECT_EQ(trained(places, made_up::quickTraining()).left_out.points(), 3U * 2 * 16 * 16 * 10);
}

TEST(Training, RefusesASinglePlaceBecauseNothingCouldBeLeftOut) {
  const std::vector<TrainingPlace> places{made_up::place(1, 0)};
  try {
    trained(places, made_up::quickTraining());
    FAIL() << "a single place was taken";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("two places"), std::string::npos) << error.what();
  }
}

TEST(Training, RefusesPlacesWithoutAnyTruth) {
  auto places = threePlaces();
  for (TrainingPlace& place : places)
    for (auto& [key, counts] : place.truth) std::fill(counts.begin(), counts.end(), TruthCounts{});
  EXPECT_THROW(trained(places, made_up::quickTraining()), InputError);
}

TEST(Training, CrossValidationMeasuresEveryGroupOnce) {
  ProgressSink sink;
  const auto places = threePlaces();
  const auto folds = crossValidate(places, PerceptionParams{}, made_up::quickTraining(), 1, sink);
  ASSERT_EQ(folds.size(), 3U);
  for (const FoldReport& fold : folds) EXPECT_EQ(fold.evaluation.scores.points(), 2U * 16 * 16 * 10);
}

/// A wall of points 4 m away, in front of another 8 m away, over flat ground.
Scan twoWalls() {
  Scan scan;
  const auto put = [&](float x, float y, float z) {
    scan.points.x.push_back(x);
    scan.points.y.push_back(y);
    scan.points.z.push_back(z);
  };
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j) put(0.1F * static_cast<float>(i), 0.1F * static_cast<float>(j), 0.0F);
  for (const float x : {6.0F, 10.0F})
    for (int i = 0; i < 60; ++i)
      for (int j = 0; j < 60; ++j) put(x, -1.0F + 0.1F * static_cast<float>(i), 0.1F * static_cast<float>(j));
  return scan;
}

TEST(VirtualSensor, SeesTheNearWallUpToItsHighestLineAndNotTheFarOne) {
  const std::vector<Scan> scans{twoWalls()};
  PointTruth truth;
  truth.primitive.assign(1600, 0);
  truth.primitive.resize(scans[0].points.size(), 1);
  const std::vector<PointTruth> truths{truth};
  const VirtualSensor sensor{.height_m = 1.5, .lowest_rad = -0.4, .highest_rad = 0.1, .lines = 10, .step_rad = 0.05, .spacing_m = 4};
  const LabelledScans copy = seenBy(scans, truths, sensor);
  ASSERT_EQ(copy.scans.size(), 1U);
  std::size_t near = 0, far = 0;
  for (std::size_t i = 0; i < copy.scans[0].points.size(); ++i) {
    if (copy.truth[0].primitive[i] != 1) continue;
    (copy.scans[0].points.x[i] < 8.0F ? near : far) += 1;
    EXPECT_LE(copy.scans[0].points.z[i], 2.6F);
  }
  EXPECT_GT(near, 100U);
  EXPECT_LT(far, near / 5);
}

TEST(VirtualSensor, ThinsToTheShareAskedFor) {
  const std::vector<Scan> scans{twoWalls()};
  PointTruth truth;
  truth.primitive.assign(scans[0].points.size(), 0);
  const LabelledScans copy = thinned(scans, std::vector<PointTruth>{truth}, 0.25, 3);
  EXPECT_NEAR(static_cast<double>(copy.scans[0].points.size()), 0.25 * static_cast<double>(scans[0].points.size()), 150);
  EXPECT_EQ(copy.truth[0].primitive.size(), copy.scans[0].points.size());
}

}  // namespace
}  // namespace cluxel
