// SPDX-License-Identifier: Apache-2.0
// One-to-one matches between truth objects and the map's objects.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tasks/evaluation/evaluation.hpp"

namespace cluxel::tasks {

/// The points of one object, true or found.
struct PointSet {
  std::size_t class_number = 0;        ///< in the truth's class names; size() of them: another class
  std::uint64_t count = 0;             ///< points with truth
  Eigen::AlignedBox3d box;             ///< [m, map]
  bool counts = true;                  ///< false: ambiguous
  std::uint64_t without_instance = 0;  ///< points whose truth has this class but no instance
  std::uint64_t without_truth = 0;     ///< points that `count` leaves out
};

/// Collects points with truth and answer, then matches.
class ObjectMatching {
 public:
  /// `class_of_object` as truthClassesOf() gives it.
  ObjectMatching(const std::vector<std::string>& class_names, const std::vector<std::size_t>& class_of_object,
                 const std::vector<std::int32_t>& ambiguous);
  /// A point with known truth class; `instance` -1 and `object` kNoObjectOfPoint mean none. Ground has no well-defined
  /// instances: its instances are ignored, and objects of this class are no answers.
  void add(const Eigen::Vector3d& p_map, std::size_t truth_class, std::int32_t instance, std::uint32_t object);
  /// A point of unknown truth.
  void addWithoutTruth(std::uint32_t object);
  bool hasInstances() const { return !truth_.empty(); }
  std::vector<ObjectScore> scoreByBox(const EvaluationParams& params) const;
  std::vector<ObjectScore> scoreByPoints(const EvaluationParams& params) const;
  /// The objects that count, each with right or wrong; the confidence is not filled in.
  std::vector<JudgedAnswer> judgedByPoints(const EvaluationParams& params) const;
  /// What true objects are called, by the kind of each instance. Ambiguous instances do not count.
  std::vector<KindAnswers> answersByKind(const std::map<std::int32_t, std::string>& kinds,
                                         const EvaluationParams& params) const;
  /// As MapEvaluation::matched_whole.
  std::uint64_t matchedWhole(const EvaluationParams& params) const;

 private:
  struct Candidate {
    double iou = 0;
    std::int32_t instance = 0;
    std::uint32_t object = 0;
  };
  struct Partners {
    std::set<std::int32_t> instances;
    std::set<std::uint32_t> objects;
  };
  template <typename Iou>
  Partners match(double min_iou, const Iou& iou) const;
  template <typename Iou>
  std::vector<ObjectScore> score(double min_iou, const Iou& iou) const;
  /// The instance that shares the most points with the object, of any class; -1 when none does.
  std::int32_t bestInstance(std::uint32_t object) const;
  bool countsAsAnswer(std::uint32_t object) const;
  /// The class of the object whose box matches that of the true object; names_.size() + 1 when there is none.
  std::size_t boxedClass(const PointSet& truth, const std::map<std::uint32_t, std::uint64_t>& takers,
                         const EvaluationParams& params) const;
  /// Enters one true object into the counts of its kind.
  void countAnswers(const PointSet& truth, const std::map<std::uint32_t, std::uint64_t>& takers,
                    const EvaluationParams& params, KindAnswers& answers) const;
  /// The objects that share points with each instance, with the numbers of these points.
  std::map<std::int32_t, std::map<std::uint32_t, std::uint64_t>> objectsOfInstances() const;

  std::vector<std::string> names_;
  std::size_t ground_ = 0;  ///< the number of Ground, or names_.size()
  std::vector<std::int32_t> ambiguous_;
  std::map<std::int32_t, PointSet> truth_;
  std::vector<PointSet> found_;
  std::map<std::pair<std::uint32_t, std::int32_t>, std::uint64_t> shared_;  ///< (object, instance) → points
};

}  // namespace cluxel::tasks
