// SPDX-License-Identifier: Apache-2.0
// Gaps through the grid, adjacency through the cluxel graph, relations as the scene stores them.
#include "reasoning/pair_measures.hpp"

#include <algorithm>
#include <cmath>

namespace cluxel {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kTouch_m = 0.20, kNear_m = 1.0;  // as relationInfos() says

bool contains(const Thing& thing, PieceIndex piece) {
  return std::binary_search(thing.pieces.begin(), thing.pieces.end(), piece);
}

double boundsGap(const Thing& a, const Thing& b, bool horizontal) {
  Eigen::Vector3d apart = (a.shape.min - b.shape.max).cwiseMax(b.shape.min - a.shape.max).cwiseMax(0);
  if (horizontal) apart.z() = 0;
  return apart.norm();
}

/// Smallest cluxel gap, by widening rings: most things that are asked about are close.
double smallestGap(const ReasoningState& state, const Thing& a, const Thing& b, bool horizontal, double limit_m) {
  const bool swap = b.shape[Attribute::CluxelCount] < a.shape[Attribute::CluxelCount];
  const Thing& few = swap ? b : a;
  const Thing& many = swap ? a : b;
  const std::vector<std::uint32_t> cluxels = state.pieces.cluxelsOf(few);
  const double farthest = std::min(limit_m, kFarthestMeasure_m);
  for (double reach = std::min(1.0, farthest);; reach = std::min(reach * 4, farthest)) {
    double best = kInfinity;
    for (std::uint32_t cluxel : cluxels)
      state.grid.near(cluxel, reach, [&](std::uint32_t other) {
        if (!contains(many, state.pieces.pieceOf(other))) return;
        const CluxelGap gap = gapBetween(state.scene.cluxels, cluxel, other);
        best = std::min(best, horizontal ? gap.horizontal : gap.gap());
      });
    if (best <= reach || reach >= farthest) return best;
  }
}

double adjacentShare(const ReasoningState& state, const Thing& a, const Thing& b) {
  std::size_t outward = 0, to_b = 0;
  for (PieceIndex piece : a.pieces)
    for (std::uint32_t cluxel : state.pieces[piece].cluxels)
      for (std::uint32_t neighbour : state.scene.cluxels.neighbours(cluxel)) {
        const PieceIndex other = state.pieces.pieceOf(neighbour);
        if (contains(a, other)) continue;
        ++outward;
        to_b += contains(b, other) ? 1 : 0;
      }
  return outward == 0 ? 0 : static_cast<double>(to_b) / static_cast<double>(outward);
}

/// Plan distance of a point from the line along `axis` through `foot`, at the point's height; a flat axis counts as
/// upright.
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

std::optional<double> withinPrimitive(const ReasoningState& state, RelationKind kind, const Thing& a, const Thing& b) {
  const double vertical = std::max({0.0, a.shape.min.z() - b.shape.max.z(), b.shape.min.z() - a.shape.max.z()});
  const bool above = a.shape.centroid.z() > b.shape.centroid.z();
  switch (kind) {
    case RelationKind::Intersects:
      return adjacentShare(state, a, b) > 0 ? std::optional(0.0) : std::nullopt;
    case RelationKind::Touches:
    case RelationKind::Near: {
      const double limit = kind == RelationKind::Touches ? kTouch_m : kNear_m;
      const double gap = smallestGap(state, a, b, false, limit);
      return gap <= limit ? std::optional(gap) : std::nullopt;
    }
    case RelationKind::Above:
    case RelationKind::StandsOn:
      return above && plansOverlap(a.shape, b.shape) ? std::optional(vertical) : std::nullopt;
    case RelationKind::Below:
    case RelationKind::Supports:
      return !above && plansOverlap(a.shape, b.shape) ? std::optional(vertical) : std::nullopt;
    default:
      return std::nullopt;
  }
}

bool sharePrimitive(const ReasoningState& state, const Thing& a, const Thing& b) {
  for (PieceIndex mine : a.pieces)
    for (PieceIndex theirs : b.pieces)
      if (state.pieces[mine].primitive == state.pieces[theirs].primitive) return true;
  return false;
}

}  // namespace

double measurePair(const ReasoningState& state, PairMeasure measure, const Thing& a, const Thing& b, double limit_m) {
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
  // The bounds decide most pairs; a whole primitive's bounds may be a little tighter than its cluxels' boxes.
  if (boundsGap(a, b, horizontal) > limit_m + 1.0) return kInfinity;
  return smallestGap(state, a, b, horizontal, limit_m);
}

std::optional<double> relationMeasure(const ReasoningState& state, RelationKind kind, const Thing& a, const Thing& b) {
  std::optional<double> best;
  auto take = [&](double measure) { best = best ? std::min(*best, measure) : measure; };
  for (const auto& [piece, measure] : relatedPieces(state, kind, a))
    if (contains(b, piece)) take(measure);
  if (!best && sharePrimitive(state, a, b)) return withinPrimitive(state, kind, a, b);
  return best;
}

std::vector<std::pair<PieceIndex, double>> relatedPieces(const ReasoningState& state, RelationKind kind,
                                                         const Thing& a) {
  std::vector<std::pair<PieceIndex, double>> related;
  for (PieceIndex mine : a.pieces)
    for (const Relation& relation : state.scene.relationsOf(state.pieces[mine].primitive)) {
      if (relation.kind != kind) continue;
      for (PieceIndex other : state.pieces.piecesOf(relation.to))
        if (!contains(a, other)) related.emplace_back(other, relation.measure);
    }
  return related;
}

}  // namespace cluxel
