// SPDX-License-Identifier: Apache-2.0
// Trains a label model on places with known truth, and measures it on places left out.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "cluxel/progress.hpp"
#include "perception/crf/label_model.hpp"
#include "perception/crf/labelling.hpp"
#include "perception/training/label_scores.hpp"
#include "perception/training/unary_training.hpp"
#include "scan/scan.hpp"
#include "scan/truth/truth.hpp"

namespace cluxel::perception {

/// Scans perceived together, with the truth of each cluxel. Places of one group are left out together.
struct TrainingPlace {
  std::string name;
  int group = 0;
  bool only_for_training = false;  ///< never scored, for example a thinned copy
  std::map<TileKey, FeatureTile> features;
  std::map<TileKey, std::vector<TruthCounts>> truth;  ///< per cluxel of each tile
};

/// Runs perception on the scans and counts the truth of every point, thinned away or not, at the cluxel that represents
/// it. `truth` has one entry per scan.
TrainingPlace makePlace(std::span<const scan::Scan> scans, std::span<const scan::PointTruth> truth,
                        const PerceptionParams& params, unsigned threads);

struct TrainParams {
  BoostingParams boosting;
  double class_balance = 0.5;  ///< class weight = 1 / frequency^class_balance: 0 none, 1 equal classes
  double point_power = 0.5;    ///< cluxel weight = points^point_power
  int max_rows = 1000000;      ///< cluxels for the unary; frequent labels are sampled and get more weight
  bool pairwise = true;
  bool overlap_correction = true;  ///< overlapping supports and high degrees reduce edge weights
  double pair_l2 = 3.0;
  /// Prefixes of columns that must not be used, since they depend on the sensor's height or density.
  std::vector<std::string> without_columns = {"metric.density",       "metric.extent",    "metric.stack_0m5_top",
                                              "metric.stack_1m5_top", "metric.stack_3m5", "metric.wide1m5_members",
                                              "metric.wide3m_members"};
  LabellingParams labelling;
};

struct TrainingReport {
  LabelModel model;
  LabelScores left_out;        ///< by point, of each group labelled by a unary that did not see it
  LabelScores left_out_unary;  ///< the same without the pairwise term
  double calibration_error_before = 0, calibration_error = 0;
};

/// Trains on all places. The pairwise term and the calibration are fitted to scores of unaries that leave one group out
/// in turn. Needs at least two groups; throws InputError otherwise, or when there is no truth. The result does not
/// depend on the number of threads.
TrainingReport train(const std::string& name, std::span<const TrainingPlace> places, const PerceptionParams& perception,
                     const TrainParams& params, unsigned threads, ProgressSink& sink);

/// Labels the scored places with the model and counts correct labels.
struct Evaluation {
  LabelScores scores;
  double calibration_error = 0;
};
Evaluation evaluate(const LabelModel& model, std::span<const TrainingPlace> places, const LabellingParams& params,
                    unsigned threads);

}  // namespace cluxel::perception
