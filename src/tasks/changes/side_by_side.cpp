// SPDX-License-Identifier: Apache-2.0
// Sheets are found in a histogram of cells across the direction in which they lie.
#include "tasks/changes/side_by_side.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace cluxel::tasks {

namespace {

constexpr double kSlice_m = 0.1, kMinLength_m = 1, kMinHeight_m = 0.5;
constexpr int kDirections = 36, kMostSlices = 3, kSlicesBetween = 2, kMostSlicesApart = 10;
constexpr double kFull = 0.3, kSmallest = 0.2, kMostBetween = 0.15;
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

/// The first and last full slice of a sheet.
struct Sheet {
  int first = 0, last = 0;

  int slicesTo(int slice) const { return std::max({first - slice, slice - last, 0}); }
};

std::vector<Sheet> sheetsIn(const Slices& slices) {
  const double full = kFull * static_cast<double>(*std::max_element(slices.cells.begin(), slices.cells.end()));
  std::vector<Sheet> sheets;
  for (int slice = 0; slice < static_cast<int>(slices.cells.size()); ++slice) {
    if (static_cast<double>(slices.cells[static_cast<std::size_t>(slice)]) < full) continue;
    if (!sheets.empty() && slice - sheets.back().last <= kSlicesBetween)
      sheets.back().last = slice;
    else
      sheets.push_back({slice, slice});
  }
  return sheets;
}

/// Whether the cells in a sheet and in the slices beside it stand upright and are long enough for a thing of its own:
/// longer than a wheel.
bool isUpright(const ChangeGroup& group, const std::vector<PointCell>& cells, const Slices& slices,
               const Sheet& sheet) {
  const Eigen::Vector2d lengthwise(-slices.across.y(), slices.across.x());
  Eigen::AlignedBox2d extent;  // along the sheet and in height
  std::size_t count = 0;
  for (std::size_t i = 0; i < group.size(); ++i) {
    if (sheet.slicesTo(slices.of_cell[i]) > 1) continue;
    const Eigen::Vector3d& place = cells[group[i]].place;
    extent.extend(Eigen::Vector2d(lengthwise.dot(place.head<2>()), place.z()));
    ++count;
  }
  return count >= kMinCells && extent.sizes().x() >= kMinLength_m && extent.sizes().y() >= kMinHeight_m;
}

/// Whether sheets stand so near to each other that they may touch, and little lies between them.
bool areCloseAndApart(const std::vector<Sheet>& sheets, const Slices& slices) {
  for (std::size_t i = 1; i < sheets.size(); ++i)
    if (sheets[i].first - sheets[i - 1].last > kMostSlicesApart) return false;
  double between = 0;
  for (std::size_t i = 0; i < slices.of_cell.size(); ++i)
    between += std::all_of(sheets.begin(), sheets.end(),
                           [&](const Sheet& sheet) { return sheet.slicesTo(slices.of_cell[i]) > 1; })
                   ? 1
                   : 0;
  return between <= kMostBetween * static_cast<double>(slices.of_cell.size());
}

std::vector<ChangeGroup> splitBetween(const std::vector<Sheet>& sheets, const Slices& slices,
                                      const ChangeGroup& group) {
  std::vector<ChangeGroup> parts(sheets.size());
  for (std::size_t i = 0; i < group.size(); ++i) {
    const auto nearest = std::min_element(sheets.begin(), sheets.end(), [&](const Sheet& a, const Sheet& b) {
      return a.slicesTo(slices.of_cell[i]) < b.slicesTo(slices.of_cell[i]);
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
  const std::vector<Sheet> sheets = sheetsIn(slices);
  const bool are_thin = std::all_of(sheets.begin(), sheets.end(), [&](const Sheet& sheet) {
    return sheet.last - sheet.first < kMostSlices && isUpright(group, cells, slices, sheet);
  });
  if (sheets.size() < 2 || !are_thin || !areCloseAndApart(sheets, slices)) return {group};
  std::vector<ChangeGroup> parts = splitBetween(sheets, slices, group);
  if (!areOfLikeSize(parts)) return {group};
  return parts;
}

}  // namespace cluxel::tasks
