// SPDX-License-Identifier: Apache-2.0
// Collects for each neighbour the bytes that it reads, and digests them.
#include "perception/tile_borders.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include "base/packing/zstd_packing.hpp"
#include "cluxel/error.hpp"

namespace cluxel::perception {

namespace {

constexpr auto kTile_m = static_cast<float>(kTileSize_m);
constexpr std::string_view kMark = "BRD1";  ///< the kind and version of the form
constexpr std::size_t kHeadBytes = kMark.size() + sizeof(TileBorders);
static_assert(sizeof(TileBorders) == 10 * sizeof(std::uint64_t), "stored without padding");

/// None when the block is cut short or of another form.
std::optional<TileBorders> bordersIn(std::string_view block) {
  if (block.size() < kHeadBytes || !block.starts_with(kMark)) return std::nullopt;
  TileBorders borders;
  std::memcpy(&borders, block.data() + kMark.size(), sizeof borders);
  return borders;
}

/// For each set of near sides (left 1, right 2, bottom 4, top 8) the neighbours there.
constexpr std::array<std::uint16_t, 16> placesOfSides() {
  std::array<std::uint16_t, 16> all{};
  for (std::uint32_t sides = 0; sides < all.size(); ++sides)
    for (std::uint32_t place = 0; place < 9; ++place) {
      const std::uint32_t x = place % 3, y = place / 3;
      const bool near_x = x == 1 || (sides & (x == 0 ? 1U : 2U)) != 0;
      const bool near_y = y == 1 || (sides & (y == 0 ? 4U : 8U)) != 0;
      if (place != kRingCentre && near_x && near_y) all[sides] = static_cast<std::uint16_t>(all[sides] | 1U << place);
    }
  return all;
}
constexpr std::array<std::uint16_t, 16> kPlaces = placesOfSides();

/// The neighbours that lie within some distance of a box: one bit for each place of the ring.
class NearNeighbours {
 public:
  explicit NearNeighbours(double width_m) : low_(static_cast<float>(width_m)), high_(kTile_m - low_) {}

  std::uint32_t of(float low_x, float low_y, float high_x, float high_y) const {
    const std::uint32_t sides = (low_x <= low_ ? 1U : 0U) | (high_x >= high_ ? 2U : 0U) | (low_y <= low_ ? 4U : 0U) |
                                (high_y >= high_ ? 8U : 0U);
    return kPlaces[sides];
  }

 private:
  float low_, high_;
};

std::uint64_t digestOf(std::string_view bytes) {
  FastDigest digest;
  digest.add(bytes.data(), bytes.size());
  std::uint64_t number = 0;
  std::memcpy(&number, digest.finish().data(), sizeof number);
  return number;
}

/// Bytes for each place of the ring.
class BorderBytes {
 public:
  void add(std::uint32_t places, const void* from, std::size_t size) {
    for (std::size_t place = 0; places != 0; ++place, places >>= 1U)
      if ((places & 1U) != 0) bytes_[place].append(static_cast<const char*>(from), size);
  }
  template <typename T>
  void add(std::uint32_t places, const T& value) {
    add(places, &value, sizeof value);
  }
  TileBorders finish() const {
    TileBorders borders;
    for (std::size_t place = 0; place < bytes_.size(); ++place) borders.by[place] = digestOf(bytes_[place]);
    return borders;
  }

