// SPDX-License-Identifier: Apache-2.0
// Rows, scores and samples of training places.
#include "perception/training/training_folds.hpp"

#include <algorithm>
#include <cmath>

#include "base/mixed_bits.hpp"
#include "base/parallel.hpp"

namespace cluxel::perception {

namespace {

/// The pairwise term has few parameters, so this many nodes suffice.
constexpr std::size_t kMaxPairNodes = 25000;

/// The weight of a label; larger for rarer classes.
LabelValues classWeights(const PlaceRefs& places, double balance) {
  std::array<double, scan::kPrimitiveLabelCount> sums{};
  double total = 0;
  for (const TrainingPlace* place : places)
    for (const auto& [key, counts] : place->truth)
      for (const TruthCounts& truth : counts)
        for (std::size_t k = 0; k < scan::kPrimitiveLabelCount; ++k) {
          sums[k] += truth[k];
          total += truth[k];
        }
  LabelValues weights{};
  for (std::size_t k = 0; k < scan::kPrimitiveLabelCount; ++k)
    if (sums[k] > 0) weights[k] = static_cast<float>(std::pow(total / sums[k], balance));
  return weights;
}

std::vector<bool> columnsUsed(const std::vector<std::string>& names, const std::vector<std::string>& without) {
  std::vector<bool> used;
  for (const std::string& name : names)
    used.push_back(std::none_of(without.begin(), without.end(),
                                [&](const std::string& beginning) { return name.starts_with(beginning); }));
  return used;
}

bool isClear(const TruthCounts& truth) {
  const std::uint32_t max_truth = *std::max_element(truth.begin(), truth.end());
  return max_truth > 0 && 2.0 * max_truth > pointsOf(truth);
}

std::uint8_t majority(const TruthCounts& truth) {
  return static_cast<std::uint8_t>(std::max_element(truth.begin(), truth.end()) - truth.begin());
}

}  // namespace

PlaceRefs placesWithout(const PlaceRefs& places, int group) {
  PlaceRefs rest = places;
  std::erase_if(rest, [&](const TrainingPlace* place) { return place->group == group; });
  return rest;
}

PlaceRefs scoredPlaces(const PlaceRefs& places, int group) {
  PlaceRefs rest = places;
  std::erase_if(rest, [&](const TrainingPlace* place) { return place->group != group || place->only_for_training; });
  return rest;
}

std::set<int> groupsOf(const PlaceRefs& places) {
  std::set<int> groups;
  for (const TrainingPlace* place : places)
    if (!place->only_for_training) groups.insert(place->group);
  return groups;
}

namespace {

/// The share of cluxels to keep for each majority label, so that the budget is divided evenly among labels.
std::array<double, scan::kPrimitiveLabelCount> keptShares(const PlaceRefs& places, std::size_t max_rows) {
  std::array<double, scan::kPrimitiveLabelCount> rows{}, share;
  for (const TrainingPlace* place : places)
    for (const auto& [key, counts] : place->truth)
      for (const TruthCounts& truth : counts)
        if (pointsOf(truth) > 0) ++rows[majority(truth)];
  const double part = static_cast<double>(max_rows) / static_cast<double>(scan::kPrimitiveLabelCount);
  for (std::size_t k = 0; k < scan::kPrimitiveLabelCount; ++k) share[k] = rows[k] > part ? part / rows[k] : 1.0;
  return share;
}

LabelValues targetOf(const TruthCounts& truth, const LabelValues& weights, double point_power, double kept_share) {
  LabelValues target;
  const double factor = std::pow(pointsOf(truth), point_power - 1.0) / kept_share;
  for (std::size_t k = 0; k < scan::kPrimitiveLabelCount; ++k)
    target[k] = weights[k] * static_cast<float>(factor * truth[k]);
  return target;
}

}  // namespace

UnaryRows unaryRows(const PlaceRefs& places, const FeatureLayout& layout, const TrainParams& params) {
  const LabelValues weights = classWeights(places, params.class_balance);
  const auto kept = keptShares(places, static_cast<std::size_t>(params.max_rows));
  UnaryRows rows;
  rows.columns = static_cast<std::uint32_t>(layout.columns.size());
  std::uint64_t number = 0;
  for (const TrainingPlace* place : places)
    for (const auto& [key, tile] : place->features)
      for (std::size_t i = 0; i < tile.size(); ++i) {
        const TruthCounts& truth = place->truth.at(key)[i];
        const double share = kept[majority(truth)];
        if (pointsOf(truth) == 0 || hashedShare(params.boosting.seed, 0, ++number) >= share) continue;
        rows.targets.push_back(targetOf(truth, weights, params.point_power, share));
        const auto row = tile.features.begin() + static_cast<std::ptrdiff_t>(i * rows.columns);
        rows.features.insert(rows.features.end(), row, row + rows.columns);
      }
  return rows;
}

TreeEnsemble trainUnary(const PlaceRefs& places, const FeatureLayout& layout, const TrainParams& params,
                        unsigned threads) {
  BoostingParams boosting = params.boosting;
  boosting.columns_used = columnsUsed(layout.columns, params.without_columns);
  return growTrees(unaryRows(places, layout, params), boosting, threads);
}

std::vector<ScoredTile> scoreTiles(const PlaceRefs& places, const TreeEnsemble& unary, const LabellingParams& params,
                                   unsigned threads) {
  std::vector<ScoredTile> tiles;
  for (const TrainingPlace* place : places)
    for (const auto& [key, features] : place->features) {
      ScoredTile& tile = tiles.emplace_back();
      tile.ring = ringIn(place->features, key);
      tile.ring_truth = ringIn(place->truth, key);
    }
  parallelFor(tiles.size(), threads, [&](std::size_t t) {
    ScoredTile& tile = tiles[t];
    tile.structure = haloGraph(tile.ring, params.halo_m);
    tile.scores = scoreRows(unary, nodeFeatures(tile.ring, tile.structure, unary.columns));
  });
  return tiles;
}

CalibrationRows inferTiles(std::span<const ScoredTile> tiles, const PairModel& pairs, const LabellingParams& params,
                           unsigned threads) {
  std::vector<std::vector<LabelValues>> marginals(tiles.size());
  parallelFor(tiles.size(), threads, [&](std::size_t t) {
    const ScoredTile& tile = tiles[t];
    const CrfGraph graph = crfGraph(tile.ring, tile.structure, tile.scores, pairs);
    const InferenceResult result = inferTrws(graph, {.sweeps = static_cast<unsigned>(params.sweeps), .decode = false});
    marginals[t].assign(result.marginals.begin() + tile.structure.own_begin,
                        result.marginals.begin() + tile.structure.own_end);
  });
  CalibrationRows rows;
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    const std::vector<TruthCounts>& truth = *tiles[t].ring_truth[kRingCentre];
    rows.marginals.insert(rows.marginals.end(), marginals[t].begin(), marginals[t].end());
    rows.truth.insert(rows.truth.end(), truth.begin(), truth.end());
  }
  return rows;
}

