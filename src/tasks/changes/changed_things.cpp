// SPDX-License-Identifier: Apache-2.0
// Cluxels tell first; cells of points tell what is finer than they are.
#include "tasks/changes/changed_things.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "mapping/facts/object_geometry.hpp"
#include "rdf/vocabulary.hpp"
#include "tasks/changes/changed_cluxels.hpp"
#include "tasks/changes/changed_parts.hpp"
#include "tasks/changes/point_cells.hpp"
#include "tasks/changes/side_by_side.hpp"

namespace cluxel::tasks {

namespace {

constexpr double kSameChange_m = 0.3;  ///< a part that lies nearer to a change of its kind belongs to it

/// The objects of cluxels, and which cluxels may change: those of no ground.
struct Owners {
  std::vector<std::uint32_t> object;  ///< by cluxel, or kNoObject
  std::vector<bool> may_change;
};

Owners ownersIn(const mapping::MapReader& map) {
  const std::size_t count = map.scene().cluxels.size();
  Owners owners{std::vector<std::uint32_t>(count, mapping::kNoObject), std::vector<bool>(count, true)};
  for (std::uint32_t i = 0; i < map.objects().size(); ++i) {
    const bool is_ground = map.objects()[i].class_iri == rdf::vocabulary::clx("Ground");
    for (const std::uint32_t cluxel : mapping::cluxelsOf(map.objects()[i])) {
      owners.object[cluxel] = i;
      if (is_ground) owners.may_change[cluxel] = false;
    }
  }
  return owners;
}

Eigen::AlignedBox3d boxOf(const std::vector<PointCell>& cells, const CellGroup& group) {
  Eigen::AlignedBox3d box;
  for (const std::uint32_t cell : group) box.extend(cells[cell].place);
  return box;
}

/// Gives each cluxel to the group with most of its cells.
std::vector<std::vector<std::uint32_t>> shareOut(const std::vector<PointCell>& cells,
                                                 const std::vector<CellGroup>& groups) {
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
  Things(CluxelChange kind, const perception::SceneCluxels& cluxels, const Owners& owners,
         const std::vector<CluxelChange>& changes, const std::vector<PointCell>& cells)
      : kind_(kind), cluxels_(cluxels), owners_(owners), cells_(cells), cells_of_cluxel_(cluxels.size()) {
    for (std::uint32_t cell = 0; cell < cells.size(); ++cell)
      if (stateOf(cells[cell]) == CellState::Changed) cells_of_cluxel_[cells[cell].cluxel].push_back(cell);
    for (std::size_t i = 0; i < changes.size(); ++i)
      if (changes[i] == CluxelChange::Stable && owners.object[i] != mapping::kNoObject)
        ++stable_of_object_[owners.object[i]];
  }

  std::vector<ChangedThing> run(const std::vector<CluxelChange>& changes, const CluxelFindings& findings) {
    for (auto& cluster : clustersOf(kind_, changes, findings, cluxels_)) addCluster(std::move(cluster));
    const std::size_t clusters = things_.size();
    for (const CellGroup& part : changedParts(cells_, cluxels_))
      if (!isNearChange(boxOf(cells_, part), clusters)) addGroups({part});
    return std::move(things_);
  }

 private:
  void addCluster(std::vector<std::uint32_t> cluster) {
    CellGroup group;
    for (const std::uint32_t cluxel : cluster)
      group.insert(group.end(), cells_of_cluxel_[cluxel].begin(), cells_of_cluxel_[cluxel].end());
    std::sort(group.begin(), group.end());
    std::vector<CellGroup> sheets = sheetsOf(cells_, cluxels_, group);
    if (sheets.size() > 1) return addGroups(sheets);
    Eigen::AlignedBox3d box;
    for (const std::uint32_t cluxel : cluster) {
      box.extend(cluxels_.low_corner[cluxel]);
      box.extend(cluxels_.low_corner[cluxel] + cluxels_.extent[cluxel].cast<double>());
    }
    addThing(std::move(cluster), box);
  }

  void addGroups(const std::vector<CellGroup>& groups) {
    std::vector<std::vector<std::uint32_t>> shares = shareOut(cells_, groups);
    for (std::size_t i = 0; i < groups.size(); ++i) addThing(std::move(shares[i]), boxOf(cells_, groups[i]));
  }

  /// Names the thing after the object that most of its cluxels belong to.
  void addThing(std::vector<std::uint32_t> cluxels, const Eigen::AlignedBox3d& box) {
    if (cluxels.empty()) return;
    ChangedThing thing{std::move(cluxels), std::nullopt, false, box};
    std::map<std::uint32_t, std::size_t> votes;
    for (const std::uint32_t cluxel : thing.cluxels) ++votes[owners_.object[cluxel]];
    const auto most =
        std::max_element(votes.begin(), votes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    if (most->first != mapping::kNoObject) {
      thing.object = most->first;
      const auto stable = stable_of_object_.find(most->first);
      thing.is_part = stable != stable_of_object_.end() && stable->second > most->second;
    }
    things_.push_back(std::move(thing));
  }

  bool isNearChange(const Eigen::AlignedBox3d& box, std::size_t clusters) const {
    const Eigen::Vector3d around = Eigen::Vector3d::Constant(kSameChange_m);
    const Eigen::AlignedBox3d roomy(box.min() - around, box.max() + around);
    return std::any_of(things_.begin(), things_.begin() + static_cast<std::ptrdiff_t>(clusters),
                       [&](const ChangedThing& thing) { return roomy.intersects(thing.box); });
  }

  CluxelChange kind_;
  const perception::SceneCluxels& cluxels_;
  const Owners& owners_;
  const std::vector<PointCell>& cells_;
  std::vector<std::vector<std::uint32_t>> cells_of_cluxel_;  ///< those that changed
  std::map<std::uint32_t, std::size_t> stable_of_object_;
  std::vector<ChangedThing> things_;
};

}  // namespace

ChangedThings changedThings(const mapping::MapReader& map, double since_s, unsigned threads) {
  const Owners owners = ownersIn(map);
  const perception::SceneCluxels& cluxels = map.scene().cluxels;
  const CluxelFindings findings = findingsAt(map, since_s, owners.may_change, threads);
  const std::vector<CluxelChange> changes = changesOf(findings, cluxels.size());
  const PointCells cells = pointCellsOf(map, since_s, owners.may_change, threads);
  return {Things(CluxelChange::Vanished, cluxels, owners, changes, cells.before).run(changes, findings),
          Things(CluxelChange::Appeared, cluxels, owners, changes, cells.after).run(changes, findings)};
}

}  // namespace cluxel::tasks
