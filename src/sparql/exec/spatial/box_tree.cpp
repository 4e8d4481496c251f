// SPDX-License-Identifier: Apache-2.0
// Packs box trees by halving along the widest axis.
#include "sparql/exec/spatial/box_tree.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace cluxel::sparql {
namespace {

constexpr auto isFartherBox = [](const auto& a, const auto& b) { return a.distance > b.distance; };

}  // namespace

std::size_t BoxTree::bytes() const {
  return nodes_.capacity() * sizeof(Node) + (node_bounds_.capacity() + bounds_.capacity()) * sizeof(Interval) +
         rows_.capacity() * sizeof(std::uint32_t);
}

void BoxTree::add(const Box& box, std::uint32_t row) {
  bounds_.insert(bounds_.end(), box.begin(), box.begin() + static_cast<std::ptrdiff_t>(dimensions_));
  rows_.push_back(row);
}

void BoxTree::clear() {
  nodes_.clear();
  node_bounds_.clear();
  bounds_.clear();
  rows_.clear();
}

void BoxTree::pack(const Guard& guard) {
  if (rows_.empty()) return;
  guard.requireRoomFor(3 * bytes());
  std::vector<std::uint32_t> order(rows_.size());
  std::iota(order.begin(), order.end(), 0U);
  packed(0, static_cast<std::uint32_t>(rows_.size()), order, guard);
  std::vector<Interval> bounds(bounds_.size());
  std::vector<std::uint32_t> rows(rows_.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    rows[i] = rows_[order[i]];
    std::copy_n(bounds_.begin() + static_cast<std::ptrdiff_t>(order[i] * dimensions_), dimensions_,
                bounds.begin() + static_cast<std::ptrdiff_t>(i * dimensions_));
  }
  bounds_ = std::move(bounds);
  rows_ = std::move(rows);
}

void BoxTree::appendBounds(std::uint32_t first, std::uint32_t last, const std::vector<std::uint32_t>& order) {
  for (std::size_t axis = 0; axis < dimensions_; ++axis) {
    Interval all{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (std::uint32_t i = first; i < last; ++i) {
      const Interval& one = bounds_[order[i] * dimensions_ + axis];
      all = {std::min(all.low, one.low), std::max(all.high, one.high)};
    }
    node_bounds_.push_back(all);
  }
}

std::size_t BoxTree::widest(std::size_t node) const {
  std::size_t best = 0;
  double widest = -1;
  for (std::size_t axis = 0; axis < dimensions_; ++axis) {
    const Interval& own = node_bounds_[node * dimensions_ + axis];
    const double width = own.high - own.low;
    if (!(width > widest)) continue;
    best = axis;
    widest = width;
  }
  return best;
}

std::uint32_t BoxTree::packed(std::uint32_t first, std::uint32_t last, std::vector<std::uint32_t>& order,
                              const Guard& guard) {
  constexpr std::uint32_t kRowsOfCheck = 4096;
  if (last - first > kRowsOfCheck) guard.checkTime();
  const auto self = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({first, last, 0});
  appendBounds(first, last, order);
  if (last - first <= kLeafRows) return self;
  const std::size_t axis = widest(self);
  const auto centre = [&](std::uint32_t entry) {
    const Interval& own = bounds_[entry * dimensions_ + axis];
    return own.low + own.high;
  };
  const std::uint32_t middle = first + (last - first) / 2;
  std::nth_element(order.begin() + first, order.begin() + middle, order.begin() + last,
                   [&](std::uint32_t a, std::uint32_t b) { return centre(a) < centre(b); });
  packed(first, middle, order, guard);
  nodes_[self].right = packed(middle, last, order, guard);
  return self;
}

double BoxTree::distance(const std::vector<Interval>& bounds, std::size_t at, const Box& from) const {
  const Interval* own = bounds.data() + at * dimensions_;
  const double dx = std::max({0.0, own[0].low - from[0].high, from[0].low - own[0].high});
  const double dy = std::max({0.0, own[1].low - from[1].high, from[1].low - own[1].high});
  return std::sqrt(dx * dx + dy * dy);
}

void BoxTree::push(std::vector<Open>& open, const Open& entry) {
  open.push_back(entry);
  std::push_heap(open.begin(), open.end(), isFartherBox);
}

BoxTree::Open BoxTree::pop(std::vector<Open>& open) {
  std::pop_heap(open.begin(), open.end(), isFartherBox);
  const Open next = open.back();
  open.pop_back();
  return next;
}

BoxTree& treeOf(std::uint32_t system, SystemTrees& trees, std::size_t dimensions) {
  while (trees.size() <= system) trees.emplace_back(dimensions);
  return trees[system];
}

std::size_t bytesOf(const SystemTrees& trees) {
  std::size_t bytes = 0;
  for (const BoxTree& tree : trees) bytes += tree.bytes();
  return bytes;
}

}  // namespace cluxel::sparql
