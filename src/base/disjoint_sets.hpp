// SPDX-License-Identifier: Apache-2.0
// Union-find with path halving; the smallest member stands for its set, so that numbering follows the members' order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace cluxel {

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0U); }

  std::uint32_t find(std::uint32_t member) {
    while (parent_[member] != member) member = parent_[member] = parent_[parent_[member]];
    return member;
  }

  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a), b = find(b);
    if (b < a) std::swap(a, b);
    parent_[b] = a;
  }

  /// The set of each member, numbered from 0 in the order of first members.
  std::vector<std::uint32_t> numbers() {
    std::vector<std::uint32_t> number(parent_.size());
    std::uint32_t next = 0;
    for (std::uint32_t member = 0; member < parent_.size(); ++member)
      number[member] = find(member) == member ? next++ : number[find(member)];
    return number;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace cluxel
