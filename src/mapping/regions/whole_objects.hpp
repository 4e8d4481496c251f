// SPDX-License-Identifier: Apache-2.0
// Some objects of a map with their cluxels: memory follows the objects of a region, not the map.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "mapping/map_reader.hpp"

namespace cluxel::mapping {

/// An object whose parts hold numbers in `cluxels`, and no primitives.
struct WholeObject {
  std::uint32_t number = 0;  ///< in MapReader::objects()
  rules::SemanticObject object;
  const perception::SceneCluxels& cluxels;
};

/// Visits the objects whose number is marked, each once, in no order that means anything. Their cluxels come in the
/// order of MapReader::scene(), so sums over them have the same bits. Objects that begin in the same region, of at most
/// `max_cluxels` or one tile, are in memory together with all of their tiles. Throws Error (StoreUnavailable) for a
/// damaged map. Cost: about 0.3 us a cluxel of the tiles with such objects.
void forEachWholeObject(const MapReader& map, const std::vector<bool>& is_wanted,
                        const std::function<void(const WholeObject&)>& visit, std::size_t max_cluxels = 50'000);

}  // namespace cluxel::mapping
