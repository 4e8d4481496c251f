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
/// where most of the decided cells within 0.25 m are changed. A scan looked at a cell when it hit or passed it. With p
/// the share of hits of its own time, a look of the other time that passes adds log(0.95 / (1 - p)) to the log-odds of
/// "gone", one that hits log(0.05 / p). A group is kept when it has 12 cells or more, 60 % of the looks of its own time
/// hit it, at most 15 % of those of the other time do, three scans or more of the other time passed three cells of it
/// and twice as many as they hit, at most three rays near it ended before it for each four that passed, and it is
/// - a top: 16 cells or more that three scans measured, with log-odds of 80 or more; and of the decided cells in and
///   around it that lie at the height of its middle or higher, 95 % changed like it. Nothing stays at its height; or
/// - solid: mostly not of foliage; four scans measured it and four passed it; 70 % of the rays of its own time end
///   there, or 55 % when the log-odds are 100 or more and 70 % of the decided cells from its middle upwards changed; or
/// - gone as a whole: 20 cells or more that four scans measured; log-odds of 50 or more; at most 2 % of the looks of
///   the other time hit it, and 85 % of the decided cells in and around it changed like it. Two scans that passed are
///   enough for 40 cells of which 90 % changed; or
/// - clear: four scans measured it; log-odds of 150 or more, and 4.5 or more on average of its cells; 70 % of the looks
///   and half of the rays of its own time hit it, and at most 10 % of the looks of the other time do; or
/// - evident: four scans measured it; log-odds of 400 or more, and 3 or more on average. Rays pass through a bicycle
///   and a bush while they are there, but not all of them.
/// Where something stays at the height of a group that three scans or more passed, the group needs log-odds of 80 or
/// more, and 3 or more on average: what few looks miss beside something that stays is mostly an edge of it, seen with
/// poor poses or along its face. Some scans still hit a head that is gone, because the pole in it seems to stand
/// elsewhere. And rays find gaps in a crown that no ray of the other time found, so that foliage is never called solid.
std::vector<ChangeGroup> changedParts(const std::vector<PointCell>& cells);

/// Those of the possible parts that changedParts() keeps. `cells` need not hold more than these and what is near them.
std::vector<ChangeGroup> partsAmong(std::vector<ChangeGroup> possible, const std::vector<PointCell>& cells);

/// Groups that are kept if all looks and rays of their own time hit them, from the looks of the other time alone.
std::vector<ChangeGroup> possibleParts(const std::vector<PointCell>& cells);

}  // namespace cluxel::tasks
