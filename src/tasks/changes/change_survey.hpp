// SPDX-License-Identifier: Apache-2.0
// What points and rays tell of the scans before a time and of those from it on, region by region.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "mapping/map_reader.hpp"
#include "tasks/changes/changed_cluxels.hpp"
#include "tasks/changes/object_states.hpp"
#include "tasks/changes/point_cells.hpp"

namespace cluxel::tasks {

/// The cluxels that one region may hold, where single tiles hold fewer.
inline constexpr std::size_t kRegionCluxels = 100'000;

/// An object that was away at the end of one time, though scans of both times hit it: its cluxels tell no change.
struct ObjectBack {
  std::uint32_t object = 0;            ///< number in MapReader::objects()
  std::vector<std::uint32_t> cluxels;  ///< numbers in the scene of the map, ascending
  Eigen::AlignedBox3d box;             ///< [m, map]
};

struct ChangeSurvey {
  std::vector<ObjectStates> states;                  ///< of each object but ground, by number
  ChangedCluxels cluxels;                            ///< those of possible clusters, and all that intersect one of them
  std::array<std::vector<ChangeGroup>, 2> clusters;  ///< possible ones that vanished, and that appeared; in `cluxels`
  /// The cells of possible parts, those near them, and the changed ones of possible clusters. What rays of their own
  /// time found is known of those of possible parts.
  PointCells cells;
  std::array<std::vector<ChangeGroup>, 2> parts;          ///< possible ones before, and after; in `cells`
  std::array<std::vector<ObjectBack>, 2> back{};          ///< there at the end of before only, and of after only
  std::map<std::uint32_t, std::size_t> stable_of_object;  ///< cluxels that are there at both times, by object
};

/// Reads the map in regions of `max_cluxels`; the result does not depend on it. Memory: that of a region and of a scan,
/// and of what changed. Cost: the points and cluxels of the map; each region reads the scans that reach it.
ChangeSurvey surveyOf(const mapping::MapReader& map, double since_s, std::size_t max_cluxels, unsigned threads);

}  // namespace cluxel::tasks
