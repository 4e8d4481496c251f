// SPDX-License-Identifier: Apache-2.0
// The measured points of what vanished and appeared, for maps without them.
#pragma once

#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include "tasks/changes/site_changes.hpp"

namespace cluxel::tasks {

/// A point of a thing that is not there all the time.
struct ChangedPoint {
  scan::ScanId cloud;
  std::uint32_t point = 0;   ///< number in the cloud
  std::uint32_t change = 0;  ///< in SiteChanges::changes
  bool is_gone = false;      ///< measured before the thing vanished; else after it appeared
};

/// The points that scans measured on the changed things while these were there, by cloud and number: those in the
/// cluxels of a thing, and within 0.1 m of its box. Of clouds with a time and a pose. Cost: the regions of the map in
/// which something changed, and for each the points of the clouds that reach it.
std::vector<ChangedPoint> changedPoints(const mapping::MapReader& map, const SiteChanges& changes,
                                        std::size_t max_cluxels = kRegionCluxels);

/// Writes them as CSV: `cloud,source,point,change,kind`.
void writeChangedPoints(const std::vector<ChangedPoint>& points, const std::vector<mapping::Cloud>& clouds,
                        const std::function<void(std::string_view)>& write);

}  // namespace cluxel::tasks
