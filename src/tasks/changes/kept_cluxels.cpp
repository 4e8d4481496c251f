// SPDX-License-Identifier: Apache-2.0
// Changed cluxels that hang together are decided when all that intersect them were read.
#include "tasks/changes/kept_cluxels.hpp"

#include <algorithm>
#include <utility>

namespace cluxel::tasks {

namespace {

constexpr std::array kKinds{CluxelChange::Vanished, CluxelChange::Appeared};

bool hasChanged(CluxelChange change) {
  return change == CluxelChange::Vanished || change == CluxelChange::Appeared;
}

/// Changed cluxels of either kind that intersect each other.
std::vector<ChangeGroup> hangingTogether(const ChangedCluxels& all) {
  std::vector<ChangeState> states;
  for (const CluxelChange change : all.changes)
    states.push_back(hasChanged(change) ? ChangeState::Changed : ChangeState::Undecided);
  const auto forEachNear = [&](std::uint32_t cluxel, const ChangeGroups::Visit& visit) {
    for (const std::uint32_t other : all.cluxels.neighbours(cluxel)) visit(other);
  };
  return ChangeGroups(std::move(states), forEachNear).connected();
}

std::uint32_t indexOf(std::uint32_t number, const std::vector<std::uint32_t>& ascending) {
  return static_cast<std::uint32_t>(std::lower_bound(ascending.begin(), ascending.end(), number) - ascending.begin());
}

}  // namespace

void KeptCluxels::add(const mapping::MapRegion& region, const RegionFindings& found,
                      const perception::TileSet& unread) {
  const perception::SceneCluxels& cluxels = region.scene.cluxels;
  for (std::uint32_t i = 0; i < cluxels.size(); ++i) {
    if (!region.is_own[i]) continue;
    const auto neighbours = cluxels.neighbours(i);
    const auto may_matter = [&](std::uint32_t other) {
      return !region.is_own[other] || hasChanged(found.changes[other]);
    };
    if (!hasChanged(found.changes[i]) && std::none_of(neighbours.begin(), neighbours.end(), may_matter)) continue;
    Kept kept{region.number[i],
              region.object[i],
              found.changes[i],
              found.is_told[i],
              cluxels.center[i],
              cluxels.low_corner[i],
              found.places[i],
              cluxels.extent[i],
              found.gone[i],
              {},
              {}};
    for (const std::uint32_t other : neighbours) {
      if (hasChanged(found.changes[i])) kept.neighbours.push_back(region.number[other]);
      if (!region.is_own[other]) kept.other_tiles.push_back(cluxels.name[other].tile);
    }
    std::sort(kept.other_tiles.begin(), kept.other_tiles.end());
    kept.other_tiles.erase(std::unique(kept.other_tiles.begin(), kept.other_tiles.end()), kept.other_tiles.end());
    open_.push_back(std::move(kept));
  }
  settle(unread);
}

KeptCluxels::Fate KeptCluxels::fateOf(std::uint32_t number) const {
  if (in_cluster_.contains(number)) return Fate::InCluster;
  const auto at = std::lower_bound(open_.begin(), open_.end(), number,
                                   [](const Kept& kept, std::uint32_t value) { return kept.number < value; });
  return at != open_.end() && at->number == number ? Fate::Open : Fate::Dropped;
}

ChangedCluxels KeptCluxels::assembled(std::vector<Kept>& kept) {
  std::stable_sort(kept.begin(), kept.end(), [](const Kept& a, const Kept& b) { return a.number < b.number; });
  const auto is_same = [](const Kept& a, const Kept& b) { return a.number == b.number; };
  kept.erase(std::unique(kept.begin(), kept.end(), is_same), kept.end());
  ChangedCluxels all;
  all.cluxels.name.resize(kept.size()), all.before.resize(kept.size()), all.after.resize(kept.size());
  for (const Kept& one : kept) {
    all.number.push_back(one.number), all.object.push_back(one.object);
    all.changes.push_back(one.change), all.is_told.push_back(one.is_told);
    all.cluxels.center.push_back(one.center), all.cluxels.low_corner.push_back(one.low_corner);
    all.cluxels.extent.push_back(one.extent), all.places.push_back(one.place);
  }
  all.cluxels.edge_offset.push_back(0);
  for (const Kept& one : kept) {
    for (const std::uint32_t other : one.neighbours) {
      const std::uint32_t index = indexOf(other, all.number);
      if (index < kept.size() && all.number[index] == other) all.cluxels.edge_target.push_back(index);
    }
    all.cluxels.edge_offset.push_back(static_cast<std::uint32_t>(all.cluxels.edge_target.size()));
  }
  return all;
}

void KeptCluxels::settle(const perception::TileSet& unread) {
  ChangedCluxels all = assembled(open_);
  for (std::size_t i = 0; i < open_.size(); ++i)
    (open_[i].change == CluxelChange::Vanished ? all.after : all.before)[i] = open_[i].gone;
  std::vector<bool> stays(open_.size()), settles(open_.size()), is_open(open_.size());
  for (std::size_t i = 0; i < open_.size(); ++i)
    stays[i] = std::any_of(open_[i].other_tiles.begin(), open_[i].other_tiles.end(),
                           [&](const perception::TileKey& tile) { return unread.contains(tile); });
  const auto markNear = [&](const ChangeGroup& group, std::vector<bool>& marked) {
    for (const std::uint32_t cluxel : group) {
      marked[cluxel] = true;
      for (const std::uint32_t other : all.cluxels.neighbours(cluxel)) marked[other] = true;
    }
  };
  const std::vector<bool> reaches_unread = stays;
  for (const ChangeGroup& group : hangingTogether(all)) {
    if (std::none_of(group.begin(), group.end(), [&](std::uint32_t i) { return reaches_unread[i]; })) continue;
    for (const std::uint32_t cluxel : group) is_open[cluxel] = true;
    markNear(group, stays);
  }
  for (const std::size_t kind : {0U, 1U})
    for (const ChangeGroup& cluster : possibleClusters(kKinds[kind], all)) {
      if (is_open[cluster.front()]) continue;
      markNear(cluster, settles);
      std::vector<std::uint32_t>& numbers = clusters_[kind].emplace_back();
      for (const std::uint32_t cluxel : cluster) numbers.push_back(all.number[cluxel]);
      in_cluster_.insert(numbers.begin(), numbers.end());
    }
  std::vector<Kept> open;
  for (std::size_t i = 0; i < open_.size(); ++i) {
    if (settles[i]) settled_.push_back(open_[i]);
    if (stays[i]) open.push_back(std::move(open_[i]));
  }
  open_ = std::move(open);
}

KeptCluxels::Clusters KeptCluxels::take() {
  Clusters clusters{assembled(settled_), {}};
  for (const std::size_t kind : {0U, 1U}) {
    for (const std::vector<std::uint32_t>& numbers : std::exchange(clusters_[kind], {})) {
      ChangeGroup& group = clusters.groups[kind].emplace_back();
      for (const std::uint32_t number : numbers) group.push_back(indexOf(number, clusters.cluxels.number));
    }
    std::sort(clusters.groups[kind].begin(), clusters.groups[kind].end());
  }
  settled_ = {}, open_ = {}, in_cluster_ = {};
  return clusters;
}

}  // namespace cluxel::tasks
