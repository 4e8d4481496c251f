// SPDX-License-Identifier: Apache-2.0
// What lies at the border of a region may be near a change of the next one.
#include "tasks/changes/kept_changes.hpp"

#include <algorithm>
#include <utility>

#include "tasks/changes/changed_parts.hpp"

namespace cluxel::tasks {

namespace {

bool hasChanged(CluxelChange change) {
  return change == CluxelChange::Vanished || change == CluxelChange::Appeared;
}

/// Whether tiles outside of the region lie within reach of cells at the place.
bool isNearBorder(const mapping::MapRegion& region, const Eigen::Vector3d& place) {
  constexpr double kReach_m = kNearCells_m + 0.01;
  for (const double x : {-kReach_m, 0.0, kReach_m})
    for (const double y : {-kReach_m, 0.0, kReach_m})
      if (!region.tiles.contains(perception::tileOf(place + Eigen::Vector3d(x, y, 0)))) return true;
  return false;
}

std::vector<bool> changedOrNear(const std::vector<PointCell>& cells) {
  const CellNeighbours neighbours(cells);
  std::vector<bool> is_kept(cells.size(), false);
  for (std::uint32_t i = 0; i < cells.size(); ++i)
    if (stateOf(cells[i]) == ChangeState::Changed)
      neighbours.forEach(i, [&](std::uint32_t other) { is_kept[other] = true; });
  return is_kept;
}

}  // namespace

void KeptCluxels::add(const mapping::MapRegion& region, const std::vector<CluxelChange>& changes,
                      const std::vector<bool>& is_told) {
  const perception::SceneCluxels& cluxels = region.scene.cluxels;
  for (std::uint32_t i = 0; i < cluxels.size(); ++i) {
    if (!region.is_own[i]) continue;
    const auto neighbours = cluxels.neighbours(i);
    const auto may_matter = [&](std::uint32_t other) { return !region.is_own[other] || hasChanged(changes[other]); };
    if (!hasChanged(changes[i]) && std::none_of(neighbours.begin(), neighbours.end(), may_matter)) continue;
    Kept kept{region.number[i],  region.object[i],      changes[i],        is_told[i],
              cluxels.center[i], cluxels.low_corner[i], cluxels.extent[i], {}};
    if (hasChanged(changes[i]))
      for (const std::uint32_t other : neighbours) kept.neighbours.push_back(region.number[other]);
    kept_.push_back(std::move(kept));
  }
}

ChangedCluxels KeptCluxels::take() {
  std::vector<std::uint32_t> wanted;
  for (const Kept& kept : kept_) {
    if (!hasChanged(kept.change)) continue;
    wanted.push_back(kept.number);
    wanted.insert(wanted.end(), kept.neighbours.begin(), kept.neighbours.end());
  }
  std::sort(wanted.begin(), wanted.end());
  wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
  std::erase_if(kept_,
                [&](const Kept& kept) { return !std::binary_search(wanted.begin(), wanted.end(), kept.number); });
  std::sort(kept_.begin(), kept_.end(), [](const Kept& a, const Kept& b) { return a.number < b.number; });
  ChangedCluxels all;
  all.number = std::move(wanted);
  all.cluxels.name.resize(kept_.size()), all.before.resize(kept_.size()), all.after.resize(kept_.size());
  all.cluxels.edge_offset.push_back(0);
  for (const Kept& kept : kept_) {
    all.object.push_back(kept.object), all.changes.push_back(kept.change), all.is_told.push_back(kept.is_told);
    all.cluxels.center.push_back(kept.center), all.cluxels.low_corner.push_back(kept.low_corner);
    all.cluxels.extent.push_back(kept.extent);
    for (const std::uint32_t other : kept.neighbours)
      all.cluxels.edge_target.push_back(static_cast<std::uint32_t>(
          std::lower_bound(all.number.begin(), all.number.end(), other) - all.number.begin()));
    all.cluxels.edge_offset.push_back(static_cast<std::uint32_t>(all.cluxels.edge_target.size()));
  }
  kept_ = {};
  return all;
}

void keepCells(const mapping::MapRegion& region, std::vector<PointCell> cells, std::vector<PointCell>& kept) {
  const std::vector<bool> is_kept = changedOrNear(cells);
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (is_kept[i] || isNearBorder(region, cells[i].place)) kept.push_back(std::move(cells[i]));
}

std::vector<PointCell> nearChanges(std::vector<PointCell> cells) {
  std::sort(cells.begin(), cells.end(), [](const PointCell& a, const PointCell& b) { return a.key < b.key; });
  const std::vector<bool> is_kept = changedOrNear(cells);
  std::vector<PointCell> near;
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (is_kept[i]) near.push_back(std::move(cells[i]));
  return near;
}

}  // namespace cluxel::tasks
