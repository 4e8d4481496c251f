// SPDX-License-Identifier: Apache-2.0
// Measures of candidates by brute force over all cluxels, as an oracle for those of the rules.
#pragma once

#include <algorithm>
#include <cmath>

#include "rules/propose/condition_eval.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
using namespace rules;

inline constexpr double kShareReach_m = 0.5;  // in plan view: shares of edges count for things within it

inline std::vector<FragmentIndex> aliveOthers(const ReasoningState& state, const Candidate& subject) {
  std::vector<FragmentIndex> others;
  for (PrimitiveIndex i = 0; i < state.scene.primitives.size(); ++i)
    for (FragmentIndex fragment : state.fragments.fragmentsOf(i))
      if (!std::binary_search(subject.fragments.begin(), subject.fragments.end(), fragment)) others.push_back(fragment);
  return others;
}

/// Measures by comparing everything with everything.
class BruteForce {
 public:
  BruteForce(const ReasoningState& state, const Bindings& bindings) : state_(state), bindings_(bindings) {}

  std::optional<double> attribute(const std::string& of, const std::optional<SliceSpec>& slice, Attribute which) const {
    const Candidate& candidate = bindings_.at(of);
    if (!slice) return candidate.shape[which];
    const SceneCluxels& all = state_.scene.cluxels;
    std::vector<std::uint32_t> inside;
    for (std::uint32_t cluxel = 0; cluxel < all.size(); ++cluxel) {
      const double height = all.center[cluxel].z() - state_.scene.primitives[all.primitive[cluxel]].ground_z;
      const bool mine = std::binary_search(candidate.fragments.begin(), candidate.fragments.end(),
                                           state_.fragments.fragmentOf(cluxel));
      if (mine && height >= slice->from_m && height <= slice->to_m) inside.push_back(cluxel);
    }
    if (inside.empty()) return std::nullopt;
    if (inside.size() == state_.fragments.cluxelsOf(candidate).size()) return candidate.shape[which];
    return extentOf(inside, which);
  }

  /// Of pairs: the smallest measure to the target (the largest share); absent when there is none.
  std::optional<double> pair(const Condition& condition) const {
    const Candidate& subject = bindings_.at(condition.of);
    if (condition.target->kind == Target::Kind::Name)
      return measure(condition.measure, subject, bindings_.at(condition.target->name));
    const bool share = condition.measure == PairMeasure::AdjacentFraction;
    std::optional<double> best = share ? std::optional(0.0) : std::nullopt;
    for (FragmentIndex other : aliveOthers(state_, subject)) {
      if (!isTarget(other, *condition.target)) continue;
      const Candidate candidate = state_.fragments.candidateOf({other});
      if (share && measure(PairMeasure::HorizontalGap, subject, candidate) > kShareReach_m) continue;
      const double value = measure(condition.measure, subject, candidate);
      if (!best || (share ? value > *best : value < *best)) best = value;
    }
    return best;
  }

  std::optional<double> relation(const Condition& condition) const {
    const Candidate& subject = bindings_.at(condition.of);
    if (condition.relation == RelationKind::TouchesGround) return subject.shape[Attribute::Bottom];
    std::optional<double> best;
    for (const Relation& relation : state_.scene.relations) {
      if (relation.kind != condition.relation || !consistsOf(subject, relation.from)) continue;
      for (FragmentIndex other : state_.fragments.fragmentsOf(relation.to))
        if (!std::binary_search(subject.fragments.begin(), subject.fragments.end(), other) &&
            isTarget(other, *condition.target) && (!best || relation.measure < *best))
          best = relation.measure;
    }
    return best;
  }

