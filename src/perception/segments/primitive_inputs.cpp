// SPDX-License-Identifier: Apache-2.0
// Rows of plain values are hashed by XXH3, which costs little beside what is hashed.
#include "perception/segments/primitive_inputs.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <array>
#include <cstring>
#include <type_traits>
#include <utility>

namespace cluxel::perception {

namespace {

/// Collects values as bytes.
class Bytes {
 public:
  template <typename Value>
  requires std::is_trivially_copyable_v<Value>
  void add(const Value& value) {
    if (size_ + sizeof value > bytes_.size()) bytes_.resize(2 * bytes_.size() + sizeof value);
    std::memcpy(bytes_.data() + size_, &value, sizeof value);
    size_ += sizeof value;
  }
  template <typename Vector>
  void addVector(const Vector& vector) {
    for (int axis = 0; axis < 3; ++axis) add(vector[axis]);
  }
  std::uint64_t takeHash() { return XXH3_64bits(bytes_.data(), std::exchange(size_, 0)); }

 private:
  std::vector<char> bytes_;
  std::size_t size_ = 0;  ///< of what was added
};

std::uint64_t hashOf(const SceneView& view, Bytes& bytes) {
  bytes.add(view.scan);
  for (int i = 0; i < 16; ++i) bytes.add(view.T_map_sensor.matrix().data()[i]);
  bytes.addVector(view.sight.origin);
  bytes.add(view.sight.upper_edge.has_value());
  if (view.sight.upper_edge) {
    const UpperEdge& edge = *view.sight.upper_edge;
    for (const double value : {edge.mean_rad, edge.cosine_rad, edge.sine_rad}) bytes.add(value);
  }
  return bytes.takeHash();
}

class InputHashing {
 public:
  InputHashing(const Scene& scene, const std::map<TileKey, SummaryTile>& summaries)
      : scene_(scene), seeds_(seedHashes(scene.cluxels)) {
    for (const auto& [key, tile] : summaries) addSights(tile);
    for (const SceneView& view : scene.views) views_.push_back(hashOf(view, bytes_));
  }

  std::uint64_t hashOfPrimitive(PrimitiveIndex number) {
    const Primitive& primitive = scene_.primitives[number];
    addMeasures(primitive);
    for (const std::uint32_t cluxel : primitive.cluxels) addCluxel(cluxel);
    for (const Relation& relation : scene_.relationsOf(number)) {
      bytes_.add(relation.kind);
      bytes_.add(scene_.primitives[relation.to].id);
      bytes_.add(relation.measure);
    }
    for (const std::uint32_t view : primitive.views) bytes_.add(views_[view]);
    return bytes_.takeHash();
  }

 private:
  /// What each scan saw of the cluxels of a tile.
  void addSights(const SummaryTile& tile) {
    for (std::size_t c = 0; c < tile.size(); ++c) {
      for (std::uint32_t view = tile.view_offset[c]; view < tile.view_offset[c + 1]; ++view) {
        bytes_.add(tile.scans[tile.view_scan[view]]);
        bytes_.add(tile.view_point_count[view]);
        bytes_.add(tile.view_shift[view]);
      }
      sights_.push_back(bytes_.takeHash());
    }
  }

  void addMeasures(const Primitive& primitive) {
    bytes_.add(primitive.id);
    bytes_.add(primitive.label);
    bytes_.add(primitive.attributes);
    bytes_.add(primitive.probabilities);
    for (const Eigen::Vector3d* vector : {&primitive.box.center, &primitive.box.size, &primitive.min, &primitive.max,
                                          &primitive.centroid, &primitive.axis, &primitive.normal})
      bytes_.addVector(*vector);
    bytes_.add(primitive.box.yaw_rad);
    bytes_.add(primitive.ground_z);
  }

  void addCluxel(std::uint32_t cluxel) {
    const SceneCluxels& all = scene_.cluxels;
    bytes_.add(seeds_[cluxel]);
    bytes_.addVector(all.center[cluxel]);
    bytes_.addVector(all.extent[cluxel]);
    bytes_.addVector(all.low_corner[cluxel]);
    bytes_.add(all.point_count[cluxel]);
    bytes_.add(all.label[cluxel]);
    bytes_.add(all.probability[cluxel]);
    bytes_.add(all.height_above_ground[cluxel]);
    bytes_.add(sights_[cluxel]);
    for (const std::uint32_t neighbour : all.neighbours(cluxel)) bytes_.add(seeds_[neighbour]);
  }

  const Scene& scene_;
  std::vector<std::uint64_t> seeds_, sights_;  ///< by cluxel
  std::vector<std::uint64_t> views_;
  Bytes bytes_;
};

}  // namespace

std::vector<std::uint64_t> seedHashes(const SceneSeeds& seeds) {
  struct Seed {
    ContentHash scan;
    std::uint32_t point;
  };
  static_assert(std::has_unique_object_representations_v<Seed>);
  std::vector<std::uint64_t> hashes;
  hashes.reserve(seeds.seed.size());
  for (const SeedName& seed : seeds.seed) {
    const Seed named{seeds.scans[seed.scan], seed.point};
    hashes.push_back(XXH3_64bits(&named, sizeof named));
  }
  return hashes;
}

std::vector<std::uint64_t> inputHashes(const Scene& scene, const std::map<TileKey, SummaryTile>& summaries) {
  InputHashing hashing(scene, summaries);
  std::vector<std::uint64_t> hashes;
  hashes.reserve(scene.primitives.size());
  for (PrimitiveIndex i = 0; i < scene.primitives.size(); ++i) hashes.push_back(hashing.hashOfPrimitive(i));
  return hashes;
}

}  // namespace cluxel::perception
