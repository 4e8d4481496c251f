// SPDX-License-Identifier: Apache-2.0
// Things that stood side by side and changed together: bicycles in a rack are thin, and touch at the handlebars.
#pragma once

#include <vector>

#include "tasks/changes/change_groups.hpp"
#include "tasks/changes/point_cells.hpp"

namespace cluxel::tasks {

/// Splits a group into thin upright sheets that stand side by side. The group is cut into slices of 0.1 m across the
/// direction in which its cells crowd most into few slices. Slices with 30 % of the cells of the fullest, or more, make
/// sheets. The group falls apart when there are several sheets, with 0.2 to 1 m between them, each at most 0.3 m thick,
/// 1 m long or more (a wheel is shorter), and 0.5 m high or more; when at most 15 % of the cells lie farther than a
/// slice from all sheets, so that a box with its front and rear stays whole; and when the smallest has a fifth or more
/// of the cells of the largest. Each cell goes to the nearest sheet. Foliage is not split, as rays reach only the
/// outside of a hedge. Else the group as it is.
std::vector<ChangeGroup> sheetsOf(const std::vector<PointCell>& cells, const ChangeGroup& group);

}  // namespace cluxel::tasks
