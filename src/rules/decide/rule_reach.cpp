// SPDX-License-Identifier: Apache-2.0
// The reach of a rule is the largest distance at which one of its conditions looks.
#include "rules/decide/rule_reach.hpp"

#include <algorithm>
#include <cmath>

#include "rules/propose/evidence.hpp"
#include "rules/propose/pair_measures.hpp"

namespace cluxel::rules {

namespace {

constexpr double kCell_m = 4;
constexpr double kMaxCells = 400;  ///< boxes over more cells count as large

using Reach = std::optional<double>;

Reach larger(const Reach& a, const Reach& b) {
  return a && b ? Reach(std::max(*a, *b)) : std::nullopt;
}

/// Relations between primitives that touch, or of which one is above the other.
bool isClose(perception::RelationKind kind) {
  using Kind = perception::RelationKind;
  return kind == Kind::Intersects || kind == Kind::Touches || kind == Kind::Near || kind == Kind::Above ||
         kind == Kind::Below || kind == Kind::Supports || kind == Kind::StandsOn || kind == Kind::Inside;
}

Reach reachOf(const Condition& condition, const CluxelGrid& grid, double limit_m) {
  using Kind = Condition::Kind;
  switch (condition.kind) {
    case Kind::Attribute:
    case Kind::Label:
    case Kind::Class:
      return 0;
    case Kind::Pair:
      if (condition.measure == PairMeasure::VerticalGap) return std::nullopt;
      return std::min(limit_m, kMaxMeasure_m) + kMeasureMargin_m + grid.slack_m();
    case Kind::Relation:
      if (condition.relation == perception::RelationKind::TouchesGround) return 0;
      return isClose(condition.relation) ? Reach(1 + grid.slack_m()) : std::nullopt;
    case Kind::Ask:
      return std::nullopt;
    default:
      break;
  }
  Reach reach = 0;
  for (const Condition& operand : condition.operands) reach = larger(reach, reachOf(operand, grid, limit_m));
  return reach;
}

double largestLimit(const Condition& condition) {
  double limit = std::max(condition.value ? condition.value->value : 0, condition.upper ? condition.upper->value : 0);
  for (const Condition& operand : condition.operands) limit = std::max(limit, largestLimit(operand));
  return limit;
}

Reach reachOf(const Condition& condition, const CluxelGrid& grid) {
  return reachOf(condition, grid, largestLimit(condition));
}

Reach reachOf(const std::vector<EvidenceLine>& lines, const CluxelGrid& grid) {
  Reach reach = 0;
  for (const EvidenceLine& line : lines) {
    const double limit = line.kind == EvidenceLine::Kind::Test ? largestLimit(line.measure) : reachOf(line);
    reach = larger(reach, reachOf(line.measure, grid, limit));
  }
  return reach;
}

std::uint64_t cellOf(std::int32_t x, std::int32_t y) {
  return std::uint64_t{static_cast<std::uint32_t>(x)} << 32U | static_cast<std::uint32_t>(y);
}

struct CellRange {
  std::int32_t low_x = 0, high_x = 0, low_y = 0, high_y = 0;
  bool is_large = false;
};

CellRange cellsOf(const Eigen::AlignedBox2d& box, double around_m) {
  const Eigen::Vector2d low = (box.min().array() - around_m) / kCell_m, high = (box.max().array() + around_m) / kCell_m;
  if ((high - low).prod() > kMaxCells) return {0, 0, 0, 0, true};
  const auto whole = [](double value) { return static_cast<std::int32_t>(std::floor(value)); };
  return {whole(low.x()), whole(high.x()), whole(low.y()), whole(high.y()), false};
}

}  // namespace

std::optional<double> reachOf(const Rule& rule, const CluxelGrid& grid) {
  Reach reach = reachOf(rule.evidence, grid);
  for (const TreeNode& node : rule.nodes) {
    if (std::holds_alternative<FindNode>(node.what)) return std::nullopt;  // what it finds may reach far
    if (const auto* branch = std::get_if<BranchNode>(&node.what))
      reach = larger(reach, reachOf(branch->condition, grid));
    if (const auto* accept = std::get_if<AcceptLeaf>(&node.what))
      reach = larger(reach, reachOf(accept->evidence, grid));
  }
  return reach;
}

void NearbyChanges::add(const Eigen::AlignedBox2d& box) {
  ++count_;
  const CellRange cells = cellsOf(box, 0);
  if (cells.is_large) {
    last_large_ = count_;
    return;
  }
  for (std::int32_t x = cells.low_x; x <= cells.high_x; ++x)
    for (std::int32_t y = cells.low_y; y <= cells.high_y; ++y) last_[cellOf(x, y)] = count_;
}

bool NearbyChanges::anyNear(const Eigen::AlignedBox2d& box, std::uint32_t known) const {
  if (count_ == known) return false;
  const CellRange cells = cellsOf(box, reach_m_);
  if (cells.is_large || last_large_ > known) return true;
  for (std::int32_t x = cells.low_x; x <= cells.high_x; ++x)
    for (std::int32_t y = cells.low_y; y <= cells.high_y; ++y)
      if (const auto found = last_.find(cellOf(x, y)); found != last_.end() && found->second > known) return true;
  return false;
}

}  // namespace cluxel::rules
