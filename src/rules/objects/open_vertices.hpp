// SPDX-License-Identifier: Apache-2.0
// The queue of a search for shortest paths: vertices that are reached and not settled.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

#include "rules/objects/crown_splitting.hpp"

namespace cluxel::rules {

/// Length of a path, and the place of its source in the group. Shorter paths come first; of equal ones, the one from
/// the first source.
struct Way {
  double length = 0;
  std::uint32_t source = 0;
  bool operator==(const Way&) const = default;
  bool operator<(const Way& other) const {
    return length != other.length ? length < other.length : source < other.source;
  }
};
inline constexpr Way kNoWay{std::numeric_limits<double>::infinity(), kNoSource};

/// A vertex with a path that may be the shortest.
struct OpenVertex {
  Way way;
  std::uint32_t at = 0;
  bool operator<(const OpenVertex& other) const { return other.way < way; }  // the shortest on top of a heap
};

/// Open vertices, shortest path first. Only the next ones are in a heap: of those farther away most have got a shorter
/// path when it is their turn.
class OpenVertices {
 public:
  void push(const OpenVertex& open) {
    const std::size_t number = std::min(static_cast<std::size_t>(open.way.length / kBucket_m), kMaxBuckets);
    if (number <= now_) return next_.push(open);
    if (number >= later_.size()) later_.resize(number + 1);
    later_[number].push_back(open);
  }
  /// Null when there is none. Those that are not the `best` to their vertex are dropped.
  const OpenVertex* top(const std::vector<Way>& best) {
    const auto isBest = [&](const OpenVertex& open) { return open.way == best[open.at]; };
    while (true) {
      while (!next_.empty() && !isBest(next_.top())) next_.pop();
      if (!next_.empty()) return &next_.top();
      if (now_ + 1 >= later_.size()) return nullptr;
      for (const OpenVertex& open : std::exchange(later_[++now_], {}))
        if (isBest(open)) next_.push(open);
    }
  }
  void pop() { next_.pop(); }

 private:
  static constexpr double kBucket_m = 0.25;            // about the length of an edge
  static constexpr std::size_t kMaxBuckets = 1 << 12;  // what is farther away shares a bucket

  std::priority_queue<OpenVertex> next_;        ///< of the buckets up to now_
  std::vector<std::vector<OpenVertex>> later_;  ///< by length
  std::size_t now_ = 0;
};

}  // namespace cluxel::rules