 private:
  std::array<std::string, 9> bytes_;
};

constexpr std::uint32_t kOwn = 1U << kRingCentre;

/// What the ground of all tiles around reads.
std::uint64_t digestOfLowest(const std::vector<CellStack>& stacks) {
  std::vector<float> lowest;
  lowest.reserve(stacks.size());
  for (const CellStack& stack : stacks)
    lowest.push_back(stack.count == 0 ? std::numeric_limits<float>::infinity() : stack.low);
  return digestOf({reinterpret_cast<const char*>(lowest.data()), lowest.size() * sizeof(float)});
}

/// Cells at which heights are read for points and for centres of cluxels.
std::vector<char> cellsNearPoints(const std::vector<CellStack>& stacks, double away_m) {
  const int away = static_cast<int>(std::ceil(away_m / kStackSize_m));
  std::vector<char> near(stacks.size(), 0);
  for (int y = 0; y < kStacksPerTile; ++y)
    for (int x = 0; x < kStacksPerTile; ++x) {
      if (stacks[static_cast<std::size_t>(y * kStacksPerTile + x)].count == 0) continue;
      for (int v = std::max(0, y - away); v <= std::min(kStacksPerTile - 1, y + away); ++v)
        for (int u = std::max(0, x - away); u <= std::min(kStacksPerTile - 1, x + away); ++u)
          near[static_cast<std::size_t>(v * kStacksPerTile + u)] = 1;
    }
  return near;
}

void addStacks(const CluxelTile& tile, const NearNeighbours& near, BorderBytes& bytes) {
  constexpr auto kStack_m = static_cast<float>(kStackSize_m);
  for (std::size_t i = 0; i < tile.stacks.size(); ++i) {
    const CellStack& stack = tile.stacks[i];
    const float x = static_cast<float>(i % kStacksPerTile) * kStack_m,
                y = static_cast<float>(i / kStacksPerTile) * kStack_m;
    const std::uint32_t places = near.of(x, y, x + kStack_m, y + kStack_m);
    if (places == 0) continue;
    bytes.add(places, stack.count != 0);
    if (stack.count == 0) continue;
    bytes.add(places, stack.low), bytes.add(places, stack.high);
    bytes.add(places, stack.base_slice), bytes.add(places, stack.slices);
  }
}

void addCluxel(const CluxelTile& tile, std::uint32_t c, std::uint32_t places, BorderBytes& bytes) {
  bytes.add(places, c);
  bytes.add(places, tile.own[c]), bytes.add(places, tile.ball[c]), bytes.add(places, tile.reach[c]);
  for (const auto* corners : {&tile.box_min, &tile.box_max, &tile.volume_min, &tile.volume_max})
    bytes.add(places, (*corners)[c].data(), 3 * sizeof(float));
}

}  // namespace

BorderWidths borderWidths(const PerceptionParams& perception, const LabellingParams& labelling) {
  const double reach = std::max(perception.clustering.radius_m, perception.clustering.max_reach_m);
  BorderWidths widths;
  widths.points = std::max(reach, kEvenMargin_m);
  // A volume reaches out of the tile by `reach`, a volume that it meets goes on by twice as much. Features read cluxels
  // whose volumes touch that one, and what lies within kFeatureMargin_m.
  widths.cluxels = std::max(3 * reach, kFeatureMargin_m);
  widths.ground = kEvenMargin_m + kStackSize_m;  // heights are interpolated between cells
  widths.ground_by_points = perception.clustering.radius_m + kStackSize_m;
  widths.features = labelling.halo_m;
  // From the centre of a cluxel to its seed, over its volume, over that of a neighbour, to the seed of the next one.
  widths.volumes = widths.features + perception.clustering.radius_m + 4 * reach;
  return widths;
}

std::uint32_t neighboursNear(const Eigen::Vector3f& p_local, double width_m) {
  return NearNeighbours(width_m).of(p_local.x(), p_local.y(), p_local.x(), p_local.y());
}

TileBorders bordersOf(const TilePoints& tile, const BorderWidths& widths) {
  const NearNeighbours near(widths.points);
  BorderBytes bytes;
  for (std::size_t i = 0; i < tile.size(); ++i)
    if (const std::uint32_t places = near.of(tile.x[i], tile.y[i], tile.x[i], tile.y[i]); places != 0)
      bytes.add(places, std::array<float, 3>{tile.x[i], tile.y[i], tile.z[i]});
  return bytes.finish();
}

TileBorders bordersOf(const CluxelTile& tile, const BorderWidths& widths) {
  const NearNeighbours near(widths.cluxels);
  BorderBytes bytes;
  addStacks(tile, near, bytes);
  for (std::uint32_t c = 0; c < tile.size(); ++c) {
    const Eigen::Vector3f low = tile.box_min[c].cwiseMin(tile.volume_min[c]),
                          high = tile.box_max[c].cwiseMax(tile.volume_max[c]);
    if (const std::uint32_t places = near.of(low.x(), low.y(), high.x(), high.y()); places != 0)
      addCluxel(tile, c, places, bytes);
  }
  TileBorders borders = bytes.finish();
  borders.by_all = digestOfLowest(tile.stacks);
  return borders;
}

TileBorders bordersOf(const GroundTile& tile, const CluxelTile& cluxels, const BorderWidths& widths) {
  const NearNeighbours near(widths.ground);
  const std::vector<char> near_points = cellsNearPoints(cluxels.stacks, widths.ground_by_points);
  constexpr auto kStack_m = static_cast<float>(kStackSize_m);
  BorderBytes bytes;
  bytes.add(kOwn, *std::min_element(tile.height.begin(), tile.height.end()));
  for (std::size_t i = 0; i < tile.size(); ++i) {
    const float x = static_cast<float>(i % kStacksPerTile) * kStack_m,
                y = static_cast<float>(i / kStacksPerTile) * kStack_m;
    const std::uint32_t places = near.of(x, y, x + kStack_m, y + kStack_m) | (near_points[i] != 0 ? kOwn : 0);
    if (places != 0) bytes.add(places, tile.height[i]);
  }
  return bytes.finish();
}

TileBorders bordersOf(const FeatureTile& tile, const BorderWidths& widths) {
  const NearNeighbours near(widths.features);
  BorderBytes bytes;
  if (tile.size() == 0) return bytes.finish();
  const std::size_t columns = tile.features.size() / tile.size();
  const std::size_t edge_rows = tile.edge_row_offset.back();
  const std::size_t edge_columns = edge_rows == 0 ? 0 : tile.edge_features.size() / edge_rows;
  for (std::uint32_t c = 0; c < tile.size(); ++c) {
    const Eigen::Vector3f& center = tile.center[c];
    const std::uint32_t places = near.of(center.x(), center.y(), center.x(), center.y());
    if (places == 0) continue;
    bytes.add(places, center.data(), 3 * sizeof(float));
    bytes.add(places, tile.features.data() + c * columns, columns * sizeof(float));
    bytes.add(places, tile.edge_offset[c + 1] - tile.edge_offset[c]);
    std::uint32_t row = tile.edge_row_offset[c];
    for (std::uint32_t e = tile.edge_offset[c]; e < tile.edge_offset[c + 1]; ++e) {
      if (!FeatureTile::hasRow(c, tile.edge_target[e])) continue;
      bytes.add(places, static_cast<std::uint8_t>(tile.edge_target[e].ring));
      bytes.add(places, tile.edge_features.data() + row++ * edge_columns, edge_columns * sizeof(float));
    }
  }
  return bytes.finish();
}

std::string withBorders(const TileBorders& borders, std::string_view tile_bytes) {
  std::string block(kMark);
  return block.append(reinterpret_cast<const char*>(&borders), sizeof borders).append(tile_bytes);
}

std::string_view withoutBorders(std::string_view block) {
  if (!block.starts_with(kMark)) return block;
  if (block.size() < kHeadBytes)
    throw Error(ErrorKind::StoreUnavailable, "a stored block is cut short; the map is damaged, build it anew");
  return block.substr(kHeadBytes);
}

OutputChange changeOfBordered(std::string_view before, std::string_view after) {
  const auto was = bordersIn(before), is = bordersIn(after);
  if (!was || !is) return kOtherEverywhere;
  OutputChange change;
  change.is_other = before != after;
  for (std::size_t place = 0; place < was->by.size(); ++place) change.is_read[place] = was->by[place] != is->by[place];
  change.is_read_all = was->by_all != is->by_all;
  return change;
}

}  // namespace cluxel::perception
