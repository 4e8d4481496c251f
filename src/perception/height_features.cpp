// SPDX-License-Identifier: Apache-2.0
// The map column tells what a cluxel alone cannot: a pole runs from the ground up, a crown has air below it.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "perception/feature_groups.hpp"
#include "perception/whole_below.hpp"

namespace cluxel {
namespace {

/// Several columns taken together: occupied slices above a common base.
struct Profile {
  static constexpr std::int32_t kNoBase = std::int32_t{1} << 30;
  float low = std::numeric_limits<float>::infinity(), high = -std::numeric_limits<float>::infinity();
  std::int32_t base = kNoBase;
  std::uint32_t columns = 0;  ///< occupied ones
  std::uint64_t slices = 0;
};

/// Slices moved to another base; what rises past the last one stays in it.
std::uint64_t moved(std::uint64_t slices, std::int32_t up) {
  if (up <= 0) return slices;
  if (up >= 64) return slices != 0 ? std::uint64_t{1} << 63U : 0;
  const auto shift = static_cast<unsigned>(up);
  const bool cut = (slices >> (64U - shift)) != 0;
  return slices << shift | (cut ? std::uint64_t{1} << 63U : 0);
}

/// Of two sets of columns without a common one. In which order columns are joined does not matter.
Profile joined(const Profile& a, const Profile& b) {
  const std::int32_t base = std::min(a.base, b.base);
  return {std::min(a.low, b.low), std::max(a.high, b.high), base, a.columns + b.columns,
          moved(a.slices, a.base - base) | moved(b.slices, b.base - base)};
}

Profile profileOf(const Column& column) {
  if (column.count == 0) return {};
  return {column.low, column.high, column.base_slice, 1, column.slices};
}

constexpr int kWideReach = 3;  ///< columns around a cluxel's own that are looked at
constexpr int kPadded = kColumnsPerTile + 2 * kWideReach;

std::size_t cellAt(int x, int y) {
  return static_cast<std::size_t>((y + kWideReach) * kPadded + x + kWideReach);
}

using Profiles = std::vector<Profile>;  // of the padded tile, by cellAt()

Profiles columnsAround(const Ring<CluxelTile>& ring) {
  Profiles profiles(static_cast<std::size_t>(kPadded) * kPadded);
  for (int y = -kWideReach; y < kColumnsPerTile + kWideReach; ++y)
    for (int x = -kWideReach; x < kColumnsPerTile + kWideReach; ++x) {
      const int column = 1 + (x < 0                  ? -1
                              : x >= kColumnsPerTile ? 1
                                                     : 0),
                row = 1 + (y < 0                  ? -1
                           : y >= kColumnsPerTile ? 1
                                                  : 0);
      const CluxelTile* tile = ring[static_cast<std::size_t>(3 * row + column)];
      if (tile == nullptr) continue;
      const int u = (x + kColumnsPerTile) % kColumnsPerTile, v = (y + kColumnsPerTile) % kColumnsPerTile;
      profiles[cellAt(x, y)] = profileOf(tile->columns[static_cast<std::size_t>(v * kColumnsPerTile + u)]);
    }
  return profiles;
}

/// Profiles of squares of columns: joined along x for all, then along y where one is wanted.
class ProfileSquares {
 public:
  explicit ProfileSquares(const Ring<CluxelTile>& ring)
      : columns_(columnsAround(ring)), three_(columns_.size()), seven_(columns_.size()) {
    for (std::size_t i = 1; i + 1 < columns_.size(); ++i)
      three_[i] = joined(joined(columns_[i - 1], columns_[i]), columns_[i + 1]);
    for (std::size_t i = 2; i + 2 < columns_.size(); ++i)
      seven_[i] = joined(joined(three_[i - 2], columns_[i]), three_[i + 2]);
  }
  /// Of the column itself, of 3 x 3 and of 7 x 7 columns around it.
  struct Nested {
    Profile narrow, middle, wide;
  };
  Nested at(int x, int y) const {
    const std::size_t cell = cellAt(x, y);
    return {columns_[cell], stacked(three_, cell, 1), stacked(seven_, cell, kWideReach)};
  }

 private:
  static Profile stacked(const Profiles& rows, std::size_t cell, std::size_t reach) {
    Profile all = rows[cell];
    for (std::size_t step = 1; step <= reach; ++step)
      all = joined(joined(all, rows[cell - step * kPadded]), rows[cell + step * kPadded]);
    return all;
  }
  Profiles columns_, three_, seven_;
};

/// Occupied slices that hang together above the lowest bit, over gaps of a single slice: up to the first two empty
/// ones.
int runUp(std::uint64_t slices) {
  return std::countr_zero(~slices & ~(slices >> 1U));
}
int runDown(std::uint64_t slices) {
  return std::countl_zero(~slices & ~(slices << 1U));
}

void putProfile(const Profile& profile, double z, double ground, std::span<float> out) {
  const int at = std::clamp(static_cast<int>(wholeBelow(z / kSliceHeight_m)) - profile.base, 0, 63);
  const std::uint64_t below = at == 0 ? 0 : profile.slices & ((std::uint64_t{1} << static_cast<unsigned>(at)) - 1);
  const std::uint64_t above = at == 63 ? 0 : profile.slices >> static_cast<unsigned>(at + 1);
  const std::uint64_t under =
      at == 0 ? 0 : profile.slices << static_cast<unsigned>(64 - at);  // the next one is the highest bit
  const auto metres = [](int slices) { return static_cast<float>(slices * kSliceHeight_m); };
  out[0] = metres(runDown(under));
  out[1] = metres(runUp(above));
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

/// Profiles around the columns in which a cluxel's centre lies.
std::vector<ProfileSquares::Nested> profilesOf(const FeatureInput& input) {
  std::vector<std::uint8_t> wanted(static_cast<std::size_t>(kColumnsPerTile) * kColumnsPerTile);
  for (const auto& own : input.own().own) wanted[cellOf(own.mean)] = 1;
  const ProfileSquares squares(input.ring);
  std::vector<ProfileSquares::Nested> profiles(wanted.size());
  for (int y = 0; y < kColumnsPerTile; ++y)
    for (int x = 0; x < kColumnsPerTile; ++x) {
      const auto cell = static_cast<std::size_t>(y * kColumnsPerTile + x);
      if (wanted[cell]) profiles[cell] = squares.at(x, y);
    }
  return profiles;
}

/// A centre may lie in a column without points, when the cluxel's points lie around it: then the wider profile stands
/// in.
const Profile& occupied(const Profile& narrow, const Profile& wider) {
  return narrow.columns > 0 ? narrow : wider;
}

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
  const auto profiles = profilesOf(input);
  for (std::size_t c = 0; c < own.size(); ++c) {
    const Eigen::Vector3f& center = own.own[c].mean;
    const auto& [narrow, middle, wide] = profiles[cellOf(center)];
    const double ground = groundHeightAt(input.ground, center.x(), center.y());
    const Profile& around = occupied(middle, wide);
    auto out = rows.row(c, column, 1 + 2 * kProfileColumns + 3);
    out[0] = static_cast<float>(center.z() - ground);
    putProfile(occupied(narrow, around), center.z(), ground, out.subspan(1));
    putProfile(around, center.z(), ground, out.subspan(1 + kProfileColumns));
    auto rest = out.subspan(1 + 2 * kProfileColumns);
    rest[0] = static_cast<float>(wide.high - ground);
    rest[1] = static_cast<float>(wide.low - ground);
    rest[2] = static_cast<float>(wide.columns) / 49.0F;
  }
}

}  // namespace cluxel
