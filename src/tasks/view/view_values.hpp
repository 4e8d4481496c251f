// SPDX-License-Identifier: Apache-2.0
// What the page needs of a map besides points and quads, as JSON.
#pragma once

#include <string>

#include "mapping/map_reader.hpp"
#include "tasks/query_source.hpp"
#include "tasks/view/point_tiles.hpp"
#include "tasks/view/view_page.hpp"

namespace cluxel::tasks {

/// The map: name, frame, clouds with sensor positions, tiles of points, shipped questions, tasks, rule
/// files, visits, units of properties.
std::string mapValuesJson(const mapping::MapReader& map, const PointTiles& tiles, std::uint64_t quads_left_out,
                          const ViewOptions& options, const std::vector<Question>& questions);

/// changesJson() for the begin of each visit but the first, as an array.
std::string visitChangesJson(const mapping::MapReader& map, unsigned threads);

/// The objects that each object was derived from, as the history states it, by number of the object. Objects that no
/// change touched are absent.
std::string lineageJson(const mapping::MapReader& map);

/// Classes, and the objects in the order of MapReader::objects(): arrays side by side. A box is its centre, length,
/// width, height [m, map] and the angle of its length [rad].
std::string objectValuesJson(const mapping::MapReader& map);

}  // namespace cluxel::tasks
