// SPDX-License-Identifier: Apache-2.0
// Training on synthetic places: accuracy, determinism, and correctness of the reported figures.
#include "perception/training/training.hpp"

#include <gtest/gtest.h>

#include "cluxel/error.hpp"
#include "perception/labelling_fixture.hpp"

namespace cluxel::perception {

using namespace scan;
namespace {

std::vector<TrainingPlace> threePlaces() {
  return {made_up::place(1, 0), made_up::place(2, 1), made_up::place(3, 2)};
}

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
  const auto one = trained(threePlaces(), made_up::quickTraining(), 1),
             two = trained(threePlaces(), made_up::quickTraining(), 2);
  EXPECT_EQ(modelText(one.model), modelText(two.model));
}

TEST(Training, SaysWhatTheModelWasMadeOf) {
  const TrainParams params = made_up::quickTraining();
  auto places = threePlaces();
  const auto first = trained(places, params).model.provenance, again = trained(places, params).model.provenance;
  EXPECT_EQ(first, again);
  EXPECT_EQ(first.at("places measured on when left out"), "3");
  EXPECT_EQ(first.at("places that only help"), "0");
  std::swap(places[1].truth.begin()->second.front()[0], places[1].truth.begin()->second.front()[1]);
  EXPECT_NE(trained(places, params).model.provenance.at("features and truth"), first.at("features and truth"));
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

}  // namespace
}  // namespace cluxel::perception
