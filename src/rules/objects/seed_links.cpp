// SPDX-License-Identifier: Apache-2.0
// Bounds rule out most pairs. Of two members the one with fewer cluxels is searched around.
#include "rules/objects/seed_links.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "base/parallel.hpp"
#include "rules/decide/threshold_margins.hpp"
#include "rules/propose/fragment_search.hpp"

namespace cluxel::rules {

namespace {

constexpr double kCell_m = 8;
constexpr double kBoundsSlack_m = 1e-3;  ///< bounds and gaps are rounded differently

using Box = Eigen::AlignedBox3d;

/// The members by the cells of a plan grid that their bounds meet.
class MemberCells {
 public:
  explicit MemberCells(const std::vector<Box>& boxes) {
    for (std::size_t i = 0; i < boxes.size(); ++i)
      forEachCell(boxes[i], [&](std::uint64_t key) { cells_[key].push_back(i); });
  }
  /// Members in the cells of the box, ascending.
  template <typename Keep>
  std::vector<std::size_t> near(const Box& box, const Keep& keep) const {
    std::vector<std::size_t> found;
    forEachCell(box, [&](std::uint64_t key) {
      if (const auto cell = cells_.find(key); cell != cells_.end())
        std::copy_if(cell->second.begin(), cell->second.end(), std::back_inserter(found), keep);
    });
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

 private:
  template <typename Visit>
  static void forEachCell(const Box& box, const Visit& visit) {
    const auto cellOf = [](double coordinate_m) {
      return static_cast<std::int32_t>(std::floor(coordinate_m / kCell_m));
    };
    for (std::int32_t x = cellOf(box.min().x()); x <= cellOf(box.max().x()); ++x)
      for (std::int32_t y = cellOf(box.min().y()); y <= cellOf(box.max().y()); ++y)
        visit(std::uint64_t{static_cast<std::uint32_t>(x)} << 32U | static_cast<std::uint32_t>(y));
  }

  std::unordered_map<std::uint64_t, std::vector<std::size_t>> cells_;
};

class Linking {
 public:
  Linking(const ReasoningState& state, const GroupSpec& group, const std::vector<FragmentIndex>& members)
      : state_(state),
        group_(group),
        members_(members),
        margins_(state.context.margins),
        near_m_(searched(group.near_m)),
        horizontal_m_(searched(group.horizontal_m)),
        vertical_m_(searched(group.vertical_m)),
        reach_m_(std::max(near_m_, horizontal_m_)),
        boxes_(boxesOf(state, members)),
        cells_(boxes_),
        rank_(ranksOf(state, members)),
        place_(state.fragments.size(), kNowhere) {
    around_ = Eigen::Vector3d(reach_m_, reach_m_, std::max(near_m_, vertical_m_)).array() + kBoundsSlack_m;
    for (std::size_t i = 0; i < members.size(); ++i) place_[members[i]] = i;
  }

  SeedLinks links() const {
    constexpr std::size_t kChunk = 64;
    std::vector<SeedLinks> of_chunk((members_.size() + kChunk - 1) / kChunk);
    parallelFor(of_chunk.size(), state_.threads(), [&](std::size_t chunk) {
      const std::size_t end = std::min(members_.size(), (chunk + 1) * kChunk);
      for (std::size_t i = chunk * kChunk; i < end; ++i) {
        noteSearch(i);
        for (const auto& [theirs, nearest] : linksOf(i)) take(i, theirs, nearest, of_chunk[chunk]);
      }
    });
    SeedLinks all;
    for (const SeedLinks& some : of_chunk) {
      all.links.insert(all.links.end(), some.links.begin(), some.links.end());
      all.notes.insert(all.notes.end(), some.notes.begin(), some.notes.end());
    }
    std::sort(all.links.begin(), all.links.end(), [](const SeedLink& one, const SeedLink& other) {
      return std::tie(one.gap, one.a, one.b) < std::tie(other.gap, other.a, other.b);
    });
    return all;
  }

 private:
  /// Two cluxels of two members: the nearest that link them, or else the nearest of all that were seen.
  struct Nearest {
    bool is_link = false, is_edge = false;
    double gap = 0;
    CluxelGap apart;
  };
  /// By position: the members of a higher rank.
  using Gaps = std::map<std::size_t, Nearest>;

