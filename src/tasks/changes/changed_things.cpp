// SPDX-License-Identifier: Apache-2.0
// Cluxels tell first; cells of points tell what is finer than they are.
#include "tasks/changes/changed_things.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <set>
#include <unordered_map>
#include <utility>

#include "mapping/facts/object_geometry.hpp"
#include "tasks/changes/changed_cluxels.hpp"
#include "tasks/changes/changed_parts.hpp"
#include "tasks/changes/point_cells.hpp"
#include "tasks/changes/side_by_side.hpp"
#include "tasks/changes/visit_votes.hpp"

namespace cluxel::tasks {

namespace {

using perception::PresenceState;

constexpr double kSameChange_m = 0.3;  ///< a part that lies nearer to a change of its kind belongs to it

Eigen::AlignedBox3d boxOf(const std::vector<PointCell>& cells, const ChangeGroup& group) {
  Eigen::AlignedBox3d box;
  for (const std::uint32_t cell : group) box.extend(cells[cell].place);
  return box;
}

/// Gives each cluxel to the group with most of its cells.
std::vector<std::vector<std::uint32_t>> shareOut(const std::vector<PointCell>& cells,
                                                 const std::vector<ChangeGroup>& groups) {
  std::map<std::uint32_t, std::vector<std::size_t>> cells_of_cluxel;  // by group
  for (std::size_t group = 0; group < groups.size(); ++group)
    for (const std::uint32_t cell : groups[group]) {
      auto& counts = cells_of_cluxel[cells[cell].cluxel];
      counts.resize(groups.size(), 0);
      ++counts[group];
    }
  std::vector<std::vector<std::uint32_t>> cluxels(groups.size());
  for (const auto& [cluxel, counts] : cells_of_cluxel)
    cluxels[static_cast<std::size_t>(std::max_element(counts.begin(), counts.end()) - counts.begin())].push_back(
        cluxel);
  return cluxels;
}

/// The things of one kind.
class Things {
 public:
  /// `time`: kBefore or kAfter, when the things were there.
  Things(std::size_t time, const ChangeSurvey& survey) : time_(time), survey_(survey), cells_(survey.cells[time]) {
    for (std::size_t i = 0; i < survey.cluxels.number.size(); ++i)
      object_of_cluxel_[survey.cluxels.number[i]] = survey.cluxels.object[i];
    for (std::uint32_t cell = 0; cell < cells_.size(); ++cell) {
      object_of_cluxel_[cells_[cell].cluxel] = cells_[cell].object;
      if (stateOf(cells_[cell]) == ChangeState::Changed) cells_of_cluxel_[cells_[cell].cluxel].push_back(cell);
    }
  }

  std::vector<ChangedThing> run() {
    const CluxelChange kind = time_ == kBefore ? CluxelChange::Vanished : CluxelChange::Appeared;
    for (const ChangeGroup& cluster : clustersAmong(survey_.clusters[time_], kind, survey_.cluxels))
      addCluster(cluster);
    const std::size_t clusters = things_.size();
    for (const ChangeGroup& part : partsAmong(survey_.parts[time_], cells_))
      if (!isNearChange(boxOf(cells_, part), clusters)) addGroups({part});
    for (const WholeObject& whole : survey_.wholes[time_]) addWhole(whole);
    markPieces();
    return std::move(things_);
  }

 private:
  void addCluster(const ChangeGroup& cluster) {
    const perception::SceneCluxels& cluxels = survey_.cluxels.cluxels;
    std::vector<std::uint32_t> numbers;
    ChangeGroup group;
    Eigen::AlignedBox3d box;
    for (const std::uint32_t cluxel : cluster) {
      numbers.push_back(survey_.cluxels.number[cluxel]);
      box.extend(cluxels.low_corner[cluxel]);
      box.extend(cluxels.low_corner[cluxel] + cluxels.extent[cluxel].cast<double>());
      const auto cells = cells_of_cluxel_.find(numbers.back());
      if (cells != cells_of_cluxel_.end()) group.insert(group.end(), cells->second.begin(), cells->second.end());
    }
    std::sort(group.begin(), group.end());
    const std::vector<ChangeGroup> sheets = sheetsOf(cells_, group);
    if (sheets.size() > 1) return addGroups(sheets);
    addThing(std::move(numbers), box, votesAtCluxels(cluster));
  }

  void addGroups(const std::vector<ChangeGroup>& groups) {
    std::vector<std::vector<std::uint32_t>> shares = shareOut(cells_, groups);
    for (std::size_t i = 0; i < groups.size(); ++i)
      addThing(std::move(shares[i]), boxOf(cells_, groups[i]), votesInCells(groups[i]));
  }

  /// What the visits of both times found at the places of a thing, by time.
  using VotesOfTimes = std::array<VisitVotes, 2>;

  VotesOfTimes votesAtCluxels(const ChangeGroup& cluster) const {
    return votesOf(cluster.size(), [&](std::size_t time, std::size_t place, PlaceVotes& votes) {
      const ChangedCluxels& all = survey_.cluxels;
      const RayFindings& found = (time == kBefore ? all.before : all.after)[cluster[place]];
      votes.addPlace(found.hits, found.allPassed());
    });
  }

  VotesOfTimes votesInCells(const ChangeGroup& group) const {
    return votesOf(group.size(), [&](std::size_t time, std::size_t place, PlaceVotes& votes) {
      const PointCell& cell = cells_[group[place]];
      const RayLooks& looks = time == time_ ? cell.own : cell.other;
      votes.addPlace(looks.hit_scans, looks.through_scans);
    });
  }

