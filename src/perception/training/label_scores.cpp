// SPDX-License-Identifier: Apache-2.0
// Sums over the confusion matrix.
#include "perception/training/label_scores.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace cluxel::perception {

namespace {

double ratio(double part, double whole) {
  return whole > 0 ? part / whole : 0.0;
}

}  // namespace

void LabelScores::add(const TruthCounts& truth, std::uint8_t label) {
  for (std::size_t k = 0; k < truth.size(); ++k) confusion[k][label] += truth[k];
}

LabelScores& LabelScores::operator+=(const LabelScores& other) {
  for (std::size_t k = 0; k < confusion.size(); ++k)
    for (std::size_t l = 0; l < confusion.size(); ++l) confusion[k][l] += other.confusion[k][l];
  return *this;
}

std::uint64_t LabelScores::points() const {
  std::uint64_t sum = 0;
  for (const Row& row : confusion)
    for (const std::uint64_t count : row) sum += count;
  return sum;
}

double LabelScores::accuracy() const {
  std::uint64_t right = 0;
  for (std::size_t k = 0; k < confusion.size(); ++k) right += confusion[k][k];
  return ratio(static_cast<double>(right), static_cast<double>(points()));
}

double LabelScores::precision(std::size_t label) const {
  std::uint64_t labelled = 0;
  for (const Row& row : confusion) labelled += row[label];
  return ratio(static_cast<double>(confusion[label][label]), static_cast<double>(labelled));
}

double LabelScores::recall(std::size_t label) const {
  std::uint64_t present = 0;
  for (const std::uint64_t count : confusion[label]) present += count;
  return ratio(static_cast<double>(confusion[label][label]), static_cast<double>(present));
}

double LabelScores::f1(std::size_t label) const {
  const double p = precision(label), r = recall(label);
  return ratio(2 * p * r, p + r);
}

double LabelScores::macroF1() const {
  double sum = 0, labels = 0;
  for (std::size_t k = 0; k < confusion.size(); ++k) {
    if (std::all_of(confusion[k].begin(), confusion[k].end(), [](std::uint64_t n) { return n == 0; })) continue;
    sum += f1(k);
    ++labels;
  }
  return ratio(sum, labels);
}

std::string toMarkdown(const LabelScores& scores) {
  std::string text = "| truth \\ label | ";
  for (const std::string_view name : scan::kPrimitiveLabelNames) text += std::string(name) + " | ";
  text += "precision | recall | F1 |\n|---|---|---|---|---|---|---|---|---|\n";
  std::array<char, 128> cell{};
  for (std::size_t k = 0; k < scan::kPrimitiveLabelCount; ++k) {
    text += "| " + std::string(scan::kPrimitiveLabelNames[k]) + " | ";
    for (const std::uint64_t count : scores.confusion[k]) text += std::to_string(count) + " | ";
    std::snprintf(cell.data(), cell.size(), "%.3f | %.3f | %.3f |\n", scores.precision(k), scores.recall(k),
                  scores.f1(k));
    text += cell.data();
  }
  std::snprintf(cell.data(), cell.size(), "\noverall accuracy %.4f, macro F1 %.4f, %llu points\n", scores.accuracy(),
                scores.macroF1(), static_cast<unsigned long long>(scores.points()));
  return text + cell.data();
}

void CalibrationError::add(const TruthCounts& truth, std::uint8_t label, float probability) {
  double points = 0;
  for (const std::uint32_t count : truth) points += count;
  const auto last = static_cast<double>(bins_.size() - 1);
  Bin& bin =
      bins_[static_cast<std::size_t>(std::clamp(std::floor(static_cast<double>(probability) * 20.0), 0.0, last))];
  bin.points += points;
  bin.right += truth[label];
  bin.stated += points * static_cast<double>(probability);
}

double CalibrationError::value() const {
  double gap = 0, points = 0;
  for (const Bin& bin : bins_) {
    gap += std::abs(bin.right - bin.stated);
    points += bin.points;
  }
  return ratio(gap, points);
}

}  // namespace cluxel::perception
