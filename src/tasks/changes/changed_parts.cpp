// SPDX-License-Identifier: Apache-2.0
// Scans vote: one with a poor pose does not decide.
#include "tasks/changes/changed_parts.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "perception/visibility/presence.hpp"

namespace cluxel::tasks {

namespace {

constexpr std::size_t kMostHits = 2;  ///< scans that passed for each that hit

/// What scans found at the cells of a group.
struct GroupEvidence {
  double own_hits = 0, own_looks = 0, other_hits = 0, other_looks = 0;  ///< of all scans at all cells
  double own_ended = 0, own_rays = 0;                                   ///< rays of its own time
  double passing = 0, stopped = 0;                                      ///< rays of the other time
  std::size_t scans = 0, passing_scans = 0;
  std::size_t foliage = 0;  ///< cells
};

class Grouping {
 public:
  explicit Grouping(const std::vector<PointCell>& cells)
      : cells_(cells),
        neighbours_(cells),
        groups_(statesOf(cells), [this](auto cell, const auto& visit) { neighbours_.forEach(cell, visit); }) {}

  std::vector<ChangeGroup> all() const { return groups_.all(kSolidCells); }

  std::vector<ChangeGroup> possible() const {
    std::vector<ChangeGroup> groups = all();
    std::erase_if(groups, [this](const ChangeGroup& group) { return !isGone(group, allHit(evidenceOf(group))); });
    return groups;
  }

  std::vector<ChangeGroup> sureOf(std::vector<ChangeGroup> groups) const {
    std::erase_if(groups, [this](const ChangeGroup& group) { return !isGone(group, evidenceOf(group)); });
    return groups;
  }

 private:
  static constexpr std::size_t kSolidCells = 12, kTopCells = 16, kWholeCells = 20;
  static constexpr std::size_t kOwnScans = 4, kOwnScansOfTop = 3, kPassing = 3, kPassingSolid = 4;
  static constexpr std::size_t kLargeCells = 40, kPassingLarge = 2;
  static constexpr std::size_t kPassedCells = 3;  ///< of the group, by one scan
  /// Log-odds of "gone".
  static constexpr double kLeastOfWhole = 50, kWeak = 80, kStrong = 100, kClear = 150, kEvident = 400;
  static constexpr double kOfCell = 3, kClearOfCell = 4.5;  ///< the same, on average of the cells
  static constexpr double kMostHitShare = 0.98, kOwnHits = 0.6, kOwnEnded = 0.7, kOwnEndedStrong = 0.55;
  static constexpr double kClearHits = 0.7, kClearEnded = 0.5, kClearRest = 0.1;
  static constexpr double kRest = 0.15, kWholeRest = 0.02, kWholeAlike = 0.85, kLargeAlike = 0.9, kAboveTop = 0.95,
                          kAboveStrong = 0.7;

  static std::vector<ChangeState> statesOf(const std::vector<PointCell>& cells) {
    std::vector<ChangeState> states;
    for (const PointCell& cell : cells) states.push_back(stateOf(cell));
    return states;
  }

  std::size_t passingScans(const ChangeGroup& group) const {
    struct Cells {
      std::size_t hit = 0, passed = 0;
    };
    std::map<std::uint32_t, Cells> of_scan;
    for (const std::uint32_t cell : group) {
      const RayLooks& looks = cells_[cell].other;
      looks.hit_scans.forEach([&](std::uint32_t scan) { ++of_scan[scan].hit; });
      looks.through_scans.forEach([&](std::uint32_t scan) {
        if (!looks.hit_scans.contains(scan)) ++of_scan[scan].passed;
      });
    }
    return static_cast<std::size_t>(std::count_if(of_scan.begin(), of_scan.end(), [](const auto& scan) {
      return scan.second.passed >= kPassedCells && scan.second.passed > kMostHits * scan.second.hit;
    }));
  }

  GroupEvidence evidenceOf(const ChangeGroup& group) const {
    GroupEvidence found;
    ScanNumbers scans;
    for (const std::uint32_t number : group) {
      const PointCell& cell = cells_[number];
      const auto own_hits = static_cast<double>(cell.own.hits()), other_hits = static_cast<double>(cell.other.hits());
      found.own_hits += own_hits, found.own_looks += own_hits + static_cast<double>(cell.own.through());
      found.other_hits += other_hits, found.other_looks += other_hits + static_cast<double>(cell.other.through());
      found.own_ended += static_cast<double>(cell.own.rays.ended);
      found.own_rays += static_cast<double>(cell.own.rays.ended + cell.own.rays.passed);
      found.passing += static_cast<double>(cell.other.passing_rays);
      found.stopped += static_cast<double>(cell.other.stopped_rays);
      found.foliage += cell.is_foliage ? 1 : 0;
      scans |= cell.scans;
    }
    found.scans = scans.size();
    found.passing_scans = passingScans(group);
    return found;
  }