  double searched(const std::optional<double>& within_m) const {
    return within_m && state_.context.margins != nullptr ? searchedAround(*within_m) : within_m.value_or(0);
  }

  void note(std::size_t member, std::uint32_t threshold, double distance_m) const {
    if (threshold != 0) margins_->note(state_.fragments[members_[member]].primitive, threshold, distance_m);
  }
  /// What is farther away was not looked at.
  void noteSearch(std::size_t member) const {
    if (margins_ == nullptr) return;
    note(member, group_.near_threshold, near_m_);
    note(member, group_.horizontal_threshold, horizontal_m_);
    note(member, group_.vertical_threshold, vertical_m_);
  }

  bool isNear(double gap_m) const { return group_.near_m && gap_m <= *group_.near_m; }
  bool isStacked(const CluxelGap& gap) const {
    return group_.horizontal_m && gap.horizontal <= *group_.horizontal_m && gap.vertical <= *group_.vertical_m;
  }

  void take(std::size_t mine, std::size_t theirs, const Nearest& nearest, SeedLinks& found) const {
    const auto [a, b] = std::minmax(mine, theirs);
    if (nearest.is_link) found.links.push_back({nearest.gap, a, b});
    if (margins_ == nullptr || nearest.is_edge) return;
    const auto add = [&, a = a, b = b](std::uint32_t threshold, double distance_m) {
      found.notes.push_back({threshold, distance_m, a, b});
    };
    if (!nearest.is_link || isNear(nearest.gap)) {
      if (group_.near_m) add(group_.near_threshold, nearest.gap);
    } else {
      add(group_.horizontal_threshold, nearest.apart.horizontal);
      add(group_.vertical_threshold, nearest.apart.vertical);
    }
  }

  static std::vector<Box> boxesOf(const ReasoningState& state, const std::vector<FragmentIndex>& members) {
    std::vector<Box> boxes;
    boxes.reserve(members.size());
    for (const FragmentIndex member : members) {
      const Outline& outline = state.fragments.outlineOf(member);
      boxes.emplace_back(outline.min, outline.max);
    }
    return boxes;
  }

  /// Members with more cluxels have a higher rank; of equally many, the later one.
  static std::vector<std::size_t> ranksOf(const ReasoningState& state, const std::vector<FragmentIndex>& members) {
    std::vector<std::size_t> order(members.size()), rank(members.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return state.fragments[members[a]].cluxels.size() < state.fragments[members[b]].cluxels.size();
    });
    for (std::size_t i = 0; i < order.size(); ++i) rank[order[i]] = i;
    return rank;
  }

  Box around(const Box& box) const { return {box.min() - around_, box.max() + around_}; }

  Gaps linksOf(std::size_t mine) const {
    Gaps gaps;
    const std::vector<std::uint32_t>& cluxels = state_.fragments[members_[mine]].cluxels;
    if (group_.adjacent)
      for (const std::uint32_t cluxel : cluxels)
        for (const std::uint32_t other : state_.scene.cluxels.neighbours(cluxel)) linkByEdge(mine, other, gaps);
    if (!group_.near_m && !group_.horizontal_m) return gaps;
    const Box mine_around = around(boxes_[mine]);
    const std::vector<std::size_t> partners = cells_.near(mine_around, [&](std::size_t other) {
      return rank_[other] > rank_[mine] && mine_around.intersects(boxes_[other]);
    });
    if (partners.empty()) return gaps;
    for (const std::uint32_t cluxel : cluxels)
      if (isNearAny(cluxel, partners)) lookAround(mine, cluxel, gaps);
    return gaps;
  }

  bool isNearAny(std::uint32_t cluxel, const std::vector<std::size_t>& partners) const {
    const Eigen::Vector3d half = state_.scene.cluxels.extent[cluxel].cast<double>() / 2;
    const Eigen::Vector3d& centre = state_.scene.cluxels.center[cluxel];
    const Box box = around({centre - half, centre + half});
    return std::any_of(partners.begin(), partners.end(),
                       [&](std::size_t other) { return box.intersects(boxes_[other]); });
  }