  /// The share of the cluxels' points whose fragment has one of the labels.
  double labelShare(const Condition& condition) const {
    double labelled = 0, all = 0;
    for (std::uint32_t cluxel : state_.fragments.cluxelsOf(bindings_.at(condition.of))) {
      const PrimitiveLabel label = state_.fragments.labelOf(state_.fragments.fragmentOf(cluxel));
      const bool counts = std::find(condition.labels.begin(), condition.labels.end(), label) != condition.labels.end();
      all += state_.scene.cluxels.point_count[cluxel];
      labelled += counts ? state_.scene.cluxels.point_count[cluxel] : 0;
    }
    return labelled / all;
  }

 private:
  bool consistsOf(const Candidate& candidate, PrimitiveIndex primitive) const {
    return std::any_of(candidate.fragments.begin(), candidate.fragments.end(),
                       [&](FragmentIndex mine) { return state_.fragments[mine].primitive == primitive; });
  }

  bool isTarget(FragmentIndex fragment, const Target& target) const {
    if (target.kind == Target::Kind::Name) {
      const auto& named = bindings_.at(target.name).fragments;
      return std::find(named.begin(), named.end(), fragment) != named.end();
    }
    if (target.kind == Target::Kind::Labels)
      return std::find(target.labels.begin(), target.labels.end(), state_.fragments.labelOf(fragment)) !=
             target.labels.end();
    const OwnerIndex owner = state_.fragments[fragment].owner;
    return owner < state_.objects.size() &&
           state_.rules.catalogue.isA(state_.objects[owner].rule->class_iri, target.object_class);
  }

  std::optional<double> extentOf(const std::vector<std::uint32_t>& cluxels, Attribute which) const {
    const SceneCluxels& all = state_.scene.cluxels;
    double low = 1e300, high = -1e300, points = 0;
    for (std::uint32_t cluxel : cluxels) {
      low = std::min(low, all.center[cluxel].z() - all.extent[cluxel].cast<double>().z() / 2);
      high = std::max(high, all.center[cluxel].z() + all.extent[cluxel].cast<double>().z() / 2);
      points += all.point_count[cluxel];
    }
    if (which == Attribute::Height) return high - low;
    if (which == Attribute::PointCount) return points;
    if (which == Attribute::CluxelCount) return static_cast<double>(cluxels.size());
    return std::nullopt;
  }

  double measure(PairMeasure which, const Candidate& a, const Candidate& b) const {
    const SceneCluxels& all = state_.scene.cluxels;
    if (which == PairMeasure::VerticalGap)
      return std::max({0.0, a.shape.min.z() - b.shape.max.z(), b.shape.min.z() - a.shape.max.z()});
    if (which == PairMeasure::AxisDistance) {
      const Eigen::Vector3d between = a.shape.centroid - b.shape.centroid;
      if (b.shape.axis.z() <= 0.7) return between.head<2>().norm();
      return (between - b.shape.axis * (between.z() / b.shape.axis.z())).head<2>().norm();
    }
    const auto mine = state_.fragments.cluxelsOf(a), theirs = state_.fragments.cluxelsOf(b);
    if (which == PairMeasure::AdjacentFraction) {
      double outward = 0, to_b = 0;
      for (std::uint32_t cluxel : mine)
        for (std::uint32_t neighbour : all.neighbours(cluxel)) {
          if (std::binary_search(mine.begin(), mine.end(), neighbour)) continue;
          ++outward;
          to_b += std::binary_search(theirs.begin(), theirs.end(), neighbour) ? 1 : 0;
        }
      return outward == 0 ? 0 : to_b / outward;
    }
    double best = 1e300;
    for (std::uint32_t i : mine)
      for (std::uint32_t j : theirs) {
        const Eigen::Vector3d apart =
            ((all.center[i] - all.center[j]).cwiseAbs() - (all.extent[i] + all.extent[j]).cast<double>() / 2)
                .cwiseMax(0);
        best = std::min(best, which == PairMeasure::HorizontalGap ? apart.head<2>().norm() : apart.norm());
      }
    return best;
  }

  const ReasoningState& state_;
  const Bindings& bindings_;
};

}  // namespace cluxel::testing
