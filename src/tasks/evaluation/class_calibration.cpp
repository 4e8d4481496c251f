// SPDX-License-Identifier: Apache-2.0
// Ten bins of equal width, so that evaluations of several maps can be added.
#include "tasks/evaluation/class_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cluxel::tasks {

void Calibration::add(double confidence, bool is_right) {
  const double share = std::clamp(confidence, 0.0, 1.0);
  CalibrationBin& bin = bins[std::min<std::size_t>(static_cast<std::size_t>(share * 10), bins.size() - 1)];
  ++bin.objects;
  bin.right += is_right ? 1 : 0;
  bin.confidence_sum += share;
  bin.variance_sum += share * (1 - share);
}

void Calibration::add(const Calibration& other) {
  for (std::size_t i = 0; i < bins.size(); ++i) {
    bins[i].objects += other.bins[i].objects;
    bins[i].right += other.bins[i].right;
    bins[i].confidence_sum += other.bins[i].confidence_sum;
    bins[i].variance_sum += other.bins[i].variance_sum;
  }
}

std::uint64_t Calibration::objects() const {
  std::uint64_t sum = 0;
  for (const CalibrationBin& bin : bins) sum += bin.objects;
  return sum;
}

double Calibration::expectedError() const {
  double sum = 0;
  for (const CalibrationBin& bin : bins) sum += std::abs(bin.confidence_sum - static_cast<double>(bin.right));
  return objects() == 0 ? 0 : sum / static_cast<double>(objects());
}

double Calibration::errorByChance() const {
  double sum = 0;
  for (const CalibrationBin& bin : bins) sum += std::sqrt(2 / std::numbers::pi * bin.variance_sum);
  return objects() == 0 ? 0 : sum / static_cast<double>(objects());
}

Calibration ClassVotes::calibrationOf(const std::vector<rules::SemanticObject>& objects,
                                      const std::vector<std::size_t>& class_of_object, std::size_t class_count,
                                      std::size_t left_out) const {
  Calibration calibration;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const std::size_t own = class_of_object[i];
    if (votes_[i].empty() || own >= class_count || own == left_out) continue;
    std::uint64_t with_truth = 0;
    for (const auto& [truth_class, count] : votes_[i]) with_truth += count;
    if (with_truth < without_truth_[i]) continue;
    const auto most_voted = std::max_element(votes_[i].begin(), votes_[i].end(),
                                             [](const auto& a, const auto& b) { return a.second < b.second; });
    calibration.add(objects[i].confidence, most_voted->first == own);
  }
  return calibration;
}

}  // namespace cluxel::tasks
