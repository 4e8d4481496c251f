// SPDX-License-Identifier: Apache-2.0
// The shares of an evaluation's rows: what text and JSON both show.
#pragma once

#include <array>
#include <optional>

#include "tasks/evaluation/evaluation.hpp"

namespace cluxel::tasks {

struct ShareInterval {
  double low = 0, high = 1;
};

/// Wilson's 95 % interval of the share `hits` of `total` (E. B. Wilson, JASA 22, 1927); 0 to 1 for a total of 0. Half
/// numbers are allowed, as for F1, which is a share of the mean of true and found objects.
ShareInterval wilsonInterval(double hits, double total);

/// A share; empty where the total is 0.
using Share = std::optional<double>;

inline Share shareOf(double value, std::uint64_t whole) {
  return whole == 0 ? Share() : Share(value);
}

/// Precision, recall, F1, IoU. A class without truth has a count of false answers only.
inline std::array<Share, 4> sharesOf(const ConfusionMatrix& matrix, std::size_t i) {
  const std::uint64_t truth = matrix.truthCount(i);
  return {shareOf(matrix.precision(i), matrix.answerCount(i)), shareOf(matrix.recall(i), truth),
          shareOf(matrix.f1(i), truth), shareOf(matrix.iou(i), truth)};
}

/// A share of objects with its interval.
struct ObjectShare {
  Share share;
  ShareInterval interval;
};

/// Precision, recall, F1. F1 is a share of the mean of true and found objects, which gives its interval.
inline std::array<ObjectShare, 3> sharesOf(const ObjectScore& score) {
  const auto truth = static_cast<double>(score.truth), answers = static_cast<double>(score.answers);
  const double mean = (truth + answers) / 2;
  return {{{shareOf(score.precision(), score.answers), wilsonInterval(double(score.matched_answers), answers)},
           {shareOf(score.recall(), score.truth), wilsonInterval(double(score.matched_truth), truth)},
           {shareOf(score.f1(), score.truth), wilsonInterval(score.f1() * mean, mean)}}};
}

}  // namespace cluxel::tasks