  /// The most that looks and rays of its own time may tell.
  static GroupEvidence allHit(GroupEvidence found) {
    found.own_hits = found.own_looks = found.own_ended = found.own_rays = 1;
    return found;
  }

  /// Whether the group has what each kind of part needs, of scans of its own time and of those that passed it.
  static bool mayBeGone(const GroupEvidence& found) {
    return found.scans >= kOwnScansOfTop && found.passing_scans >= kPassingLarge &&
           found.stopped <= kMostStopped * found.passing && found.other_hits <= kRest * found.other_looks;
  }

  /// Log-odds of "gone" from the looks of the other time.
  static double logOdds(const GroupEvidence& found) {
    constexpr perception::PresenceParams kPresence;
    const double share = std::min(found.own_hits / found.own_looks, kMostHitShare);
    return found.other_hits * std::log(kPresence.hit_when_gone / share) +
           (found.other_looks - found.other_hits) * std::log((1 - kPresence.hit_when_gone) / (1 - share));
  }

  bool isGone(const ChangeGroup& group, const GroupEvidence& found) const {
    if (!mayBeGone(found) || found.own_hits < kOwnHits * found.own_looks) return false;
    const double log_odds = logOdds(found);
    if (found.passing_scans < kPassing) return isLarge(found, group, log_odds);
    const auto height = [this](std::uint32_t cell) { return cells_[cell].place.z(); };
    const double above = groups_.shareOfChangedAbove(group, height);
    const bool is_top = above >= kAboveTop;
    if (is_top && group.size() >= kTopCells && log_odds >= kWeak) return true;
    const double of_cell = log_odds / static_cast<double>(group.size());
    if (found.scans < kOwnScans || (!is_top && (log_odds < kWeak || of_cell < kOfCell))) return false;
    return isSolid(found, group.size(), log_odds >= kStrong && above >= kAboveStrong) ||
           isWhole(found, group, log_odds) || isClear(found, log_odds, of_cell) ||
           (log_odds >= kEvident && of_cell >= kOfCell);
  }

  /// Whether the looks at each cell tell so much, on average, that it does not matter what the part is made of.
  static bool isClear(const GroupEvidence& found, double log_odds, double of_cell) {
    return log_odds >= kClear && of_cell >= kClearOfCell && found.own_hits >= kClearHits * found.own_looks &&
           found.own_ended >= kClearEnded * found.own_rays && found.other_hits <= kClearRest * found.other_looks;
  }

  static bool isSolid(const GroupEvidence& found, std::size_t cells, bool is_strong) {
    return 2 * found.foliage < cells && found.passing_scans >= kPassingSolid &&
           found.own_ended >= (is_strong ? kOwnEndedStrong : kOwnEnded) * found.own_rays;
  }

  bool isWhole(const GroupEvidence& found, const ChangeGroup& group, double log_odds) const {
    return group.size() >= kWholeCells && hasLeft(found, group, log_odds, kWholeAlike);
  }

  /// Whether all of something is gone that is so large that two scans do not miss it: their poses are not off alike.
  bool isLarge(const GroupEvidence& found, const ChangeGroup& group, double log_odds) const {
    return group.size() >= kLargeCells && found.scans >= kOwnScans && hasLeft(found, group, log_odds, kLargeAlike);
  }

  /// Whether hardly a look of the other time hits the group, and at least `alike` of what is in and around it changed.
  bool hasLeft(const GroupEvidence& found, const ChangeGroup& group, double log_odds, double alike) const {
    return log_odds >= kLeastOfWhole && found.other_hits <= kWholeRest * found.other_looks &&
           groups_.shareOfChanged(groups_.withNear(group)) >= alike;
  }

  const std::vector<PointCell>& cells_;
  CellNeighbours neighbours_;
  ChangeGroups groups_;
};

}  // namespace

ChangeState stateOf(const PointCell& cell) {
  if (cell.is_shared) return ChangeState::Stable;
  const std::size_t hits = cell.other.hits(), through = cell.other.through();
  if (through > kMostHits * hits) return ChangeState::Changed;
  return hits > 0 && through < kMostHits * hits ? ChangeState::Stable : ChangeState::Undecided;
}

std::vector<ChangeGroup> changedParts(const std::vector<PointCell>& cells) {
  const Grouping grouping(cells);
  return grouping.sureOf(grouping.all());
}

std::vector<ChangeGroup> partsAmong(std::vector<ChangeGroup> possible, const std::vector<PointCell>& cells) {
  return Grouping(cells).sureOf(std::move(possible));
}

std::vector<ChangeGroup> possibleParts(const std::vector<PointCell>& cells) {
  return Grouping(cells).possible();
}

}  // namespace cluxel::tasks
