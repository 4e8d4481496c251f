// SPDX-License-Identifier: Apache-2.0
// Whether the confidence of an object is the share of such objects whose class is right.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "rules/objects/semantic_object.hpp"

namespace cluxel::tasks {

/// Objects whose confidence lies within one tenth.
struct CalibrationBin {
  std::uint64_t objects = 0, right = 0;
  double confidence_sum = 0;
  double variance_sum = 0;  ///< of p (1 - p), p being the confidences
};

/// A class is right when most of the object's points with truth are of this class.
struct Calibration {
  std::array<CalibrationBin, 10> bins = {};

  void add(double confidence, bool is_right);
  void add(const Calibration& other);
  std::uint64_t objects() const;
  /// The expected calibration error: the mean over objects of |mean confidence - share that is right| of their bin; 0
  /// without objects (Naeini, Cooper, Hauskrecht, AAAI 2015).
  double expectedError() const;
  /// What expectedError() would measure on average if every confidence were exactly right: with few objects the share
  /// that is right differs from it by chance. A normal approximation in each bin.
  double errorByChance() const;
};

/// Counts the true classes of each object's points.
class ClassVotes {
 public:
  explicit ClassVotes(std::size_t object_count) : votes_(object_count), without_truth_(object_count, 0) {}
  void add(std::uint32_t object, std::size_t truth_class) { ++votes_[object][truth_class]; }
  void addWithoutTruth(std::uint32_t object) { ++without_truth_[object]; }
  /// Of the objects whose class is one of `class_count` and not `left_out`, and that have as many points with truth as
  /// without: a few stray points of a neighbour do not tell what a bush is that the truth has no class for.
  Calibration calibrationOf(const std::vector<rules::SemanticObject>& objects,
                            const std::vector<std::size_t>& class_of_object, std::size_t class_count,
                            std::size_t left_out) const;

 private:
  std::vector<std::map<std::size_t, std::uint64_t>> votes_;
  std::vector<std::uint64_t> without_truth_;
};

}  // namespace cluxel::tasks
