// SPDX-License-Identifier: Apache-2.0
// Cells are sorted along x. Then a cell touches only cells of its own slice and of the slice before.
#include "tasks/evaluation/touching_trees.hpp"

#include <algorithm>
#include <string>
#include <utility>

namespace cluxel::tasks {

namespace {

constexpr double kTouchCell_m = 0.25;

/// Points of a scan come near each other: so many of them lie in few cells.
constexpr std::size_t kNewest = 1U << 18U;

}  // namespace

void TouchingTrees::add(const Eigen::Vector3d& p_map, std::int32_t tree) {
  const Eigen::Vector3d cell = (p_map / kTouchCell_m).array().floor();
  newest_.push_back({static_cast<std::int32_t>(cell.x()), static_cast<std::int32_t>(cell.y()),
                     static_cast<std::int32_t>(cell.z()), tree});
  if (newest_.size() == kNewest) sortNewest();
}

void TouchingTrees::sortNewest() {
  std::sort(newest_.begin(), newest_.end());
  newest_.erase(std::unique(newest_.begin(), newest_.end()), newest_.end());
  std::string record;
  for (const TreeInCell& here : newest_) {
    record.clear();
    for (const std::int32_t value : {here.x, here.y, here.z, here.tree}) {
      const std::uint32_t biased = static_cast<std::uint32_t>(value) ^ 0x80000000U;  // bytes sort as numbers do
      for (int shift = 24; shift >= 0; shift -= 8) record += static_cast<char>(biased >> shift & 0xFFU);
    }
    cells_.add(record);
  }
  newest_.clear();
}

TouchingTrees::TreeInCell TouchingTrees::readFrom(std::string_view record) {
  std::array<std::int32_t, 4> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::uint32_t biased = 0;
    for (std::size_t byte = 0; byte < 4; ++byte)
      biased = biased << 8U | static_cast<std::uint8_t>(record[4 * i + byte]);
    values[i] = static_cast<std::int32_t>(biased ^ 0x80000000U);
  }
  return {values[0], values[1], values[2], values[3]};
}

void TouchingTrees::addPairs(const Slice& slice, const Slice& beside, Pairs& pairs) {
  if (slice.empty() || beside.empty() || slice.front().x - beside.front().x > 1) return;
  for (int step = -1; step <= 1; ++step) {
    auto first = beside.begin();  // both are sorted: it only moves on
    for (const TreeInCell& here : slice) {
      const auto place = [](const TreeInCell& cell) { return std::pair(cell.y, cell.z); };
      const std::pair low(here.y + step, here.z - 1), high(here.y + step, here.z + 1);
      while (first != beside.end() && place(*first) < low) ++first;
      for (auto other = first; other != beside.end() && place(*other) <= high; ++other)
        if (other->tree != here.tree)
          pairs.insert({std::min(other->tree, here.tree), std::max(other->tree, here.tree)});
    }
  }
}

std::set<std::array<std::int32_t, 2>> TouchingTrees::takePairs() {
  sortNewest();
  Pairs pairs;
  Slice slice, before;
  const auto finishSlice = [&] {
    addPairs(slice, slice, pairs);
    addPairs(slice, before, pairs);
    before = std::exchange(slice, {});
  };
  cells_.drain([&](std::string_view record) {
    const TreeInCell cell = readFrom(record);
    if (!slice.empty() && slice.front().x != cell.x) finishSlice();
    slice.push_back(cell);
  });
  finishSlice();
  return pairs;
}

}  // namespace cluxel::tasks
