// SPDX-License-Identifier: Apache-2.0
// Cells are grouped like cluxels in changed_cluxels.cpp, but scans vote: one with a poor pose does not decide.
#include "tasks/changes/changed_parts.hpp"

#include <algorithm>
#include <array>

namespace cluxel::tasks {

namespace {

constexpr int kMostHits = 2;  ///< scans that passed for each that hit

/// What scans found at the cells of a group.
struct GroupEvidence {
  double own_hits = 0, own_looks = 0, other_hits = 0, other_looks = 0;  ///< of all scans at all cells
  double own_ended = 0, own_rays = 0;                                   ///< rays of its own time
  std::size_t scans = 0, passing_scans = 0;
  std::size_t foliage = 0;  ///< cells
  double alike = 0;         ///< the share of the decided cells in and around the group that changed like it
};

class Grouping {
 public:
  Grouping(const std::vector<PointCell>& cells, const perception::SceneCluxels& cluxels)
      : cells_(cells), cluxels_(cluxels), neighbours_(cells) {
    for (const PointCell& cell : cells) states_.push_back(stateOf(cell));
  }

  std::vector<CellGroup> run() const {
    std::vector<bool> is_open(cells_.size());
    for (std::uint32_t i = 0; i < cells_.size(); ++i) is_open[i] = states_[i] == CellState::Changed && agrees(i);
    std::vector<CellGroup> groups;
    for (std::uint32_t start = 0; start < cells_.size(); ++start) {
      if (!is_open[start]) continue;
      CellGroup group = connectedFrom(start, is_open);
      if (group.size() >= kSolidCells && isSure(group)) groups.push_back(std::move(group));
    }
    return groups;
  }

 private:
  static constexpr std::size_t kSolidCells = 12, kWholeCells = 20, kOwnScans = 4, kPassing = 3, kPassingSolid = 4;
  static constexpr std::size_t kPassedCells = 3;  ///< of the group, by one scan
  static constexpr double kOwnHits = 0.6, kOwnEnded = 0.7, kSolidRest = 0.15, kWholeRest = 0.02, kWholeAlike = 0.85;

  struct Count {
    double alike = 0, decided = 0;
  };

  void add(std::uint32_t cell, Count& count) const {
    count.decided += states_[cell] != CellState::Undecided ? 1 : 0;
    count.alike += states_[cell] == CellState::Changed ? 1 : 0;
  }

  bool agrees(std::uint32_t cell) const {
    Count near;
    neighbours_.forEach(cell, [&](std::uint32_t other) { add(other, near); });
    return 2 * near.alike > near.decided;
  }

  CellGroup connectedFrom(std::uint32_t start, std::vector<bool>& is_open) const {
    CellGroup group{start};
    is_open[start] = false;
    for (std::size_t next = 0; next < group.size(); ++next)
      neighbours_.forEach(group[next], [&](std::uint32_t other) {
        if (!is_open[other]) return;
        is_open[other] = false;
        group.push_back(other);
      });
    std::sort(group.begin(), group.end());
    return group;
  }

  double shareAlike(const CellGroup& group) const {
    CellGroup around;
    for (const std::uint32_t cell : group)
      neighbours_.forEach(cell, [&](std::uint32_t other) { around.push_back(other); });
    std::sort(around.begin(), around.end());
    around.erase(std::unique(around.begin(), around.end()), around.end());
    Count count;
    for (const std::uint32_t cell : around) add(cell, count);
    return count.alike / count.decided;
  }

  std::size_t passingScans(const CellGroup& group) const {
    std::size_t passing = 0;
    for (std::size_t scan = 0; scan < kScanBits; ++scan) {
      std::size_t hit = 0, passed = 0;
      for (const std::uint32_t cell : group) {
        hit += cells_[cell].other.hit_scans >> scan & 1U;
        passed += cells_[cell].other.through_scans >> scan & 1U;
      }
      passing += passed >= kPassedCells && passed > kMostHits * hit ? 1 : 0;
    }
    return passing;
  }

  GroupEvidence evidenceOf(const CellGroup& group) const {
    GroupEvidence found;
    std::uint64_t scans = 0;
    for (const std::uint32_t number : group) {
      const PointCell& cell = cells_[number];
      found.own_hits += cell.own.hits(), found.own_looks += cell.own.hits() + cell.own.through();
      found.other_hits += cell.other.hits(), found.other_looks += cell.other.hits() + cell.other.through();
      found.own_ended += static_cast<double>(cell.own.rays.ended);
      found.own_rays += static_cast<double>(cell.own.rays.ended + cell.own.rays.passed);
      found.foliage += cluxels_.label[cell.cluxel] == scan::PrimitiveLabel::Scatter ? 1 : 0;
      scans |= cell.scans;
    }
    found.scans = static_cast<std::size_t>(std::popcount(scans));
    found.passing_scans = passingScans(group);
    found.alike = shareAlike(group);
    return found;
  }

  bool isSure(const CellGroup& group) const {
    const GroupEvidence found = evidenceOf(group);
    if (found.scans < kOwnScans || found.passing_scans < kPassing) return false;
    if (found.own_hits < kOwnHits * found.own_looks) return false;
    const bool is_solid = found.own_ended >= kOwnEnded * found.own_rays && 2 * found.foliage < group.size();
    if (is_solid && found.passing_scans >= kPassingSolid && found.other_hits <= kSolidRest * found.other_looks)
      return true;
    return group.size() >= kWholeCells && found.other_hits <= kWholeRest * found.other_looks &&
           found.alike >= kWholeAlike;
  }

  const std::vector<PointCell>& cells_;
  const perception::SceneCluxels& cluxels_;
  CellNeighbours neighbours_;
  std::vector<CellState> states_;
};

}  // namespace

CellState stateOf(const PointCell& cell) {
  if (cell.is_shared) return CellState::Stable;
  const int hits = cell.other.hits(), through = cell.other.through();
  if (through > kMostHits * hits) return CellState::Changed;
  return hits > 0 && through < kMostHits * hits ? CellState::Stable : CellState::Undecided;
}

std::vector<CellGroup> changedParts(const std::vector<PointCell>& cells, const perception::SceneCluxels& cluxels) {
  return Grouping(cells, cluxels).run();
}

}  // namespace cluxel::tasks
