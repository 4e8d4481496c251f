// SPDX-License-Identifier: Apache-2.0
// Copies the kept rows of each array and numbers what refers to them anew.
#include "perception/segments/scene_part.hpp"

#include <algorithm>

namespace cluxel::perception {

namespace {

constexpr std::uint32_t kNotKept = 0xFFFFFFFFU;

/// The new number of each old one.
std::vector<std::uint32_t> numbersOf(std::span<const std::uint32_t> kept, std::size_t count) {
  std::vector<std::uint32_t> number(count, kNotKept);
  for (std::size_t i = 0; i < kept.size(); ++i) number[kept[i]] = static_cast<std::uint32_t>(i);
  return number;
}

template <typename Value>
std::vector<Value> rowsOf(const std::vector<Value>& all, std::span<const std::uint32_t> kept) {
  std::vector<Value> rows;
  rows.reserve(kept.size());
  for (const std::uint32_t i : kept) rows.push_back(all[i]);
  return rows;
}

SceneCluxels cluxelsOf(const SceneCluxels& all, std::span<const std::uint32_t> kept,
                       const std::vector<std::uint32_t>& number, const std::vector<std::uint32_t>& primitive) {
  SceneCluxels part;
  part.grid = all.grid;
  part.scans = all.scans;
  part.name = rowsOf(all.name, kept), part.seed = rowsOf(all.seed, kept);
  part.center = rowsOf(all.center, kept), part.extent = rowsOf(all.extent, kept);
  part.low_corner = rowsOf(all.low_corner, kept), part.point_count = rowsOf(all.point_count, kept);
  part.label = rowsOf(all.label, kept), part.probability = rowsOf(all.probability, kept);
  part.height_above_ground = rowsOf(all.height_above_ground, kept);
  part.edge_offset.push_back(0);
  for (const std::uint32_t i : kept) {
    part.primitive.push_back(primitive[all.primitive[i]]);
    for (const std::uint32_t neighbour : all.neighbours(i))
      if (number[neighbour] != kNotKept) part.edge_target.push_back(number[neighbour]);
    part.edge_offset.push_back(static_cast<std::uint32_t>(part.edge_target.size()));
  }
  return part;
}

}  // namespace

Scene partOf(const Scene& scene, std::span<const PrimitiveIndex> kept) {
  std::vector<std::uint32_t> cluxels;
  for (const PrimitiveIndex primitive : kept) {
    const std::vector<std::uint32_t>& own = scene.primitives[primitive].cluxels;
    cluxels.insert(cluxels.end(), own.begin(), own.end());
  }
  std::sort(cluxels.begin(), cluxels.end());
  const std::vector<std::uint32_t> cluxel_number = numbersOf(cluxels, scene.cluxels.size());
  const std::vector<std::uint32_t> primitive_number = numbersOf(kept, scene.primitives.size());
  Scene part;
  part.views = scene.views;
  part.cluxels = cluxelsOf(scene.cluxels, cluxels, cluxel_number, primitive_number);
  for (const PrimitiveIndex primitive : kept) {
    Primitive& copy = part.primitives.emplace_back(scene.primitives[primitive]);
    for (std::uint32_t& cluxel : copy.cluxels) cluxel = cluxel_number[cluxel];
    for (Relation relation : scene.relationsOf(primitive)) {
      relation.from = primitive_number[relation.from];
      relation.to = primitive_number[relation.to];
      if (relation.to != kNotKept) part.relations.push_back(relation);
    }
  }
  indexRelations(part);
  return part;
}

}  // namespace cluxel::perception
