// SPDX-License-Identifier: Apache-2.0
// Height features: what stands above and below a cluxel. A pole is occupied from the ground up; a crown has free space
// below it.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "perception/clustering/fast_floor.hpp"
#include "perception/features/feature_groups.hpp"

namespace cluxel::perception {
namespace {

/// The union of several cell stacks: occupied slices above a common base.
struct Profile {
  static constexpr std::int32_t kNoBase = std::int32_t{1} << 30;
  float low = std::numeric_limits<float>::infinity(), high = -std::numeric_limits<float>::infinity();
  std::int32_t base = kNoBase;
  std::uint32_t stacks = 0;  ///< occupied ones
  std::uint64_t slices = 0;
};

/// Slices shifted to another base; slices beyond the last one are merged into it.
std::uint64_t moved(std::uint64_t slices, std::int32_t up) {
  if (up <= 0) return slices;
  if (up >= 64) return slices != 0 ? std::uint64_t{1} << 63U : 0;
  const auto shift = static_cast<unsigned>(up);
  const bool cut = (slices >> (64U - shift)) != 0;
  return slices << shift | (cut ? std::uint64_t{1} << 63U : 0);
}

/// The union of two disjoint sets of stacks; independent of order.
Profile joined(const Profile& a, const Profile& b) {
  const std::int32_t base = std::min(a.base, b.base);
  return {std::min(a.low, b.low), std::max(a.high, b.high), base, a.stacks + b.stacks,
          moved(a.slices, a.base - base) | moved(b.slices, b.base - base)};
}

Profile profileOf(const CellStack& stack) {
  if (stack.count == 0) return {};
  return {stack.low, stack.high, stack.base_slice, 1, stack.slices};
}

constexpr int kWideReach = 3;  ///< radius of the neighbourhood [stacks]
static_assert(kWideReach * kStackSize_m <= kFeatureMargin_m);
constexpr int kPadded = kStacksPerTile + 2 * kWideReach;

std::size_t cellAt(int x, int y) {
  return static_cast<std::size_t>((y + kWideReach) * kPadded + x + kWideReach);
}

using Profiles = std::vector<Profile>;  // of the padded tile, by cellAt()

Profiles stacksAround(const Ring<CluxelTile>& ring) {
  Profiles profiles(static_cast<std::size_t>(kPadded) * kPadded);
  for (int y = -kWideReach; y < kStacksPerTile + kWideReach; ++y)
    for (int x = -kWideReach; x < kStacksPerTile + kWideReach; ++x) {
      const int stack = 1 + (x < 0                 ? -1
                             : x >= kStacksPerTile ? 1
                                                   : 0),
                row = 1 + (y < 0                 ? -1
                           : y >= kStacksPerTile ? 1
                                                 : 0);
      const CluxelTile* tile = ring[static_cast<std::size_t>(3 * row + stack)];
      if (tile == nullptr) continue;
      const int u = (x + kStacksPerTile) % kStacksPerTile, v = (y + kStacksPerTile) % kStacksPerTile;
      profiles[cellAt(x, y)] = profileOf(tile->stacks[static_cast<std::size_t>(v * kStacksPerTile + u)]);
    }
  return profiles;
}

/// Profiles of squares of stacks (separable): joined along x for all, then along y on demand.
class ProfileSquares {
 public:
  explicit ProfileSquares(const Ring<CluxelTile>& ring)
      : stacks_(stacksAround(ring)), three_(stacks_.size()), seven_(stacks_.size()) {
    for (std::size_t i = 1; i + 1 < stacks_.size(); ++i)
      three_[i] = joined(joined(stacks_[i - 1], stacks_[i]), stacks_[i + 1]);
    for (std::size_t i = 2; i + 2 < stacks_.size(); ++i)
      seven_[i] = joined(joined(three_[i - 2], stacks_[i]), three_[i + 2]);
  }
  /// Profiles of 1 x 1, 3 x 3 and 7 x 7 stacks around one.
  struct Nested {
    Profile narrow, middle, wide;
  };
  Nested at(int x, int y) const {
    const std::size_t cell = cellAt(x, y);
    return {stacks_[cell], stacked(three_, cell, 1), stacked(seven_, cell, kWideReach)};
  }

 private:
  static Profile stacked(const Profiles& rows, std::size_t cell, std::size_t reach) {
    Profile all = rows[cell];
    for (std::size_t step = 1; step <= reach; ++step)
      all = joined(joined(all, rows[cell - step * kPadded]), rows[cell + step * kPadded]);
    return all;
  }
  Profiles stacks_, three_, seven_;
};

/// The number of slices from the lowest bit up to the first two consecutive empty ones; single empty slices are
/// bridged.
int runUp(std::uint64_t slices) {
  return std::countr_zero(~slices & ~(slices >> 1U));
}
int runDown(std::uint64_t slices) {
  return std::countl_zero(~slices & ~(slices << 1U));
}

void putProfile(const Profile& profile, double z, double ground, std::span<float> out) {
  const int at = std::clamp(static_cast<int>(fastFloor(z / kSliceHeight_m)) - profile.base, 0, 63);
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
  return static_cast<std::size_t>(center.y() / kStackSize_m) * kStacksPerTile +
         static_cast<std::size_t>(center.x() / kStackSize_m);
}

/// Profiles around the stacks that hold a cluxel's centre.
std::vector<ProfileSquares::Nested> profilesOf(const FeatureInput& input) {
  std::vector<std::uint8_t> occupied(static_cast<std::size_t>(kStacksPerTile) * kStacksPerTile);
  for (const std::uint32_t c : input.chosen) occupied[cellOf(input.own().own[c].mean)] = 1;
  const ProfileSquares squares(input.ring);
  std::vector<ProfileSquares::Nested> profiles(occupied.size());
  for (int y = 0; y < kStacksPerTile; ++y)
    for (int x = 0; x < kStacksPerTile; ++x) {
      const auto cell = static_cast<std::size_t>(y * kStacksPerTile + x);
      if (occupied[cell]) profiles[cell] = squares.at(x, y);
    }
  return profiles;
}

/// A cluxel's centre may lie in a stack without points, since it is a mean: then the wider profile is used.
const Profile& occupied(const Profile& narrow, const Profile& wider) {
  return narrow.stacks > 0 ? narrow : wider;
}

}  // namespace

std::vector<std::string> heightColumns() {
  std::vector<std::string> names{"metric.height_above_ground"};
  for (const char* stack : {"metric.stack_0m5_", "metric.stack_1m5_"})
    for (const char* name : {"run_below", "run_above", "filled_below", "filled_above", "top", "bottom"})
      names.push_back(std::string(stack) + name);
  names.insert(names.end(), {"metric.stack_3m5_top", "metric.stack_3m5_bottom", "metric.stack_3m5_occupied"});
  return names;
}

void fillHeightFeatures(const FeatureInput& input, std::size_t column, FeatureRows& rows) {
  const CluxelTile& own = input.own();
  const auto profiles = profilesOf(input);
  for (const std::uint32_t c : input.chosen) {
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
    rest[2] = static_cast<float>(wide.stacks) / 49.0F;
  }
}

}  // namespace cluxel::perception
