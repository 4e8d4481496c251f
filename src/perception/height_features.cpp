// SPDX-License-Identifier: Apache-2.0
// The map column tells what a cluxel alone cannot: a pole runs from the ground up, a crown has air below it.
#include <algorithm>
#include <bit>
#include <cmath>

#include "perception/feature_groups.hpp"

namespace cluxel {
namespace {

/// Several columns taken together: occupied slices above a common base.
struct Profile {
  float low = 0, high = 0;
  std::int32_t base = 0;
  std::uint64_t slices = 0;
  std::uint32_t columns = 0;       ///< occupied ones
};

/// The column at a place relative to the centre tile, which may lie in the ring; null where nothing is.
const Column* columnAt(const Ring<CluxelTile>& ring, int x, int y) {
  const int column = 1 + (x < 0 ? -1 : x >= kColumnsPerTile ? 1 : 0), row = 1 + (y < 0 ? -1 : y >= kColumnsPerTile ? 1 : 0);
  const CluxelTile* tile = ring[static_cast<std::size_t>(3 * row + column)];
  if (tile == nullptr) return nullptr;
  const int u = (x + kColumnsPerTile) % kColumnsPerTile, v = (y + kColumnsPerTile) % kColumnsPerTile;
  const Column& found = tile->columns[static_cast<std::size_t>(v * kColumnsPerTile + u)];
  return found.count > 0 ? &found : nullptr;
}

/// Slices moved to another base; what rises past the last one stays in it.
std::uint64_t moved(std::uint64_t slices, std::int32_t up) {
  if (up <= 0) return slices;
  if (up >= 64) return slices != 0 ? std::uint64_t{1} << 63U : 0;
  const auto shift = static_cast<unsigned>(up);
  const bool cut = (slices >> (64U - shift)) != 0;
  return slices << shift | (cut ? std::uint64_t{1} << 63U : 0);
}

Profile profileAround(const Ring<CluxelTile>& ring, int x, int y, int reach) {
  Profile profile;
  std::vector<const Column*> columns;
  for (int v = y - reach; v <= y + reach; ++v)
    for (int u = x - reach; u <= x + reach; ++u)
      if (const Column* column = columnAt(ring, u, v)) columns.push_back(column);
  for (const Column* column : columns) {
    const bool first = profile.columns++ == 0;
    profile.low = first ? column->low : std::min(profile.low, column->low);
    profile.high = first ? column->high : std::max(profile.high, column->high);
    profile.base = first ? column->base_slice : std::min(profile.base, column->base_slice);
  }
  for (const Column* column : columns) profile.slices |= moved(column->slices, column->base_slice - profile.base);
  return profile;
}

/// Occupied slices that hang together with slice `at` in one direction, over gaps of a single slice.
int runFrom(std::uint64_t slices, int at, int step) {
  int run = 0, gap = 0;
  for (int i = at + step; i >= 0 && i < 64 && gap < 2; i += step) {
    const bool occupied = (slices >> static_cast<unsigned>(i) & 1U) != 0;
    gap = occupied ? 0 : gap + 1;
    if (occupied) run = std::abs(i - at);
  }
  return run;
}

void putProfile(const Profile& profile, double z, double ground, std::span<float> out) {
  const int at = std::clamp(static_cast<int>(std::floor(z / kSliceHeight_m)) - profile.base, 0, 63);
  const std::uint64_t below = at == 0 ? 0 : profile.slices & ((std::uint64_t{1} << static_cast<unsigned>(at)) - 1);
  const std::uint64_t above = at == 63 ? 0 : profile.slices >> static_cast<unsigned>(at + 1);
  const auto metres = [](int slices) { return static_cast<float>(slices * kSliceHeight_m); };
  out[0] = metres(runFrom(profile.slices, at, -1));
  out[1] = metres(runFrom(profile.slices, at, +1));
  out[2] = metres(std::popcount(below));
  out[3] = metres(std::popcount(above));
  out[4] = static_cast<float>(profile.high - ground);
  out[5] = static_cast<float>(profile.low - ground);
}

constexpr std::size_t kProfileColumns = 6;

std::size_t cellOf(const Eigen::Vector3f& center) {
  return static_cast<std::size_t>(center.y() / kColumnSize_m) * kColumnsPerTile +
         static_cast<std::size_t>(center.x() / kColumnSize_m);
}

/// Profiles of the columns in which a cluxel's centre lies, at one reach.
std::vector<Profile> profilesOf(const FeatureInput& input, int reach) {
  std::vector<std::uint8_t> wanted(static_cast<std::size_t>(kColumnsPerTile) * kColumnsPerTile);
  for (const auto& own : input.own().own) wanted[cellOf(own.mean)] = 1;
  std::vector<Profile> profiles(wanted.size());
  for (int y = 0; y < kColumnsPerTile; ++y)
    for (int x = 0; x < kColumnsPerTile; ++x) {
      const auto cell = static_cast<std::size_t>(y * kColumnsPerTile + x);
      if (wanted[cell]) profiles[cell] = profileAround(input.ring, x, y, reach);
    }
  return profiles;
}

/// A centre may lie in a column without points, when the cluxel's points lie around it: then the wider profile stands in.
const Profile& occupied(const Profile& narrow, const Profile& wider) { return narrow.columns > 0 ? narrow : wider; }

}  // namespace

std::vector<std::string> heightColumns() {
  std::vector<std::string> names{"metric.height_above_ground"};
  for (const char* column : {"metric.column_0m5_", "metric.column_1m5_"})
    for (const char* name : {"run_below", "run_above", "filled_below", "filled_above", "top", "bottom"})
      names.push_back(std::string(column) + name);
  names.insert(names.end(), {"metric.column_3m5_top", "metric.column_3m5_bottom", "metric.column_3m5_occupied"});
  return names;
}

void fillHeightFeatures(const FeatureInput& input, std::size_t column, FeatureRows& rows) {
  const CluxelTile& own = input.own();
  const auto narrow = profilesOf(input, 0), middle = profilesOf(input, 1), wide = profilesOf(input, 3);
  for (std::size_t c = 0; c < own.size(); ++c) {
    const Eigen::Vector3f& center = own.own[c].mean;
    const std::size_t cell = cellOf(center);
    const double ground = groundHeightAt(input.ground, center.x(), center.y());
    const Profile& around = occupied(middle[cell], wide[cell]);
    auto out = rows.row(c, column, 1 + 2 * kProfileColumns + 3);
    out[0] = static_cast<float>(center.z() - ground);
    putProfile(occupied(narrow[cell], around), center.z(), ground, out.subspan(1));
    putProfile(around, center.z(), ground, out.subspan(1 + kProfileColumns));
    auto rest = out.subspan(1 + 2 * kProfileColumns);
    rest[0] = static_cast<float>(wide[cell].high - ground);
    rest[1] = static_cast<float>(wide[cell].low - ground);
    rest[2] = static_cast<float>(wide[cell].columns) / 49.0F;
  }
}

}  // namespace cluxel
