// SPDX-License-Identifier: Apache-2.0
// The points of all clouds with what the map says about them: memory follows a region and a cloud, not the map.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "mapping/map_reader.hpp"

namespace cluxel::mapping {

/// A region of so many cluxels, with its points, takes some 150 MB.
inline constexpr std::size_t kAnsweredCluxels = 200'000;

/// The arrays of the answers are parallel to the points.
using AnsweredVisit = std::function<void(const Cloud&, const scan::ScanPoints&, const PointAnswers&)>;

/// Visits all clouds in the order of MapReader::clouds(), with the answers of MapReader::answersFor(). A map of more
/// than `max_cluxels` is read region by region; the answers wait in a temporary file, 13 bytes a point, until their
/// cloud is complete. Throws Error (StoreUnavailable) for a damaged map, and when there is no room for that file. Cost:
/// about 0.3 us a point.
void forEachAnsweredCloud(const MapReader& map, const AnsweredVisit& visit, std::size_t max_cluxels = kAnsweredCluxels);
/// The same of these clouds of the map, in their order.
void forEachAnsweredCloud(const MapReader& map, std::vector<Cloud> clouds, const AnsweredVisit& visit,
                          std::size_t max_cluxels = kAnsweredCluxels);

}  // namespace cluxel::mapping
