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

/// Whether tiles for which `is_beyond` holds lie within reach of cells at the place.
template <typename IsBeyond>
bool isNearTile(const Eigen::Vector3d& place, const IsBeyond& is_beyond) {
  constexpr double kReach_m = kNearCells_m + 0.01;
  for (const double x : {-kReach_m, 0.0, kReach_m})
    for (const double y : {-kReach_m, 0.0, kReach_m})
      if (is_beyond(perception::tileOf(place + Eigen::Vector3d(x, y, 0)))) return true;
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

/// Changed cells, each near another one of its group.
std::vector<ChangeGroup> hangingTogether(const std::vector<PointCell>& cells, const CellNeighbours& neighbours) {
  std::vector<bool> is_left(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) is_left[i] = stateOf(cells[i]) == ChangeState::Changed;
  std::vector<ChangeGroup> groups;
  for (std::uint32_t start = 0; start < cells.size(); ++start) {
    if (!is_left[start]) continue;
    is_left[start] = false;
    ChangeGroup& group = groups.emplace_back(ChangeGroup{start});
    for (std::size_t next = 0; next < group.size(); ++next)
      neighbours.forEach(group[next], [&](std::uint32_t other) {
        if (!is_left[other]) return;
        is_left[other] = false;
        group.push_back(other);
      });
  }
  return groups;
}

/// Cells from which something may follow.
std::vector<bool> mattering(const std::vector<PointCell>& cells) {
  std::vector<bool> matters(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) matters[i] = cells[i].is_of_changed_cluxel;
  for (const ChangeGroup& group : possibleParts(cells))
    for (const std::uint32_t cell : group) matters[cell] = true;
  return matters;
}

std::vector<PointCell> chosen(const std::vector<PointCell>& cells, const std::vector<bool>& is_chosen) {
  std::vector<PointCell> some;
  some.reserve(static_cast<std::size_t>(std::count(is_chosen.begin(), is_chosen.end(), true)));
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (is_chosen[i]) some.push_back(cells[i]);
  return some;
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

void KeptCells::add(const mapping::MapRegion& region, std::vector<PointCell> cells, const perception::TileSet& unread) {
  std::vector<bool> is_kept = changedOrNear(cells);
  const auto is_outside = [&](const perception::TileKey& tile) { return !region.tiles.contains(tile); };
  for (std::size_t i = 0; i < cells.size(); ++i) is_kept[i] = is_kept[i] || isNearTile(cells[i].place, is_outside);
  const std::vector<PointCell> kept = chosen(std::exchange(cells, {}), is_kept);
  open_.insert(open_.end(), kept.begin(), kept.end());
  settle(unread);
}

/// What hangs together is decided when all cells near it were read: then the groups in it are known.
void KeptCells::settle(const perception::TileSet& unread) {
  const CellNeighbours neighbours(open_);
  const std::vector<bool> matters = mattering(open_);
  const auto is_unread = [&](const perception::TileKey& tile) { return unread.contains(tile); };
  std::vector<bool> stays(open_.size()), settles(open_.size());
  for (std::size_t i = 0; i < open_.size(); ++i) stays[i] = isNearTile(open_[i].place, is_unread);
  for (const ChangeGroup& group : hangingTogether(open_, neighbours)) {
    const bool is_open = std::any_of(group.begin(), group.end(), [&](std::uint32_t cell) { return stays[cell]; });
    const bool is_kept = std::any_of(group.begin(), group.end(), [&](std::uint32_t cell) { return matters[cell]; });
    if (!is_open && !is_kept) continue;
    std::vector<bool>& marked = is_open ? stays : settles;
    for (const std::uint32_t cell : group) neighbours.forEach(cell, [&](std::uint32_t near) { marked[near] = true; });
  }
  settled_.push_back(chosen(open_, settles));
  open_ = chosen(open_, stays);
}

std::vector<PointCell> KeptCells::take() {
  std::size_t count = 0;
  for (const auto& of_region : settled_) count += of_region.size();
  std::vector<PointCell> all;
  all.reserve(count);
  for (auto& of_region : settled_) {
    all.insert(all.end(), of_region.begin(), of_region.end());
    of_region = {};
  }
  settled_ = {};
  std::sort(all.begin(), all.end(), [](const PointCell& a, const PointCell& b) { return a.key < b.key; });
  const auto is_same = [](const PointCell& a, const PointCell& b) { return a.key == b.key; };
  all.erase(std::unique(all.begin(), all.end(), is_same), all.end());
  return all;
}

}  // namespace cluxel::tasks
