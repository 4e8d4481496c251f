// SPDX-License-Identifier: Apache-2.0
// Gaps through the grid, adjacency through the cluxel graph, relations as the scene stores them.
#include "rules/propose/pair_measures.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cluxel::rules {

namespace {

/// Bounds of whole primitives may be tighter than their cluxels' boxes by less than this [m].
constexpr double kBoundsMargin_m = 1.0;
constexpr double kRounding_m = 1e-6;                                // gaps are computed from extents that are floats
constexpr double kTouchTolerance_m = 0.20, kNearTolerance_m = 1.0;  // of relationInfos()

bool contains(const Candidate& candidate, FragmentIndex fragment) {
  return std::binary_search(candidate.fragments.begin(), candidate.fragments.end(), fragment);
}

double boundsGap(const Candidate& a, const Candidate& b, bool horizontal) {
  Eigen::Vector3d apart = (a.shape.min - b.shape.max).cwiseMax(b.shape.min - a.shape.max).cwiseMax(0);
  if (horizontal) apart.z() = 0;
  return apart.norm();
}

/// The box around the boxes of a candidate's cluxels.
Eigen::AlignedBox3d boundsOf(const ReasoningState& state, const Candidate& candidate) {
  Eigen::AlignedBox3d box;
  for (const FragmentIndex fragment : candidate.fragments) {
    const Outline& outline = state.fragments.outlineOf(fragment);
    box.extend(outline.min);
    box.extend(outline.max);
  }
  return box;
}

/// Whether the gap between what is within two boxes is surely larger than `distance_m`.
bool areBeyond(const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b, bool horizontal, double distance_m) {
  Eigen::Vector3d apart = (a.min() - b.max()).cwiseMax(b.min() - a.max()).cwiseMax(0);
  if (horizontal) apart.z() = 0;
  return apart.squaredNorm() > (distance_m + kRounding_m) * (distance_m + kRounding_m);
}

/// Smallest gap between cluxels. The search radius grows step by step because most pairs are close.
double smallestGap(const ReasoningState& state, const Candidate& a, const Candidate& b, bool horizontal,
                   double limit_m) {
  const bool swap = b.shape[perception::Attribute::CluxelCount] < a.shape[perception::Attribute::CluxelCount];
  const Candidate& few = swap ? b : a;
  const Candidate& many = swap ? a : b;
  const double farthest = std::min(limit_m, kMaxMeasure_m);
  const Eigen::AlignedBox3d bounds = boundsOf(state, many);
  if (areBeyond(boundsOf(state, few), bounds, horizontal, farthest)) return std::numeric_limits<double>::infinity();
  const std::vector<std::uint32_t> cluxels = state.fragments.cluxelsOf(few);
  auto last = static_cast<FragmentIndex>(state.fragments.size());  // many cluxels of a cell are of one fragment
  bool is_of_many = false;
  for (double reach = std::min(1.0, farthest);; reach = std::min(reach * 4, farthest)) {
    double best = std::numeric_limits<double>::infinity();
    for (const std::uint32_t cluxel : cluxels) {
      const Eigen::AlignedBox3d box = boxAround(state.scene.cluxels, std::span(&cluxel, 1));
      if (areBeyond(box, bounds, horizontal, std::min(reach, best))) continue;
      const auto look = [&](std::uint32_t other) {
        const FragmentIndex fragment = state.fragments.fragmentOf(other);
        if (std::exchange(last, fragment) != fragment) is_of_many = contains(many, fragment);
        if (!is_of_many) return;
        const CluxelGap gap = gapBetween(state.scene.cluxels, cluxel, other);
        best = std::min(best, horizontal ? gap.horizontal : gap.gap());
      };
      if (horizontal)
        state.grid.nearInPlan(cluxel, std::min(reach, best), look);
      else
        state.grid.near(cluxel, std::min(reach, best), look);
      if (best == 0) return best;
    }
    if (best <= reach) return best;
    if (reach >= farthest) return std::numeric_limits<double>::infinity();
  }
}

double adjacentShare(const ReasoningState& state, const Candidate& a, const Candidate& b) {
  std::size_t outward = 0, to_b = 0;
  for (FragmentIndex fragment : a.fragments)
    for (std::uint32_t cluxel : state.fragments[fragment].cluxels)
      for (std::uint32_t neighbour : state.scene.cluxels.neighbours(cluxel)) {
        const FragmentIndex other = state.fragments.fragmentOf(neighbour);
        if (contains(a, other)) continue;
        ++outward;
        to_b += contains(b, other) ? 1 : 0;
      }
  return outward == 0 ? 0 : static_cast<double>(to_b) / static_cast<double>(outward);
}

/// Distance in plan view between the subject's centroid and the axis line of the pole at the centroid's height. An axis
/// tilted by more than 45 deg counts as vertical.
double axisDistance(const Shape& subject, const Shape& pole) {
  Eigen::Vector3d at = pole.centroid;
  if (pole.axis.z() > 0.7) at += pole.axis * ((subject.centroid.z() - at.z()) / pole.axis.z());
  return (subject.centroid - at).head<2>().norm();
}

bool plansOverlap(const Shape& a, const Shape& b) {
  constexpr double kWiden_m = 0.25;
  return a.min.x() <= b.max.x() + kWiden_m && b.min.x() <= a.max.x() + kWiden_m && a.min.y() <= b.max.y() + kWiden_m &&
         b.min.y() <= a.max.y() + kWiden_m;
}

std::optional<double> withinPrimitive(const ReasoningState& state, perception::RelationKind kind, const Candidate& a,
                                      const Candidate& b) {
  const double vertical = std::max({0.0, a.shape.min.z() - b.shape.max.z(), b.shape.min.z() - a.shape.max.z()});
  const bool above = a.shape.centroid.z() > b.shape.centroid.z();
  switch (kind) {
    case perception::RelationKind::Intersects:
      return adjacentShare(state, a, b) > 0 ? std::optional(0.0) : std::nullopt;
    case perception::RelationKind::Touches:
    case perception::RelationKind::Near: {
      const double limit = kind == perception::RelationKind::Touches ? kTouchTolerance_m : kNearTolerance_m;
      const double gap = smallestGap(state, a, b, false, limit);
      return gap <= limit ? std::optional(gap) : std::nullopt;
    }
    case perception::RelationKind::Above:
    case perception::RelationKind::StandsOn:
      return above && plansOverlap(a.shape, b.shape) ? std::optional(vertical) : std::nullopt;
    case perception::RelationKind::Below:
    case perception::RelationKind::Supports:
      return !above && plansOverlap(a.shape, b.shape) ? std::optional(vertical) : std::nullopt;
    default:
      return std::nullopt;
  }
}

bool sharePrimitive(const ReasoningState& state, const Candidate& a, const Candidate& b) {
  for (FragmentIndex mine : a.fragments)
    for (FragmentIndex theirs : b.fragments)
      if (state.fragments[mine].primitive == state.fragments[theirs].primitive) return true;
  return false;
}

}  // namespace

