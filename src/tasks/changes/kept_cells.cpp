// SPDX-License-Identifier: Apache-2.0
// Changed cells that hang together are decided when all cells near them were read: then the parts in them are known.
#include "tasks/changes/kept_cells.hpp"

#include <algorithm>
#include <utility>

#include "tasks/changes/changed_parts.hpp"

namespace cluxel::tasks {

namespace {

/// Whether tiles for which `is_beyond` holds lie within reach of cells at the place.
template <typename IsBeyond>
bool isNearTile(const perception::TileGrid& grid, const Eigen::Vector3d& place, const IsBeyond& is_beyond) {
  constexpr double kReach_m = kNearCells_m + 0.01;
  for (const double x : {-kReach_m, 0.0, kReach_m})
    for (const double y : {-kReach_m, 0.0, kReach_m})
      if (is_beyond(grid.tileOf(place + Eigen::Vector3d(x, y, 0)))) return true;
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

std::vector<ChangeGroup> hangingTogether(const std::vector<PointCell>& cells, const CellNeighbours& neighbours) {
  std::vector<ChangeState> states;
  for (const PointCell& cell : cells) states.push_back(stateOf(cell));
  return ChangeGroups(std::move(states), [&](auto cell, const auto& visit) { neighbours.forEach(cell, visit); })
      .connected();
}

void appendChosen(const std::vector<PointCell>& cells, const std::vector<bool>& is_chosen,
                  std::vector<PointCell>& chosen) {
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (is_chosen[i]) chosen.push_back(cells[i]);
}

}  // namespace

void KeptCells::add(const mapping::MapRegion& region, std::vector<PointCell> cells, const perception::TileSet& unread,
                    const KeptCluxels& cluxels) {
  for (const PointCell& cell : cells)
    if (cell.is_of_changed_cluxel) of_cluxels_.push_back(cell);
  settleOfCluxels(cluxels);
  grid_ = region.scene.cluxels.grid;
  std::vector<bool> is_kept = changedOrNear(cells);
  const auto is_outside = [&](const perception::TileKey& tile) { return !region.tiles.contains(tile); };
  for (std::size_t i = 0; i < cells.size(); ++i)
    is_kept[i] = is_kept[i] || isNearTile(grid_, cells[i].place, is_outside);
  appendChosen(std::exchange(cells, {}), is_kept, open_);
  settle(unread);
}

void KeptCells::settleOfCluxels(const KeptCluxels& cluxels) {
  std::vector<PointCell> open;
  for (const PointCell& cell : of_cluxels_) {
    const KeptCluxels::Fate fate = cluxels.fateOf(cell.cluxel);
    if (fate == KeptCluxels::Fate::InCluster) settled_.push_back(cell);
    if (fate == KeptCluxels::Fate::Open) open.push_back(cell);
  }
  of_cluxels_ = std::move(open);
}

void KeptCells::settle(const perception::TileSet& unread) {
  const CellNeighbours neighbours(open_);
  const auto is_unread = [&](const perception::TileKey& tile) { return unread.contains(tile); };
  std::vector<bool> reaches_unread(open_.size()), settles(open_.size()), is_open(open_.size());
  for (std::size_t i = 0; i < open_.size(); ++i) reaches_unread[i] = isNearTile(grid_, open_[i].place, is_unread);
  std::vector<bool> stays = reaches_unread;
  const auto markNear = [&](const ChangeGroup& group, std::vector<bool>& marked) {
    for (const std::uint32_t cell : group) neighbours.forEach(cell, [&](std::uint32_t near) { marked[near] = true; });
  };
  for (const ChangeGroup& group : hangingTogether(open_, neighbours)) {
    if (std::none_of(group.begin(), group.end(), [&](std::uint32_t cell) { return reaches_unread[cell]; })) continue;
    for (const std::uint32_t cell : group) is_open[cell] = true;
    markNear(group, stays);
  }
  for (const ChangeGroup& part : possibleParts(open_)) {
    if (is_open[part.front()]) continue;
    markNear(part, settles);
    std::vector<CellKey>& keys = parts_.emplace_back();
    for (const std::uint32_t cell : part) keys.push_back(open_[cell].key);
  }
  appendChosen(open_, settles, settled_);
  std::vector<PointCell> open;
  appendChosen(open_, stays, open);
  open_ = std::move(open);
}

KeptCells::Parts KeptCells::take() {
  Parts all{std::exchange(settled_, {}), {}};
  std::sort(all.cells.begin(), all.cells.end(), [](const PointCell& a, const PointCell& b) { return a.key < b.key; });
  const auto is_same = [](const PointCell& a, const PointCell& b) { return a.key == b.key; };
  all.cells.erase(std::unique(all.cells.begin(), all.cells.end(), is_same), all.cells.end());
  for (const std::vector<CellKey>& keys : std::exchange(parts_, {})) {
    ChangeGroup& group = all.groups.emplace_back();
    for (const CellKey& key : keys) {
      const auto at = std::lower_bound(all.cells.begin(), all.cells.end(), key,
                                       [](const PointCell& cell, const CellKey& value) { return cell.key < value; });
      group.push_back(static_cast<std::uint32_t>(at - all.cells.begin()));
    }
    std::sort(group.begin(), group.end());
  }
  std::sort(all.groups.begin(), all.groups.end());
  open_ = {}, of_cluxels_ = {};
  return all;
}

}  // namespace cluxel::tasks
