// SPDX-License-Identifier: Apache-2.0
// Things that stood side by side and changed together: bicycles in a rack are thin, and touch at the handlebars.
#pragma once

#include <vector>

#include "tasks/changes/change_groups.hpp"
#include "tasks/changes/point_cells.hpp"

namespace cluxel::tasks {

/// Splits a group into thin upright sheets that stand side by side. The group is cut into slices of 0.1 m across the
/// direction in which its cells crowd most into few slices. A slice weighs as much as it has cells, plus half of those
/// of the slices beside it. A sheet lies where no slice within 0.2 m weighs more, if that is 15 % of the most, and the
/// cells in the slice and beside it are 12 or more, over 0.6 m in length and 0.5 m in height. Between two sheets lies a
/// slice with at most 12 % of the weight of the lighter one, else only the heavier counts, so that a box with its
/// front, rear and sides stays whole. The group falls apart when there are several sheets, 0.4 to 0.8 m from each
/// other, so that the wheels of a bicycle are none; when 70 % of the cells lie in a sheet or a slice beside it; and
/// when the smallest has a fifth or more of the cells of the largest. Each cell goes to the nearest sheet. Foliage is
/// not split, as rays reach only the outside of a hedge. Else the group as it is.
std::vector<ChangeGroup> sheetsOf(const std::vector<PointCell>& cells, const ChangeGroup& group);

}  // namespace cluxel::tasks
