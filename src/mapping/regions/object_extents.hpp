// SPDX-License-Identifier: Apache-2.0
// How far the objects of a map reach, read tile by tile: no scene is needed.
#pragma once

#include <string>
#include <vector>

#include "mapping/facts/object_geometry.hpp"
#include "mapping/map_reader.hpp"

namespace cluxel::mapping {

/// Of a part of an object. All of `sums` but `weighted_centre` is set; `corners` has the hull of the part's cluxels.
struct PartExtents {
  std::string part_class;  ///< IRI, as ObjectPart::part_class
  ExtentSums sums;
};

/// By object in the order of MapReader::objects(): its parts, in the order of SemanticObject::parts. geometryOf() gives
/// of these, and of all parts together, the bits of the scene, but for the centroid. Throws Error (StoreUnavailable)
/// for a damaged map. Memory: 5 KB a tile, and about 1 KB an object. Cost: about 0.3 us a cluxel.
std::vector<std::vector<PartExtents>> extentsOfObjects(const MapReader& map);

}  // namespace cluxel::mapping
