// SPDX-License-Identifier: Apache-2.0
// Sheets are found in a histogram of cells across the direction in which they lie.
#include "tasks/changes/side_by_side.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace cluxel::tasks {

namespace {

constexpr double kSlice_m = 0.1, kMinLength_m = 0.6, kMinHeight_m = 0.5;
constexpr int kDirections = 36, kPeak = 2, kLeastBetween = 4, kMostBetween = 8;  ///< the last three in slices
constexpr double kLowest = 0.15, kValley = 0.12, kSmallest = 0.2, kInSheets = 0.7;
constexpr std::size_t kMinCells = 12;

/// The cells of a group in slices across a direction.
struct Slices {
  Eigen::Vector2d across = Eigen::Vector2d::UnitX();
  std::vector<int> of_cell;  ///< parallel to the group
  std::vector<std::size_t> cells;

  double crowding() const {
    double sum = 0;
    for (const std::size_t count : cells) sum += static_cast<double>(count * count);
    return sum;
  }

  /// The cells of a slice, with half of those beside it.
  double weight(int slice) const { return count(slice) + (count(slice - 1) + count(slice + 1)) / 2; }

 private:
  double count(int slice) const {
    const bool is_there = slice >= 0 && slice < static_cast<int>(cells.size());
    return is_there ? static_cast<double>(cells[static_cast<std::size_t>(slice)]) : 0;
  }
};

Slices slicesAcross(const Eigen::Vector2d& across, const std::vector<PointCell>& cells, const ChangeGroup& group) {
  std::vector<double> along_m;
  for (const std::uint32_t cell : group) along_m.push_back(across.dot(cells[cell].place.head<2>()));
  const double first_m = *std::min_element(along_m.begin(), along_m.end());
  Slices slices{across, {}, {}};
  for (const double at_m : along_m) {
    const auto slice = static_cast<std::size_t>((at_m - first_m) / kSlice_m);
    slices.of_cell.push_back(static_cast<int>(slice));
    if (slices.cells.size() <= slice) slices.cells.resize(slice + 1, 0);
    ++slices.cells[slice];
  }
  return slices;
}

Slices mostCrowded(const std::vector<PointCell>& cells, const ChangeGroup& group) {
  Slices best;
  for (int i = 0; i < kDirections; ++i) {
    const double angle = i * std::numbers::pi / kDirections;
    Slices slices = slicesAcross({std::cos(angle), std::sin(angle)}, cells, group);
    if (slices.crowding() > best.crowding()) best = std::move(slices);
  }
  return best;
}

/// Whether no slice near it weighs more; the first of several that weigh as much.
bool isPeak(int slice, const Slices& slices) {
  for (int other = slice - kPeak; other <= slice + kPeak; ++other)
    if (slices.weight(other) > slices.weight(slice) - (other < slice ? 1e-9 : -1e-9)) return false;
  return true;
}

/// Whether the cells in a slice and beside it stand upright and are long enough for a thing of its own.
bool isUpright(const ChangeGroup& group, const std::vector<PointCell>& cells, const Slices& slices, int slice) {
  const Eigen::Vector2d lengthwise(-slices.across.y(), slices.across.x());
  Eigen::AlignedBox2d extent;  // along the sheet and in height
  std::size_t count = 0;
  for (std::size_t i = 0; i < group.size(); ++i) {
    if (std::abs(slices.of_cell[i] - slice) > 1) continue;
    const Eigen::Vector3d& place = cells[group[i]].place;
    extent.extend(Eigen::Vector2d(lengthwise.dot(place.head<2>()), place.z()));
    ++count;
  }
  return count >= kMinCells && extent.sizes().x() >= kMinLength_m && extent.sizes().y() >= kMinHeight_m;
}

bool isValleyBetween(int first, int second, const Slices& slices) {
  const auto begin = slices.cells.begin();
  const auto least = static_cast<double>(*std::min_element(begin + first, begin + second));
  return least <= kValley * std::min(slices.weight(first), slices.weight(second));
}

/// The middle slices of sheets.
std::vector<int> sheetsIn(const Slices& slices, const std::vector<PointCell>& cells, const ChangeGroup& group) {
  const int count = static_cast<int>(slices.cells.size());
  double most = 0;
  for (int slice = 0; slice < count; ++slice) most = std::max(most, slices.weight(slice));
  std::vector<int> sheets;
  for (int slice = 0; slice < count; ++slice) {
    if (slices.weight(slice) < kLowest * most || !isPeak(slice, slices) || !isUpright(group, cells, slices, slice))
      continue;
    if (sheets.empty() || isValleyBetween(sheets.back(), slice, slices))
      sheets.push_back(slice);
    else if (slices.weight(slice) > slices.weight(sheets.back()))
      sheets.back() = slice;
  }
  return sheets;
}

/// Whether sheets stand so near to each other that they may touch, and most of the cells lie in them.
bool areSideBySide(const std::vector<int>& sheets, const Slices& slices) {
  for (std::size_t i = 1; i < sheets.size(); ++i)
    if (sheets[i] - sheets[i - 1] < kLeastBetween || sheets[i] - sheets[i - 1] > kMostBetween) return false;
  const auto is_in_sheet = [&](int slice) {
    return std::any_of(sheets.begin(), sheets.end(), [&](int sheet) { return std::abs(slice - sheet) <= 1; });
  };
  const auto in_sheets = std::count_if(slices.of_cell.begin(), slices.of_cell.end(), is_in_sheet);
  return static_cast<double>(in_sheets) >= kInSheets * static_cast<double>(slices.of_cell.size());
}

std::vector<ChangeGroup> splitBetween(const std::vector<int>& sheets, const Slices& slices, const ChangeGroup& group) {
  std::vector<ChangeGroup> parts(sheets.size());
  for (std::size_t i = 0; i < group.size(); ++i) {
    const auto nearest = std::min_element(sheets.begin(), sheets.end(), [&](int a, int b) {
      return std::abs(slices.of_cell[i] - a) < std::abs(slices.of_cell[i] - b);
    });
    parts[static_cast<std::size_t>(nearest - sheets.begin())].push_back(group[i]);
  }
  return parts;
}

bool areOfLikeSize(const std::vector<ChangeGroup>& parts) {
  const auto [least, most] = std::minmax_element(
      parts.begin(), parts.end(), [](const ChangeGroup& a, const ChangeGroup& b) { return a.size() < b.size(); });
  return static_cast<double>(least->size()) >= kSmallest * static_cast<double>(most->size());
}

bool isFoliage(const std::vector<PointCell>& cells, const ChangeGroup& group) {
  const auto foliage =
      std::count_if(group.begin(), group.end(), [&](std::uint32_t cell) { return cells[cell].is_foliage; });
  return 2 * static_cast<std::size_t>(foliage) >= group.size();
}

}  // namespace

std::vector<ChangeGroup> sheetsOf(const std::vector<PointCell>& cells, const ChangeGroup& group) {
  if (group.size() < 2 * kMinCells || isFoliage(cells, group)) return {group};
  const Slices slices = mostCrowded(cells, group);
  const std::vector<int> sheets = sheetsIn(slices, cells, group);
  if (sheets.size() < 2 || !areSideBySide(sheets, slices)) return {group};
  std::vector<ChangeGroup> parts = splitBetween(sheets, slices, group);
  if (!areOfLikeSize(parts)) return {group};
  return parts;
}

}  // namespace cluxel::tasks
