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

/// Collects values as bytes, and hashes them in pieces: large primitives have megabytes.
class Bytes {
 public:
  template <typename Value>
  requires std::is_trivially_copyable_v<Value>
  void add(const Value& value) {
    static_assert(sizeof value <= kPieceBytes);
    if (size_ + sizeof value > kPieceBytes) hashPiece();
    std::memcpy(bytes_.data() + size_, &value, sizeof value);
    size_ += sizeof value;
  }
  template <typename Vector>
  void addVector(const Vector& vector) {
    for (int axis = 0; axis < 3; ++axis) add(vector[axis]);
  }
  std::uint64_t takeHash() {
    if (!has_pieces_) return XXH3_64bits(bytes_.data(), std::exchange(size_, 0));
    hashPiece();
    has_pieces_ = false;
    return XXH3_64bits_digest(&state_);
  }

 private:
  static constexpr std::size_t kPieceBytes = 4096;

  void hashPiece() {
    if (!std::exchange(has_pieces_, true)) XXH3_64bits_reset(&state_);
    XXH3_64bits_update(&state_, bytes_.data(), std::exchange(size_, 0));
  }

  std::array<char, kPieceBytes> bytes_{};
  std::size_t size_ = 0;  ///< of what was added since the last piece
  bool has_pieces_ = false;
  XXH3_state_t state_{};
};

std::uint64_t hashOfView(const SceneView& view, Bytes& bytes) {
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

}  // namespace

struct PrimitiveInputs::Impl {
 public:
  Impl(const Scene& scene, const std::map<TileKey, SummaryTile>& summaries)
      : scene_(scene), summaries_(summaries), seeds_(seedHashes(scene.cluxels)) {
    for (const SceneView& view : scene.views) views_.push_back(hashOfView(view, bytes_));
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
  /// What each scan saw of a cluxel.
  std::uint64_t hashOfSights(const CluxelName& cluxel) {
    if (tile_ == nullptr || tile_->key != cluxel.tile) tile_ = &summaries_.at(cluxel.tile);
    for (std::uint32_t view = tile_->view_offset[cluxel.index]; view < tile_->view_offset[cluxel.index + 1]; ++view) {
      sights_.add(tile_->scans[tile_->view_scan[view]]);
      sights_.add(tile_->view_point_count[view]);
      sights_.add(tile_->view_shift[view]);
    }
    return sights_.takeHash();
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
    bytes_.add(hashOfSights(all.name[cluxel]));
    for (const std::uint32_t neighbour : all.neighbours(cluxel)) bytes_.add(seeds_[neighbour]);
  }

  const Scene& scene_;
  const std::map<TileKey, SummaryTile>& summaries_;
  const SummaryTile* tile_ = nullptr;  ///< that of the last cluxel
  std::vector<std::uint64_t> seeds_;   ///< by cluxel
  std::vector<std::uint64_t> views_;
  Bytes bytes_, sights_;
};

PrimitiveInputs::PrimitiveInputs(const Scene& scene, const std::map<TileKey, SummaryTile>& summaries)
    : impl_(std::make_unique<Impl>(scene, summaries)) {}
PrimitiveInputs::~PrimitiveInputs() = default;

std::uint64_t PrimitiveInputs::hashOf(PrimitiveIndex primitive) {
  return impl_->hashOfPrimitive(primitive);
}

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
  PrimitiveInputs inputs(scene, summaries);
  std::vector<std::uint64_t> hashes;
  hashes.reserve(scene.primitives.size());
  for (PrimitiveIndex i = 0; i < scene.primitives.size(); ++i) hashes.push_back(inputs.hashOf(i));
  return hashes;
}

}  // namespace cluxel::perception
