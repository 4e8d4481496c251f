// SPDX-License-Identifier: Apache-2.0
// Parts of cluxels that vanished or appeared: the head of a lamp around whose place another pole runs.
#pragma once

#include <cstdint>
#include <vector>

#include "tasks/changes/change_groups.hpp"
#include "tasks/changes/point_cells.hpp"

namespace cluxel::tasks {

/// A cell is stable when it is there at the other time, too, and changed when more than twice as many scans of the
/// other time passed it as hit it.
ChangeState stateOf(const PointCell& cell);

/// Groups of cells that only the one time measured, and that rays of the other time pass: what vanished, when `cells`
/// are those before, and what appeared, when they are those after. Changed cells form a group with those within 0.25 m,
/// where most of the decided cells within 0.25 m are changed. A scan looked at a cell when it hit or passed it. A group
/// is kept when four scans or more measured it, three or more of the other time passed three cells of it and twice as
/// many as they hit, and it is
/// - solid: 12 cells or more, mostly not of foliage; 60 % of the looks of its own time hit it and 70 % of the rays end
///   there; of the looks of the other time at most 15 % hit, and four scans passed it; or
/// - gone as a whole: 20 cells or more; 60 % of the looks of its own time hit it, at most 2 % of those of the other
///   time do, and 85 % of the decided cells in and around it changed like it; or
/// - evident: 60 % of the looks of its own time hit it, at most 15 % of those of the other time do, and these add up to
///   log-odds of -400 or less, and -3 or less for each cell. With p the share of hits of its own time, a look that
///   passes adds log((1 - p) / 0.95), one that hits log(p / 0.05). Rays pass through a bicycle and a bush while they
///   are there, but not all of them.
/// The poses of scans are off: some of them still hit a head that is gone, because the pole in it seems to stand
/// elsewhere. And rays find gaps in a crown that no ray of the other time found, so that foliage is never called solid.
std::vector<ChangeGroup> changedParts(const std::vector<PointCell>& cells);

/// Groups that are kept if the looks of their own time allow it, from the looks of the other time alone.
std::vector<ChangeGroup> possibleParts(const std::vector<PointCell>& cells);

}  // namespace cluxel::tasks
