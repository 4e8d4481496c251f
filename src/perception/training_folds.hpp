// SPDX-License-Identifier: Apache-2.0
// Unaries that leave places out, and what they say of those places.
#pragma once

#include <set>
#include <span>
#include <vector>

#include "cluxel/perception/training.hpp"
#include "perception/calibration.hpp"
#include "perception/halo_graph.hpp"
#include "perception/pair_training.hpp"

namespace cluxel {

using PlaceRefs = std::vector<const TrainingPlace*>;

/// The places of all groups but one, or of one alone.
PlaceRefs placesWithout(const PlaceRefs& places, int group);
PlaceRefs scoredPlaces(const PlaceRefs& places, int group);
std::set<int> groupsOf(const PlaceRefs& places);

/// Rows for the unary: cluxels with truth, weighted by class and points.
UnaryRows unaryRows(const PlaceRefs& places, const FeatureLayout& layout, const TrainParams& params);
TreeEnsemble trainUnary(const PlaceRefs& places, const FeatureLayout& layout, const TrainParams& params,
                        unsigned threads);

/// A tile that is labelled by a unary that did not see it: structure with halo and scores of all its nodes.
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

}  // namespace cluxel
