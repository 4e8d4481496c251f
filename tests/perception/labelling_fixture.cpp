// SPDX-License-Identifier: Apache-2.0
// Feature tiles without points.
#include "perception/labelling_fixture.hpp"

#include <random>

namespace cluxel::made_up {

using namespace scan;
using namespace perception;

namespace {

constexpr int kSide = 16;

std::size_t labelAt(int x, int y) {
  return static_cast<std::size_t>((x / 4 + 2 * (y / 4)) % 5);
}

float uniform(std::mt19937& random) {
  return static_cast<float>(random() % 10000U) / 10000.0F;
}

/// Adds an edge from the cluxel at (from_x, from_y) to the one at (x, y); coordinates count through both tiles. Its
/// first features are small where the labels of its ends differ.
void addEdge(FeatureTile& tile, int from_x, int from_y, int x, int y, std::size_t columns) {
  if (x < 0 || x >= 2 * kSide || y < 0 || y >= kSide) return;
  const int tile_x = x / kSide;
  const auto ring = static_cast<std::uint32_t>(kRingCentre + tile_x - tile.key.x);
  tile.edge_target.push_back({ring & 15U, static_cast<std::uint32_t>(y * kSide + x % kSide) & 0xfffffffU});
  if (!FeatureTile::hasRow(static_cast<std::uint32_t>(from_y * kSide + from_x % kSide), tile.edge_target.back()))
    return;
  // Symmetric: computed from what both ends have in common.
  std::mt19937 random(static_cast<std::uint32_t>((from_x + x) * 1000 + from_y + y));
  const float likeness = labelAt(from_x, from_y) == labelAt(x, y) ? 0.4F : 0.0F;
  for (std::size_t c = 0; c < columns; ++c)
    tile.edge_features.push_back(0.6F * uniform(random) + (c < 2 ? likeness : 0.0F));
}

void addCluxel(FeatureTile& tile, std::vector<TruthCounts>& truth, int x, int y, std::mt19937& random,
               const FeatureLayout& layout) {
  tile.center.emplace_back(static_cast<float>(x % kSide) + 0.5F, static_cast<float>(y) + 0.5F, 0.0F);
  tile.point_count.push_back(10);
  for (std::size_t c = 0; c < layout.columns.size(); ++c)
    tile.features.push_back(c == 3 ? static_cast<float>(labelAt(x, y)) + 2.0F * (uniform(random) - 0.5F)
                                   : uniform(random));
  TruthCounts counts{};
  counts[labelAt(x, y)] = 10;
  truth.push_back(counts);
  for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
    addEdge(tile, x, y, x + dx, y + dy, layout.edge_columns.size());
  tile.edge_offset.push_back(static_cast<std::uint32_t>(tile.edge_target.size()));
  tile.edge_row_offset.push_back(static_cast<std::uint32_t>(tile.edge_features.size() / layout.edge_columns.size()));
}

}  // namespace

TrainingPlace place(std::uint32_t seed, int group) {
  const FeatureLayout layout = featureLayout(FeatureParams{});
  std::mt19937 random(seed);
  TrainingPlace place;
  place.name = "made up";
  place.group = group;
  for (int t = 0; t < 2; ++t) {
    FeatureTile& tile = place.features[{t, 0}];
    tile.key = {t, 0};
    tile.edge_offset.push_back(0);
    tile.edge_row_offset.push_back(0);
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) addCluxel(tile, place.truth[{t, 0}], t * kSide + x, y, random, layout);
  }
  return place;
}

TrainParams quickTraining() {
  TrainParams params;
  params.boosting.trees = 25;
  params.boosting.depth = 3;
  params.boosting.l2 = 1.0;
  params.boosting.column_share = 0.8;
  params.without_columns = {};
  return params;
}

LabelModel model() {
  ProgressSink sink;
  const std::vector<TrainingPlace> places{place(1, 0), place(2, 1), place(3, 2)};
  return train("made up", places, PerceptionParams{}, quickTraining(), 1, sink).model;
}

}  // namespace cluxel::made_up
