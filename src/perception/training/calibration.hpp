// SPDX-License-Identifier: Apache-2.0
// Fits probabilities and the choice of labels to cluxels that the unary did not see.
#pragma once

#include <vector>

#include "perception/crf/label_model.hpp"
#include "perception/training/label_scores.hpp"

namespace cluxel::perception {

/// Marginals of cluxels with the truth of their points.
struct CalibrationRows {
  std::vector<LabelValues> marginals;
  std::vector<TruthCounts> truth;
};

/// Slope and offsets that make the truth most likely, point by point; favours that make the macro F1 largest.
Calibration fitCalibration(const CalibrationRows& all_rows);

LabelScores scoresOf(const CalibrationRows& rows, const Calibration& calibration);
double calibrationErrorOf(const CalibrationRows& rows, const Calibration& calibration);

}  // namespace cluxel::perception
