// SPDX-License-Identifier: Apache-2.0
// Stable sorts by the place of a tile on the curve: what lies in one tile keeps its order.
#include "mapping/facts/fact_order.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>

#include "perception/tile.hpp"

namespace cluxel::mapping {

namespace {

std::uint64_t placeOf(const perception::Scene& scene, const perception::Primitive& primitive) {
  return perception::mortonCode(scene.cluxels.grid.tileOf(primitive.centroid));
}

std::uint64_t placeOf(const perception::Scene& scene, const rules::SemanticObject& object) {
  std::uint64_t first = std::numeric_limits<std::uint64_t>::max();
  for (const rules::ObjectPart& part : object.parts)
    for (const perception::PrimitiveIndex primitive : part.primitives)
      first = std::min(first, placeOf(scene, scene.primitives[primitive]));
  return first;
}

/// The numbers of places in the order of places, equal ones as they stand.
template <typename Number>
std::vector<Number> ascending(const std::vector<std::uint64_t>& places) {
  std::vector<Number> numbers(places.size());
  std::iota(numbers.begin(), numbers.end(), Number{0});
  std::stable_sort(numbers.begin(), numbers.end(), [&](Number a, Number b) { return places[a] < places[b]; });
  return numbers;
}

}  // namespace

std::vector<perception::PrimitiveIndex> primitivesByPlace(const perception::Scene& scene) {
  std::vector<std::uint64_t> places;
  for (const perception::Primitive& primitive : scene.primitives) places.push_back(placeOf(scene, primitive));
  return ascending<perception::PrimitiveIndex>(places);
}

std::vector<std::size_t> objectsByPlace(const perception::Scene& scene,
                                        std::span<const rules::SemanticObject> objects) {
  std::vector<std::uint64_t> places;
  for (const rules::SemanticObject& object : objects) places.push_back(placeOf(scene, object));
  return ascending<std::size_t>(places);
}

}  // namespace cluxel::mapping