  void lookAround(std::size_t mine, std::uint32_t cluxel, Gaps& gaps) const {
    const auto look = [&](std::uint32_t other) { consider(mine, cluxel, other, gaps); };
    if (group_.horizontal_m)
      state_.grid.nearInPlan(cluxel, reach_m_, look);
    else
      state_.grid.near(cluxel, reach_m_, look);
  }

  void consider(std::size_t mine, std::uint32_t cluxel, std::uint32_t other, Gaps& gaps) const {
    const std::size_t theirs = place_[state_.fragments.fragmentOf(other)];
    if (theirs == kNowhere || rank_[theirs] <= rank_[mine]) return;
    const CluxelGap apart = gapBetween(state_.scene.cluxels, cluxel, other);
    const double gap = apart.gap();
    const bool is_link = isNear(gap) || isStacked(apart);
    if (!is_link && margins_ == nullptr) return;
    const auto [entry, fresh] = gaps.try_emplace(theirs, Nearest{is_link, false, gap, apart});
    Nearest& nearest = entry->second;
    if (!is_link && group_.horizontal_m && (fresh || !nearest.is_link || gap < nearest.gap)) noteApart(mine, apart);
    if (!fresh && (is_link > nearest.is_link || (is_link == nearest.is_link && gap < nearest.gap)))
      nearest = {is_link, false, gap, apart};
  }

  /// Were these two cluxels stacked, the order of the links would change.
  void noteApart(std::size_t mine, const CluxelGap& apart) const {
    if (group_.near_m) note(mine, group_.near_threshold, apart.gap());
    if (apart.horizontal > *group_.horizontal_m)
      note(mine, group_.horizontal_threshold, apart.horizontal);
    else
      note(mine, group_.vertical_threshold, apart.vertical);
  }

  void linkByEdge(std::size_t mine, std::uint32_t other, Gaps& gaps) const {
    const std::size_t theirs = place_[state_.fragments.fragmentOf(other)];
    if (theirs == kNowhere || rank_[theirs] <= rank_[mine]) return;
    gaps.insert_or_assign(theirs, Nearest{true, true, 0, {}});
  }

  const ReasoningState& state_;
  const GroupSpec& group_;
  const std::vector<FragmentIndex>& members_;
  ThresholdMargins* margins_;
  double near_m_, horizontal_m_, vertical_m_;  ///< how far is looked
  double reach_m_;                             ///< in plan view
  std::vector<Box> boxes_;
  MemberCells cells_;
  std::vector<std::size_t> rank_;
  static constexpr std::size_t kNowhere = static_cast<std::size_t>(-1);
  std::vector<std::size_t> place_;  ///< per fragment
  Eigen::Vector3d around_;          ///< how far a group looks around bounds
};

/// By place among all that are known the place among the members; kNoPlace for others. Both are in the same order.
/// Absent when some member is not known.
constexpr std::size_t kNoPlace = static_cast<std::size_t>(-1);
std::optional<std::vector<std::size_t>> placesOf(const std::vector<FragmentIndex>& members,
                                                 const std::vector<FragmentIndex>& known) {
  std::vector<std::size_t> places(known.size(), kNoPlace);
  std::size_t next = 0;
  for (std::size_t i = 0; i < known.size() && next < members.size(); ++i)
    if (known[i] == members[next]) places[i] = next++;
  return next == members.size() ? std::optional(std::move(places)) : std::nullopt;
}

/// Those between two members, by their places.
template <typename Link>
std::vector<Link> amongMembers(const std::vector<Link>& links, const std::vector<std::size_t>& places) {
  std::vector<Link> some;
  for (Link link : links) {
    link.a = places[link.a], link.b = places[link.b];
    if (link.a != kNoPlace && link.b != kNoPlace) some.push_back(link);
  }
  return some;
}

}  // namespace

SeedLinks seedLinks(const ReasoningState& state, const GroupSpec& group, const std::vector<FragmentIndex>& members,
                    KnownLinks* known) {
  if (known == nullptr) return Linking(state, group, members).links();
  if (const auto places = placesOf(members, known->members))
    return {amongMembers(known->links.links, *places), amongMembers(known->links.notes, *places)};
  *known = {members, Linking(state, group, members).links()};
  return known->links;
}

}  // namespace cluxel::rules
