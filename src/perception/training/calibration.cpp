// SPDX-License-Identifier: Apache-2.0
// Vector scaling of log-marginals by L-BFGS, then coordinate search for the favours.
#include "perception/training/calibration.hpp"

#include <algorithm>
#include <cmath>

#include "perception/crf/labelling.hpp"
#include "perception/training/lbfgs_minimise.hpp"

namespace cluxel::perception {

namespace {

constexpr double kOffsetPenalty = 1e-4;
/// Only eleven parameters are fitted, so this many cluxels suffice.
constexpr std::size_t kMaxRows = 80000;

/// Mean negative log-likelihood of a point's truth; parameters: slope, then offsets.
double likelihoodLoss(const CalibrationRows& rows, double total, std::span<const double> x,
                      std::span<double> gradient) {
  std::fill(gradient.begin(), gradient.end(), 0.0);
  double loss = 0;
  for (std::size_t i = 0; i < rows.truth.size(); ++i) {
    const double points = pointsOf(rows.truth[i]);
    if (points == 0) continue;
    std::array<double, scan::kPrimitiveLabelCount> logs, shares;
    double sum = 0;
    for (std::size_t k = 0; k < scan::kPrimitiveLabelCount; ++k) {
      logs[k] = static_cast<double>(std::log(std::max(rows.marginals[i][k], 1e-9F)));
      sum += shares[k] = std::exp(x[0] * logs[k] + x[1 + k]);
    }
    for (std::size_t k = 0; k < scan::kPrimitiveLabelCount; ++k) {
      const double excess = points * shares[k] / sum - rows.truth[i][k];
      if (rows.truth[i][k] > 0)
        loss -= rows.truth[i][k] * std::log(shares[k] / sum) / total;  // 0 times minus infinity is none
      gradient[0] += excess * logs[k] / total;
      gradient[1 + k] += excess / total;
    }
  }
  for (std::size_t k = 0; k < scan::kPrimitiveLabelCount; ++k) {
    loss += kOffsetPenalty * x[1 + k] * x[1 + k];
    gradient[1 + k] += 2 * kOffsetPenalty * x[1 + k];
  }
  return loss;
}

/// Tries factors on each label's favour in turn and keeps what raises the macro F1.
void fitFavours(const CalibrationRows& rows, Calibration& calibration) {
  std::vector<LabelValues> probability;
  for (const LabelValues& marginals : rows.marginals)
    probability.push_back(calibrate(calibration, marginals).probability);
  const auto macroF1 = [&](const LabelValues& favour) {
    LabelScores scores;
    for (std::size_t i = 0; i < probability.size(); ++i) {
      std::size_t best = 0;
      for (std::size_t k = 1; k < scan::kPrimitiveLabelCount; ++k)
        if (probability[i][k] * favour[k] > probability[i][best] * favour[best]) best = k;
      scores.add(rows.truth[i], static_cast<std::uint8_t>(best));
    }
    return scores.macroF1();
  };
  double best = macroF1(calibration.favour);
  for (const float step : {1.6F, 1.25F, 1.1F})
    for (std::size_t k = 0; k < scan::kPrimitiveLabelCount; ++k)
      for (const float factor : {step, 1.0F / step})
        for (;;) {
          LabelValues favour = calibration.favour;
          favour[k] = std::clamp(favour[k] * factor, 0.1F, 10.0F);
          const double score = macroF1(favour);
          if (score <= best + 1e-5) break;
          best = score;
          calibration.favour = favour;
        }
}

}  // namespace

namespace {

/// Cluxels of known truth, at an even stride.
CalibrationRows sampleOf(const CalibrationRows& rows) {
  CalibrationRows known;
  const std::size_t stride = rows.truth.size() / kMaxRows + 1;
  for (std::size_t i = 0; i < rows.truth.size(); i += stride) {
    if (pointsOf(rows.truth[i]) == 0) continue;
    known.marginals.push_back(rows.marginals[i]);
    known.truth.push_back(rows.truth[i]);
  }
  return known;
}

}  // namespace

Calibration fitCalibration(const CalibrationRows& all_rows) {
  const CalibrationRows rows = sampleOf(all_rows);
  double total = 0;
  for (const TruthCounts& truth : rows.truth) total += pointsOf(truth);
  Calibration calibration;
  if (total == 0) return calibration;
  const auto objective = [&](std::span<const double> x, std::span<double> gradient) {
    return likelihoodLoss(rows, total, x, gradient);
  };
  const auto best = minimise(objective, {1, 0, 0, 0, 0, 0}, {.iterations = 60, .precision = 1e-5});
  calibration.slope = static_cast<float>(best[0]);
  for (std::size_t k = 0; k < scan::kPrimitiveLabelCount; ++k) calibration.offset[k] = static_cast<float>(best[1 + k]);
  fitFavours(rows, calibration);
  return calibration;
}

LabelScores scoresOf(const CalibrationRows& rows, const Calibration& calibration) {
  LabelScores scores;
  for (std::size_t i = 0; i < rows.truth.size(); ++i)
    scores.add(rows.truth[i], calibrate(calibration, rows.marginals[i]).label);
  return scores;
}

double calibrationErrorOf(const CalibrationRows& rows, const Calibration& calibration) {
  CalibrationError error;
  for (std::size_t i = 0; i < rows.truth.size(); ++i) {
    const CalibratedLabel result = calibrate(calibration, rows.marginals[i]);
    error.add(rows.truth[i], result.label, result.probability[result.label]);
  }
  return error.value();
}

}  // namespace cluxel::perception
