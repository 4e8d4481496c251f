// SPDX-License-Identifier: Apache-2.0
// How well labels fit the truth, counted by point: confusion, precision, recall, F1, and calibration of probabilities.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "scan/truth/primitive_label.hpp"

namespace cluxel::perception {

/// Points of each primitive label among a cluxel's points; points of unknown truth are not counted.
using TruthCounts = std::array<std::uint32_t, scan::kPrimitiveLabelCount>;

inline double pointsOf(const TruthCounts& truth) {
  double points = 0;
  for (const std::uint32_t count : truth) points += count;
  return points;
}

struct LabelScores {
  using Row = std::array<std::uint64_t, scan::kPrimitiveLabelCount>;
  std::array<Row, scan::kPrimitiveLabelCount> confusion{};  ///< [truth][label] in points

  void add(const TruthCounts& truth, std::uint8_t label);
  LabelScores& operator+=(const LabelScores& other);

  std::uint64_t points() const;
  double accuracy() const;
  double precision(std::size_t label) const;  ///< 0 when nothing has the label
  double recall(std::size_t label) const;     ///< 0 when no truth has the label
  double f1(std::size_t label) const;
  /// Mean F1 of the labels that the truth has.
  double macroF1() const;
};

/// The scores as a Markdown table.
std::string toMarkdown(const LabelScores& scores);

/// Expected calibration error: the gap between stated probability and share of right answers, over 20 bins of equal
/// width, weighted by points.
class CalibrationError {
 public:
  void add(const TruthCounts& truth, std::uint8_t label, float probability);
  double value() const;

 private:
  struct Bin {
    double points = 0, right = 0, stated = 0;
  };
  std::array<Bin, 20> bins_{};
};

}  // namespace cluxel::perception
