// SPDX-License-Identifier: Apache-2.0
// Bounds rule out most pairs. Of two members the one with fewer cluxels is searched around.
#include "rules/objects/seed_links.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>
#include <unordered_map>

#include "base/parallel.hpp"

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
        reach_m_(std::max(group.near_m.value_or(0), group.horizontal_m.value_or(0))),
        boxes_(boxesOf(state, members)),
        cells_(boxes_),
        rank_(ranksOf(state, members)),
        place_(state.fragments.size(), kNowhere) {
    const double height = std::max(group.near_m.value_or(0), group.vertical_m.value_or(0));
    around_ = Eigen::Vector3d(reach_m_, reach_m_, height).array() + kBoundsSlack_m;
    for (std::size_t i = 0; i < members.size(); ++i) place_[members[i]] = i;
  }

  std::vector<SeedLink> links() const {
    constexpr std::size_t kChunk = 64;
    std::vector<std::vector<SeedLink>> of_chunk((members_.size() + kChunk - 1) / kChunk);
    parallelFor(of_chunk.size(), state_.threads(), [&](std::size_t chunk) {
      const std::size_t end = std::min(members_.size(), (chunk + 1) * kChunk);
      for (std::size_t i = chunk * kChunk; i < end; ++i)
        for (const auto& [theirs, gap] : linksOf(i))
          of_chunk[chunk].push_back({gap, std::min(i, theirs), std::max(i, theirs)});
    });
    std::vector<SeedLink> links;
    for (const std::vector<SeedLink>& some : of_chunk) links.insert(links.end(), some.begin(), some.end());
    std::sort(links.begin(), links.end(), [](const SeedLink& one, const SeedLink& other) {
      return std::tie(one.gap, one.a, one.b) < std::tie(other.gap, other.a, other.b);
    });
    return links;
  }

 private:
  /// By position: the members of a higher rank that a link leads to, with the gap.
  using Gaps = std::map<std::size_t, double>;

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
        for (const std::uint32_t other : state_.scene.cluxels.neighbours(cluxel)) link(mine, other, 0, gaps);
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
    const CluxelGap gap = gapBetween(state_.scene.cluxels, cluxel, other);
    const bool near = group_.near_m && gap.gap() <= *group_.near_m;
    const bool stacked =
        group_.horizontal_m && gap.horizontal <= *group_.horizontal_m && gap.vertical <= *group_.vertical_m;
    if (near || stacked) link(mine, other, gap.gap(), gaps);
  }

  void link(std::size_t mine, std::uint32_t other, double gap, Gaps& gaps) const {
    const std::size_t theirs = place_[state_.fragments.fragmentOf(other)];
    if (theirs == kNowhere || rank_[theirs] <= rank_[mine]) return;
    const auto [entry, fresh] = gaps.try_emplace(theirs, gap);
    if (!fresh) entry->second = std::min(entry->second, gap);
  }

  const ReasoningState& state_;
  const GroupSpec& group_;
  const std::vector<FragmentIndex>& members_;
  double reach_m_;
  std::vector<Box> boxes_;
  MemberCells cells_;
  std::vector<std::size_t> rank_;
  static constexpr std::size_t kNowhere = static_cast<std::size_t>(-1);
  std::vector<std::size_t> place_;  ///< per fragment
  Eigen::Vector3d around_;          ///< how far a group looks around bounds
};

}  // namespace

std::vector<SeedLink> seedLinks(const ReasoningState& state, const GroupSpec& group,
                                const std::vector<FragmentIndex>& members) {
  return Linking(state, group, members).links();
}

}  // namespace cluxel::rules
