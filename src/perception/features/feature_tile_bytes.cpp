// SPDX-License-Identifier: Apache-2.0
// Stored form of features: the graph only. Of two own cluxels the one with the smaller number keeps their edge.
#include "perception/features/feature_tile.hpp"
#include "perception/tile_bytes.hpp"

namespace cluxel::perception {
namespace {

bool isStoredAt(std::uint32_t cluxel, RingIndex target) {
  return FeatureTile::hasRow(cluxel, target);
}

/// Targets ascend in each cluxel and, from one cluxel to the next, stay near each other within a ring tile.
class LastTargets {
 public:
  std::uint32_t& operator[](std::uint32_t ring) { return last_[ring]; }

 private:
  std::array<std::uint32_t, 9> last_{};
};

/// The first edge row of each cluxel; not stored, since it follows from the targets.
std::vector<std::uint32_t> edgeRowOffsets(const FeatureTile& tile) {
  std::vector<std::uint32_t> offsets{0};
  offsets.reserve(tile.size() + 1);
  for (std::uint32_t c = 0; c < tile.size(); ++c) {
    std::uint32_t rows = offsets.back();
    for (std::uint32_t e = tile.edge_offset[c]; e < tile.edge_offset[c + 1]; ++e)
      rows += FeatureTile::hasRow(c, tile.edge_target[e]) ? 1U : 0U;
    offsets.push_back(rows);
  }
  return offsets;
}

/// The stored edges: how many each cluxel has, and for each its ring tile and the difference of its number to the one
/// before in that ring tile.
struct StoredEdges {
  std::vector<std::uint32_t> count;
  std::vector<std::uint8_t> ring;
  std::vector<std::uint32_t> step;
};

StoredEdges storedEdges(const FeatureTile& tile) {
  StoredEdges edges;
  LastTargets last;
  for (std::uint32_t c = 0; c < tile.size(); ++c) {
    std::uint32_t count = 0;
    last[kRingCentre] = c;
    for (std::uint32_t e = tile.edge_offset[c]; e < tile.edge_offset[c + 1]; ++e) {
      const RingIndex target = tile.edge_target[e];
      if (!isStoredAt(c, target)) continue;
      edges.ring.push_back(static_cast<std::uint8_t>(target.ring));
      edges.step.push_back(zigzag(target.index - last[target.ring]));
      last[target.ring] = target.index;
      ++count;
    }
    edges.count.push_back(count);
  }
  return edges;
}

/// Turns the steps into the numbers of targets; false when one is impossible.
bool toTargets(StoredEdges& edges) {
  constexpr std::uint32_t kMaxIndex = (std::uint32_t{1} << 28U) - 1;
  const auto cluxels = static_cast<std::uint32_t>(edges.count.size());
  LastTargets last;
  if (edges.ring.size() > kMaxIndex) return false;
  std::size_t at = 0;
  for (std::uint32_t c = 0; c < cluxels; ++c) {
    last[kRingCentre] = c;
    std::pair<std::uint32_t, std::uint32_t> before;  // ring and target of the edge before, which is smaller
    for (std::uint32_t i = 0; i < edges.count[c]; ++i, ++at) {
      if (at == edges.ring.size() || edges.ring[at] >= 9) return false;
      const std::uint32_t ring = edges.ring[at], target = last[ring] + unzigzag(edges.step[at]);
      if (target > kMaxIndex || (ring == kRingCentre && (target <= c || target >= cluxels))) return false;
      if (i > 0 && std::pair(ring, target) <= before) return false;
      before = {ring, target};
      edges.step[at] = last[ring] = target;
    }
  }
  return at == edges.ring.size();
}

/// The edges of both ends in the order of their ring tiles and numbers.
void putEdges(const StoredEdges& edges, FeatureTile& tile) {
  const std::size_t cluxels = edges.count.size();
  std::vector<std::uint32_t> before(cluxels), smaller(cluxels);  // edges to ring tiles before the centre; to own ones
  std::size_t at = 0;
  for (std::size_t c = 0; c < cluxels; ++c)
    for (std::uint32_t i = 0; i < edges.count[c]; ++i, ++at) {
      before[c] += edges.ring[at] < kRingCentre ? 1U : 0U;
      if (edges.ring[at] == kRingCentre) ++smaller[edges.step[at]];
    }
  tile.edge_offset.assign(1, 0);
  for (std::size_t c = 0; c < cluxels; ++c)
    tile.edge_offset.push_back(tile.edge_offset.back() + edges.count[c] + smaller[c]);
  tile.edge_target.resize(tile.edge_offset.back());
  std::vector<std::uint32_t> next(cluxels);  // where the next smaller own cluxel goes
  for (std::size_t c = 0; c < cluxels; ++c) next[c] = tile.edge_offset[c] + before[c];
  at = 0;
  for (std::uint32_t c = 0; c < cluxels; ++c)
    for (std::uint32_t i = 0, place = tile.edge_offset[c]; i < edges.count[c]; ++i, ++at) {
      if (i == before[c]) place += smaller[c];
      const std::uint32_t ring = edges.ring[at], target = edges.step[at];
      tile.edge_target[place++] = {ring, target};
      if (ring == kRingCentre) tile.edge_target[next[target]++] = {kRingCentre, c};
    }
}

}  // namespace

std::string toBytes(const FeatureTile& tile) {
  const StoredEdges edges = storedEdges(tile);
  TileWriter writer("FEAT", 3, tile.key);
  writer.put(edges.count);
  writer.put(edges.ring);
  writer.put(edges.step);
  writer.leaveOut(tile.center);
  writer.leaveOut(tile.point_count);
  writer.leaveOut(tile.features);
  writer.leaveOut(tile.edge_features);
  return writer.take();
}

FeatureTile featureTileFromBytes(std::string_view bytes, std::size_t cluxel_count) {
  TileReader reader(bytes, "FEAT", 3);
  FeatureTile tile;
  tile.key = reader.key();
  StoredEdges edges;
  edges.count = reader.getMany<std::uint32_t>();
  edges.ring = reader.getMany<std::uint8_t>();
  edges.step = reader.getMany<std::uint32_t>(edges.ring.size());
  reader.require(edges.count.size() == cluxel_count, "is of other cluxels");
  reader.require(toTargets(edges), "has an edge that leads nowhere");
  reader.finish();
  putEdges(edges, tile);
  tile.edge_row_offset = edgeRowOffsets(tile);
  return tile;
}

}  // namespace cluxel::perception
