// SPDX-License-Identifier: Apache-2.0
// A tree over boxes of up to eight dimensions in memory, packed at once: for joins by ranges and by distance.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "sparql/exec/guard.hpp"

namespace cluxel::sparql {

/// A closed interval; by default the whole axis.
struct Interval {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();

  bool meets(const Interval& other) const { return low <= other.high && other.low <= high; }
};

class BoxTree {
 public:
  static constexpr std::size_t kMaxDimensions = 8;
  using Box = std::array<Interval, kMaxDimensions>;  ///< the first dimensions() intervals count

  explicit BoxTree(std::size_t dimensions = 2) : dimensions_(dimensions) {}
  std::size_t dimensions() const { return dimensions_; }
  std::size_t size() const { return rows_.size(); }
  std::size_t bytes() const;

  /// Adds a box under a row number. No bound may be NaN.
  void add(const Box& box, std::uint32_t row);
  /// Packs the tree: after the last add(), before the first search. Throws Error (BudgetExceeded) beyond the guard's
  /// deadline, and when its memory does not fit.
  void pack(const Guard& guard);
  void clear();

  /// Calls `take(row)` for every box that meets `query_box`.
  template <typename Take>
  void search(const Box& query_box, const Take& take) const {
    if (nodes_.empty()) return;
    std::array<std::uint32_t, kMaxDepth> open{};
    std::size_t count = 0;
    open[count++] = 0;
    while (count > 0) {
      const std::uint32_t at = open[--count];
      const Node& node = nodes_[at];
      if (!meets(node_bounds_, at, query_box)) continue;
      if (node.right != 0) {
        open[count++] = node.right;
        open[count++] = at + 1;
        continue;
      }
      for (std::uint32_t i = node.first; i < node.last; ++i) {
        if (meets(bounds_, i, query_box)) take(rows_[i]);
      }
    }
  }

  /// Calls `take(row, distance)` by ascending distance between the first two dimensions of the boxes and of `from`,
  /// until it returns false.
  template <typename Take>
  void nearest(const Box& from, const Take& take) const {
    std::vector<Open> open;
    if (!nodes_.empty()) push(open, {distance(node_bounds_, 0, from), 0, false});
    while (!open.empty()) {
      const Open next = pop(open);
      if (next.is_row) {
        if (!take(rows_[next.at], next.distance)) return;
        continue;
      }
      const Node& node = nodes_[next.at];
      if (node.right != 0) {
        for (const std::uint32_t child : {next.at + 1, node.right})
          push(open, {distance(node_bounds_, child, from), child, false});
        continue;
      }
      for (std::uint32_t i = node.first; i < node.last; ++i) push(open, {distance(bounds_, i, from), i, true});
    }
  }

 private:
  static constexpr std::size_t kLeafRows = 8, kMaxDepth = 64;
  struct Node {
    std::uint32_t first = 0, last = 0;  ///< the rows below it
    std::uint32_t right = 0;            ///< its second child; the first one follows it; 0 for a leaf
  };
  struct Open {
    double distance;
    std::uint32_t at;
    bool is_row;
  };

  bool meets(const std::vector<Interval>& bounds, std::size_t at, const Box& query_box) const {
    const Interval* own = bounds.data() + at * dimensions_;
    for (std::size_t i = 0; i < dimensions_; ++i) {
      if (!own[i].meets(query_box[i])) return false;
    }
    return true;
  }
  double distance(const std::vector<Interval>& bounds, std::size_t at, const Box& from) const;
  static void push(std::vector<Open>& open, const Open& entry);
  static Open pop(std::vector<Open>& open);
  std::uint32_t packed(std::uint32_t first, std::uint32_t last, std::vector<std::uint32_t>& order, const Guard& guard);
  void appendBounds(std::uint32_t first, std::uint32_t last, const std::vector<std::uint32_t>& order);
  std::size_t widest(std::size_t node) const;

  std::size_t dimensions_;
  std::vector<Node> nodes_;  ///< in preorder
  std::vector<Interval> node_bounds_, bounds_;
  std::vector<std::uint32_t> rows_;
};

/// Trees by the numbers of coordinate systems.
using SystemTrees = std::vector<BoxTree>;
BoxTree& treeOf(std::uint32_t system, SystemTrees& trees, std::size_t dimensions);
std::size_t bytesOf(const SystemTrees& trees);

}  // namespace cluxel::sparql
