// SPDX-License-Identifier: Apache-2.0
// Accuracy of a map against ground truth: primitives by point, objects by point and by object.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mapping/map_reader.hpp"
#include "tasks/evaluation/class_calibration.hpp"
#include "tasks/evaluation/crown_pairs.hpp"
#include "tasks/evaluation/truth_source.hpp"

namespace cluxel::tasks {

/// Counts of (truth, answer). Rows are the truth's classes; columns the same classes and, last, "no answer".
struct ConfusionMatrix {
  std::vector<std::string> names;
  std::vector<std::uint64_t> counts;  ///< names.size() rows of names.size() + 1

  explicit ConfusionMatrix(std::vector<std::string> class_names);
  void add(std::size_t truth, std::size_t answer) { ++counts[truth * (names.size() + 1) + answer]; }
  /// Adds the counts of another map, which must have the same names.
  void add(const ConfusionMatrix& other);
  std::uint64_t at(std::size_t truth, std::size_t answer) const { return counts[truth * (names.size() + 1) + answer]; }
  std::uint64_t truthCount(std::size_t name) const;
  std::uint64_t answerCount(std::size_t name) const;
  std::uint64_t total() const;
  /// 0 when the class has no answer or no truth.
  double precision(std::size_t name) const;
  double recall(std::size_t name) const;
  double f1(std::size_t name) const;
  double iou(std::size_t name) const;
  double overallAccuracy() const;
  /// Means over the classes that the truth has.
  double macroF1() const;
  double macroIou() const;
};

/// Objects of one class, found by a one-to-one match.
struct ObjectScore {
  std::string name;
  std::uint64_t truth = 0, answers = 0;  ///< that count
  std::uint64_t matched_truth = 0;       ///< truth objects with a partner (not ambiguous)
  std::uint64_t matched_answers = 0;     ///< answers with a partner that counts
  double precision() const;
  double recall() const;
  double f1() const;
};

/// What the true objects of one kind are called in the map. A kind is what the data set's own labels call a thing
/// ("trunk"), or with truth files its class. Counts are by class of the truth; then "another class"; then "none".
struct KindAnswers {
  std::string name;
  std::uint64_t truth = 0;            ///< objects of the kind
  std::vector<std::uint64_t> found;   ///< class of the object with an IoU of 0.5 or more; none: there is no such object
  std::vector<std::uint64_t> called;  ///< class of the object that has the most of its points; none: most are in none
  std::vector<std::uint64_t> boxed;   ///< class of the object with an IoU of boxes of 0.8 or more; none: there is none
};

/// An object of the map that counts as right or wrong.
struct JudgedAnswer {
  std::uint32_t object = 0;      ///< number in the map
  std::size_t class_number = 0;  ///< in the truth's class names
  double confidence = 0;
  bool is_right = false;  ///< it has a partner by points
};

/// Precision and recall of the objects of one class whose confidence is at least `confidence`.
struct PrecisionRecall {
  double confidence = 0;
  std::uint64_t answers = 0, right = 0;
  double precision = 0, recall = 0;
};

struct MapEvaluation {
  ConfusionMatrix primitives, objects;  ///< by point
  bool has_instances = false;
  /// Partners whose axis-parallel boxes, padded by the cluxel radius, have an IoU of at least 0.8 (the paper's
  /// measure), and partners whose point sets have an IoU of at least 0.5.
  std::vector<ObjectScore> by_box, by_points;
  std::vector<KindAnswers> kinds = {};  ///< sorted by name
  /// False where only some objects are labelled: then the precision of objects says little, and points without a label
  /// count neither way.
  bool covers_all = true;
  /// True objects whose partner by points is one also when its points without truth count as outside; equal to those
  /// of `by_points` where every point has truth.
  std::uint64_t matched_whole = 0;
  std::vector<JudgedAnswer> judged = {};
  Calibration calibration = {};  ///< of all objects but Ground
  CrownPairScore crown_pairs = {};

  /// For each confidence of an object of class `by_points[class_number]`, descending. Empty without true objects.
  std::vector<PrecisionRecall> precisionRecallOf(std::size_t class_number) const;
  /// Adds another map's evaluation against the same truth classes.
  void add(const MapEvaluation& other);
};

struct EvaluationParams {
  double box_iou = 0.8, point_iou = 0.5;
  double box_padding_m = 0.20;  ///< boxes grow by so much on every side: plates are thinner than their points scatter
};

/// Compares every point of the map's clouds that has truth. Points of unknown truth count nowhere.
/// Classes without well-defined instances (Ground) count by point only.
MapEvaluation evaluateMap(const mapping::MapReader& map, const TruthSource& truth, const EvaluationParams& params = {});

/// Tables for people.
std::string toText(const MapEvaluation& evaluation);
/// The same as JSON text.
std::string toJson(const MapEvaluation& evaluation);

}  // namespace cluxel::tasks
