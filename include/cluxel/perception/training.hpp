// SPDX-License-Identifier: Apache-2.0
// Trains a label model on places with known truth, and measures it on places left out.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "cluxel/base/progress.hpp"
#include "cluxel/perception/label_model.hpp"
#include "cluxel/perception/label_scores.hpp"
#include "cluxel/perception/labelling.hpp"
#include "cluxel/perception/unary_training.hpp"
#include "cluxel/scan/scan.hpp"
#include "cluxel/scan/truth.hpp"

namespace cluxel {

/// Scans perceived together, with the truth of each cluxel. Places of one group are left out together.
struct TrainingPlace {
  std::string name;
  int group = 0;
  bool only_for_training = false;  ///< a thinned copy: never scored
  std::map<TileKey, FeatureTile> features;
  std::map<TileKey, std::vector<TruthCounts>> truth;  ///< per cluxel of each tile
};

/// Perceives the scans and counts the truth of every point (also thinned away ones) at the cluxel that stands for it.
/// `truth` has one entry per scan.
TrainingPlace makePlace(std::span<const Scan> scans, std::span<const PointTruth> truth, const PerceptionParams& params,
                        unsigned threads);

struct TrainParams {
  BoostingParams boosting;
  double class_balance = 0.5;  ///< classes weigh as 1 / frequency^this: 0 as they come, 1 all alike
  double point_power = 0.5;    ///< a cluxel weighs as its points to this power
  int most_rows = 1000000;     ///< cluxels for the unary: common labels are thinned, and weigh more for it
  bool pairwise = true;
  bool overlap_correction = true;  ///< let overlap of supports and degree weaken edges
  double pair_l2 = 3.0;
  /// Beginnings of names of columns that must not be used. These depend on how high and how densely a sensor sees.
  std::vector<std::string> without_columns = {"metric.density",        "metric.extent",     "metric.column_0m5_top",
                                              "metric.column_1m5_top", "metric.column_3m5", "metric.wide1m5_members",
                                              "metric.wide3m_members"};
  LabellingParams labelling;
};

struct TrainingReport {
  LabelModel model;
  LabelScores left_out;        ///< by point, of each group labelled by a unary that did not see it
  LabelScores left_out_unary;  ///< the same without the pairwise term
  double calibration_error_before = 0, calibration_error = 0;
};

/// Trains on all places. Unaries that leave one group out in turn give the scores that the pairwise term and the
/// calibration are fitted to. Needs two groups at least; throws InputError otherwise, or when there is no truth.
/// The same bytes for every number of threads.
TrainingReport train(const std::string& name, std::span<const TrainingPlace> places, const PerceptionParams& perception,
                     const TrainParams& params, unsigned threads, ProgressSink& sink);

/// Labels the scored places of a model's choice and counts.
struct Evaluation {
  LabelScores scores;
  double calibration_error = 0;
};
Evaluation evaluate(const LabelModel& model, std::span<const TrainingPlace> places, const LabellingParams& params,
                    unsigned threads);

/// For each group: everything is trained on the others alone, pairs and calibration too, and measured on it.
struct FoldReport {
  int group = 0;
  Evaluation evaluation;
};
std::vector<FoldReport> crossValidate(std::span<const TrainingPlace> places, const PerceptionParams& perception,
                                      const TrainParams& params, unsigned threads, ProgressSink& sink);

}  // namespace cluxel
