// SPDX-License-Identifier: Apache-2.0
// The table of relations, and their index by primitive.
#include "perception/segments/scene.hpp"

#include <algorithm>

namespace cluxel::perception {

const std::array<RelationInfo, kRelationKindCount>& relationInfos() {
  using R = RelationKind;
  static const std::array<RelationInfo, kRelationKindCount> infos{{
      {R::Intersects, "intersects", "intersects", "an edge of the cluxel graph joins them; measure: gap"},
      {R::Touches, "touches", "touches", "the gap between their points is at most 0.20 m; measure: gap"},
      {R::TouchesGround, "touches_ground", "touchesGround",
       "its lowest point is near the local ground (in RDF: at most 0.30 m above it); measure: that height"},
      {R::Above, "above", "above",
       "where their footprints of 0.25 m cells meet, its points lie more than 0.25 m higher in the mean; measure: that "
       "height difference"},
      {R::Below, "below", "below", "the other is above it; measure: the height difference"},
      {R::Supports, "supports", "supports", "the other stands on it; measure: gap"},
      {R::StandsOn, "stands_on", "standsOn",
       "above, with a gap of at most 0.30 m, and its lowest point is higher than the other's centroid; measure: gap"},
      {R::Inside, "inside", "inside", "at least 0.9 of its axis-parallel box lies in the other's; measure: that share"},
      {R::Near, "near", "near", "the gap between their points is at most 1.0 m; measure: gap"},
      {R::ParallelTo, "parallel_to", "parallelTo",
       "both are walls or both are poles, near, with directions at most 10 deg apart; measure: angle"},
      {R::Alongside, "alongside", "alongside",
       "near, both at least 2 m long, and at least half of the shorter lies beside the longer; measure: gap"},
  }};
  return infos;
}

std::optional<RelationKind> relationKindOf(std::string_view name) {
  for (const RelationInfo& info : relationInfos())
    if (info.name == name) return info.kind;
  return std::nullopt;
}

void indexRelations(Scene& scene) {
  auto byFrom = [](const Relation& a, const Relation& b) {
    if (a.from != b.from) return a.from < b.from;
    if (a.kind != b.kind) return a.kind < b.kind;
    if (a.to != b.to) return a.to < b.to;
    return a.measure < b.measure;
  };
  std::sort(scene.relations.begin(), scene.relations.end(), byFrom);
  scene.relation_offset.assign(scene.primitives.size() + 1, 0);
  for (const Relation& relation : scene.relations) ++scene.relation_offset[relation.from + 1];
  for (std::size_t i = 1; i < scene.relation_offset.size(); ++i)
    scene.relation_offset[i] += scene.relation_offset[i - 1];
}

}  // namespace cluxel::perception
