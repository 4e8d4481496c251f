// SPDX-License-Identifier: Apache-2.0
// Unaries that leave places out, and their scores of those places.
#pragma once

#include <set>
#include <span>
#include <vector>

#include "perception/crf/halo_graph.hpp"
#include "perception/training/calibration.hpp"
#include "perception/training/pair_training.hpp"
#include "perception/training/training.hpp"

namespace cluxel::perception {

using PlaceRefs = std::vector<const TrainingPlace*>;

/// The places of all groups but one, or of one alone.
PlaceRefs placesWithout(const PlaceRefs& places, int group);
PlaceRefs scoredPlaces(const PlaceRefs& places, int group);
std::set<int> groupsOf(const PlaceRefs& places);

/// Rows for the unary: cluxels with truth, weighted by class and points.
UnaryRows unaryRows(const PlaceRefs& places, const FeatureLayout& layout, const TrainParams& params);
TreeEnsemble trainUnary(const PlaceRefs& places, const FeatureLayout& layout, const TrainParams& params,
                        unsigned threads);

/// A tile scored by a unary that was not trained on it: structure with halo, and scores of all its nodes.
struct ScoredTile {
  Ring<FeatureTile> ring{};
  Ring<std::vector<TruthCounts>> ring_truth{};
  HaloGraph structure;
  std::vector<LabelValues> scores;
};
std::vector<ScoredTile> scoreTiles(const PlaceRefs& places, const TreeEnsemble& unary, const LabellingParams& params,
                                   unsigned threads);

/// Marginals of all tiles' own cluxels under a pairwise term.
CalibrationRows inferTiles(std::span<const ScoredTile> tiles, const PairModel& pairs, const LabellingParams& params,
                           unsigned threads);

/// Samples for the pairwise term from the tiles' own cluxels of known truth.
PairSamples pairSamples(std::span<const ScoredTile> tiles, std::size_t columns, const TrainParams& params);

}  // namespace cluxel::perception
