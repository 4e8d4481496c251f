// SPDX-License-Identifier: Apache-2.0
// Truth about changes between visits, and about what each visit could measure.
#pragma once

#include <filesystem>

#include "simulation/site/site_visits.hpp"

namespace cluxel::simulation {

/// Writes two tables. Both tell of how many points the visit measures on a thing, or would if it stood there: rays that
/// meet nothing before it and return from it or from behind it. Of a bush that was cut, what is left of it counts.
/// Ground and buildings are left out.
///   events.csv: an event a line: visit, kind, class, instances, the box of what is gone and of what is new, and points
///   in these boxes on the visit before and on that visit; what is cut off counts in both as it was before;
///   visits.csv: an object and visit a line: whether it is there, and the points.
void writeVisitTruth(const VisitedSite& site, const std::filesystem::path& folder, unsigned threads);

}  // namespace cluxel::simulation
