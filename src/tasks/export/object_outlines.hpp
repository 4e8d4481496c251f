// SPDX-License-Identifier: Apache-2.0
// Where objects lie, object by object: memory follows one tile and one object, not the map.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "base/sorting/sorted_records.hpp"
#include "mapping/facts/object_geometry.hpp"
#include "mapping/map_reader.hpp"

namespace cluxel::tasks {

/// Both hulls are given as points that they are the hulls of.
struct ObjectOutline {
  /// Of the cluxels' boxes seen from above, each wider by 5 mm, so that an object of one point has an area [m, map].
  std::vector<Eigen::Vector2d> footprint;
  mapping::ExtentSums extent;  ///< only its `min`, `max` and `corners` are set
};

using OutlineVisit = std::function<void(std::uint32_t object, const ObjectOutline&)>;

/// Visits the objects in the order of MapReader::objects(). Reads one tile after the other; what they tell of objects
/// is sorted by object, in a temporary file where it takes more than `bytes_in_memory`. Throws Error (StoreUnavailable)
/// for a damaged map, and when there is no room for that file. Cost: about 1 us a cluxel.
void forEachOutline(const mapping::MapReader& map, const OutlineVisit& visit,
                    std::size_t bytes_in_memory = SortedRecords::kUsualBytes);

}  // namespace cluxel::tasks