  template <typename AddPlace>
  VotesOfTimes votesOf(std::size_t places, const AddPlace& add) const {
    VotesOfTimes votes;
    for (const std::size_t time : {kBefore, kAfter}) {
      PlaceVotes gathered(survey_.visits, places);
      for (std::size_t place = 0; place < places; ++place) add(time, place, gathered);
      votes[time] = gathered.take();
    }
    return votes;
  }

  /// Names the thing after the object that most of its cluxels belong to.
  void addThing(std::vector<std::uint32_t> cluxels, const Eigen::AlignedBox3d& box, const VotesOfTimes& votes) {
    if (cluxels.empty() || isAwayAtEnd(votes[time_])) return;
    ChangedThing thing{std::move(cluxels), std::nullopt, false, box, visitsWithIt(votes[time_])};
    std::map<std::uint32_t, std::size_t> counts;
    for (const std::uint32_t cluxel : thing.cluxels) ++counts[object_of_cluxel_.at(cluxel)];
    const auto most = std::max_element(counts.begin(), counts.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    if (most->first != mapping::kNoObject) {
      thing.object = most->first;
      const auto stable = survey_.stable_of_object.find(most->first);
      const ObjectStates* states = statesOf(most->first);
      const bool is_gone_as_whole = states == nullptr || stateAtOtherTime(*states) == PresenceState::Absent;
      thing.is_part = (stable != survey_.stable_of_object.end() && stable->second > most->second) || !is_gone_as_whole;
      if (states != nullptr && (isHiddenPart(*states, votes[1 - time_]) || isMissedPart(*states, votes))) return;
    }
    things_.push_back(std::move(thing));
  }

  /// Nothing when its cluxels tell a change: when one is named after it, or has half of its cluxels.
  void addWhole(const WholeObject& whole) {
    std::set<std::uint32_t> told;
    for (const ChangedThing& thing : things_) {
      if (thing.object == whole.object) return;
      std::set_intersection(thing.cluxels.begin(), thing.cluxels.end(), whole.cluxels.begin(), whole.cluxels.end(),
                            std::inserter(told, told.end()));
    }
    if (2 * told.size() < whole.cluxels.size())
      things_.push_back({whole.cluxels, whole.object, false, whole.box, whole.visits});
  }

  /// Things of one object are parts of it.
  void markPieces() {
    std::map<std::uint32_t, std::size_t> things_of_object;
    for (const ChangedThing& thing : things_)
      if (thing.object) ++things_of_object[*thing.object];
    for (ChangedThing& thing : things_) {
      thing.has_more_parts = thing.object && things_of_object[*thing.object] > 1;
      thing.is_part = thing.is_part || thing.has_more_parts;
    }
  }

  const ObjectStates* statesOf(std::uint32_t object) const {
    const auto states = std::lower_bound(survey_.states.begin(), survey_.states.end(), object,
                                         [](const ObjectStates& a, std::uint32_t b) { return a.object < b; });
    return states == survey_.states.end() || states->object != object ? nullptr : &*states;
  }

  PresenceState stateAtOtherTime(const ObjectStates& states) const {
    return time_ == kBefore ? states.after : states.before;
  }

  /// Whether the object is there at the other time, too, and what the visits with it found at the place of the part, of
  /// which `votes` tell, does not show that the part is away.
  bool isHiddenPart(const ObjectStates& object, const VisitVotes& votes) const {
    if (stateAtOtherTime(object) != PresenceState::Present) return false;
    const bool is_known_with_it = std::any_of(object.visits.begin(), object.visits.end(), [&](std::uint32_t visit) {
      return survey_.visits.isAfter(visit) == (time_ == kBefore);
    });
    const VisitVotes with_it = votesOn(object.visits, votes);
    return is_known_with_it && with_it.visits.size() < votes.visits.size() && !isAwayAtEnd(with_it);
  }

  /// Whether the object is there at both times, and rays find the part on some visits and see through it on others in
  /// turn. Then rays from some places miss it: hardly any part leaves, comes back and leaves again.
  static bool isMissedPart(const ObjectStates& object, const VotesOfTimes& votes) {
    constexpr std::size_t kTurns = 3;
    return object.before == PresenceState::Present && object.after == PresenceState::Present &&
           comingsAndGoings(joined(votes[kBefore], votes[kAfter])) >= kTurns;
  }

  bool isNearChange(const Eigen::AlignedBox3d& box, std::size_t clusters) const {
    const Eigen::Vector3d around = Eigen::Vector3d::Constant(kSameChange_m);
    const Eigen::AlignedBox3d roomy(box.min() - around, box.max() + around);
    return std::any_of(things_.begin(), things_.begin() + static_cast<std::ptrdiff_t>(clusters),
                       [&](const ChangedThing& thing) { return roomy.intersects(thing.box); });
  }

  std::size_t time_;
  const ChangeSurvey& survey_;
  const std::vector<PointCell>& cells_;
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> cells_of_cluxel_;  ///< those that changed
  std::unordered_map<std::uint32_t, std::uint32_t> object_of_cluxel_;
  std::vector<ChangedThing> things_;
};

}  // namespace

ChangedThings changedThings(const ChangeSurvey& survey) {
  return {Things(kBefore, survey).run(), Things(kAfter, survey).run()};
}

}  // namespace cluxel::tasks