double measurePair(const ReasoningState& state, PairMeasure measure, const Candidate& a, const Candidate& b,
                   double limit_m) {
  switch (measure) {
    case PairMeasure::AdjacentFraction:
      return adjacentShare(state, a, b);
    case PairMeasure::AxisDistance:
      return axisDistance(a.shape, b.shape);
    case PairMeasure::VerticalGap:
      return std::max({0.0, a.shape.min.z() - b.shape.max.z(), b.shape.min.z() - a.shape.max.z()});
    case PairMeasure::Gap:
    case PairMeasure::HorizontalGap:
      break;
  }
  const bool horizontal = measure == PairMeasure::HorizontalGap;
  // The bounding boxes reject most pairs.
  if (boundsGap(a, b, horizontal) > limit_m + kBoundsMargin_m) return std::numeric_limits<double>::infinity();
  return smallestGap(state, a, b, horizontal, limit_m);
}

std::optional<double> relationMeasure(const ReasoningState& state, perception::RelationKind kind, const Candidate& a,
                                      const Candidate& b) {
  std::optional<double> best;
  auto take = [&](double measure) { best = best ? std::min(*best, measure) : measure; };
  for (const auto& [fragment, measure] : relatedFragments(state, kind, a))
    if (contains(b, fragment)) take(measure);
  if (!best && sharePrimitive(state, a, b)) return withinPrimitive(state, kind, a, b);
  return best;
}

std::vector<std::pair<FragmentIndex, double>> relatedFragments(const ReasoningState& state,
                                                               perception::RelationKind kind, const Candidate& a) {
  std::vector<std::pair<FragmentIndex, double>> related;
  for (FragmentIndex mine : a.fragments)
    for (const perception::Relation& relation : state.scene.relationsOf(state.fragments[mine].primitive)) {
      if (relation.kind != kind) continue;
      for (FragmentIndex other : state.fragments.fragmentsOf(relation.to))
        if (!contains(a, other)) related.emplace_back(other, relation.measure);
    }
  return related;
}

}  // namespace cluxel::rules
