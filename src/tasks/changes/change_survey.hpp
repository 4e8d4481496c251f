// SPDX-License-Identifier: Apache-2.0
// What points and rays tell of the scans before a time and of those from it on, region by region.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <vector>

#include "mapping/map_reader.hpp"
#include "tasks/changes/changed_cluxels.hpp"
#include "tasks/changes/object_states.hpp"
#include "tasks/changes/point_cells.hpp"
#include "tasks/changes/visit_votes.hpp"

namespace cluxel::tasks {

/// The cluxels that one region may hold, where single tiles hold fewer.
inline constexpr std::size_t kRegionCluxels = 100'000;

/// An object whose states tell a change as a whole (changedAsWhole()), whatever its cluxels tell.
struct WholeObject {
  std::uint32_t object = 0;            ///< number in MapReader::objects()
  std::vector<std::uint32_t> cluxels;  ///< numbers in the scene of the map, ascending
  Eigen::AlignedBox3d box;             ///< [m, map]
  std::vector<std::uint32_t> visits;   ///< on which it was surely there, ascending
};

/// The times that are compared [s since 1970]: before, [from_s, since_s), and after, [since_s, until_s].
struct ComparedTimes {
  double since_s = 0;
  double from_s = -std::numeric_limits<double>::infinity(), until_s = std::numeric_limits<double>::infinity();

  /// Whether scans that come later than some time do not count.
  bool endsEarly() const { return until_s < std::numeric_limits<double>::infinity(); }
};

/// Without the clouds of other times.
std::vector<mapping::Cloud> cloudsWithin(std::vector<mapping::Cloud> clouds, const ComparedTimes& times);

struct ChangeSurvey {
  Visits visits;                                     ///< of the scans of both times
  std::vector<ObjectStates> states;                  ///< of each object but ground, by number
  ChangedCluxels cluxels;                            ///< those of possible clusters, and all that intersect one of them
  std::array<std::vector<ChangeGroup>, 2> clusters;  ///< possible ones that vanished, and that appeared; in `cluxels`
  /// The cells of possible parts, those near them, and the changed ones of possible clusters. What rays of their own
  /// time found is known of those of possible parts.
  PointCells cells;
  std::array<std::vector<ChangeGroup>, 2> parts;          ///< possible ones before, and after; in `cells`
  std::array<std::vector<WholeObject>, 2> wholes{};       ///< there at the end of before only, and of after only
  std::map<std::uint32_t, std::size_t> stable_of_object;  ///< cluxels that are there at both times, by object
};

/// Reads the map in regions of `max_cluxels`; the result does not depend on it. Memory: that of a region and of a scan,
/// and of what changed. Cost: the points and cluxels of the map; each region reads the scans that reach it.
ChangeSurvey surveyOf(const mapping::MapReader& map, const ComparedTimes& times, std::size_t max_cluxels,
                      unsigned threads);

}  // namespace cluxel::tasks