namespace {

/// Nodes of one tile and their edges, appended to the samples.
class TileSampler {
 public:
  TileSampler(const ScoredTile& tile, std::size_t columns, PairSamples& samples)
      : tile_(tile),
        columns_(columns),
        samples_(samples),
        row_(tile.structure.edges.size(), kNoRow),
        edges_(tile.structure.nodes.size()) {
    for (std::uint32_t e = 0; e < tile.structure.edges.size(); ++e) {
      edges_[tile.structure.edges[e].ends.from].push_back(e);
      edges_[tile.structure.edges[e].ends.to].push_back(e);
    }
  }

  void add(std::uint32_t node, const LabelValues& class_weights, double point_power) {
    const TruthCounts& truth = truthAt(node);
    if (!isClear(truth)) return;
    for (const std::uint32_t e : edges_[node]) {
      const HaloEdge& edge = tile_.structure.edges[e];
      const TruthCounts& other = truthAt(edge.ends.from == node ? edge.ends.to : edge.ends.from);
      if (isClear(other)) samples_.terms.push_back({rowOf(e), edge.share(), majority(other)});
    }
    samples_.offset.push_back(static_cast<std::uint32_t>(samples_.terms.size()));
    LabelCosts costs = softmax(tile_.scores[node]);
    for (float& cost : costs) cost = -std::log(std::max(cost, 1e-6F));
    samples_.costs.push_back(costs);
    samples_.truth.push_back(majority(truth));
    samples_.weight.push_back(class_weights[majority(truth)] *
                              static_cast<float>(std::pow(pointsOf(truth), point_power)));
  }

 private:
  static constexpr std::uint32_t kNoRow = 0xffffffffU;

  const TruthCounts& truthAt(std::uint32_t node) const {
    const auto [ring, index] = tile_.structure.nodes[node];
    return (*tile_.ring_truth[ring])[index];
  }

  std::uint32_t rowOf(std::uint32_t e) {
    if (row_[e] == kNoRow) {
      const HaloEdge& edge = tile_.structure.edges[e];
      row_[e] = columns_ == 0 ? 0 : static_cast<std::uint32_t>(samples_.features.size() / columns_);
      const auto begin =
          tile_.ring[edge.ring]->edge_features.begin() + static_cast<std::ptrdiff_t>(edge.row * columns_);
      samples_.features.insert(samples_.features.end(), begin, begin + static_cast<std::ptrdiff_t>(columns_));
    }
    return row_[e];
  }

  const ScoredTile& tile_;
  std::size_t columns_;
  PairSamples& samples_;
  std::vector<std::uint32_t> row_;
  std::vector<std::vector<std::uint32_t>> edges_;
};

LabelValues classWeights(std::span<const ScoredTile> tiles, double balance) {
  std::array<double, scan::kPrimitiveLabelCount> sums{};
  double total = 0;
  for (const ScoredTile& tile : tiles)
    for (const TruthCounts& truth : *tile.ring_truth[kRingCentre])
      for (std::size_t k = 0; k < scan::kPrimitiveLabelCount; ++k) {
        sums[k] += truth[k];
        total += truth[k];
      }
  LabelValues weights{};
  for (std::size_t k = 0; k < scan::kPrimitiveLabelCount; ++k)
    if (sums[k] > 0) weights[k] = static_cast<float>(std::pow(total / sums[k], balance));
  return weights;
}

}  // namespace

PairSamples pairSamples(std::span<const ScoredTile> tiles, std::size_t columns, const TrainParams& params) {
  const LabelValues weights = classWeights(tiles, params.class_balance);
  std::size_t nodes = 0;
  for (const ScoredTile& tile : tiles) nodes += tile.structure.own_end - tile.structure.own_begin;
  const std::size_t stride = nodes / kMaxPairNodes + 1;
  PairSamples samples;
  samples.columns = columns;
  std::size_t number = 0;
  for (const ScoredTile& tile : tiles) {
    TileSampler sampler(tile, columns, samples);
    for (std::uint32_t i = tile.structure.own_begin; i < tile.structure.own_end; ++i)
      if (number++ % stride == 0) sampler.add(i, weights, params.point_power);
  }
  return samples;
}

}  // namespace cluxel::perception
