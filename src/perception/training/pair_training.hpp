// SPDX-License-Identifier: Apache-2.0
// Learns the pairwise term by maximum pseudo-likelihood.
#pragma once

#include <span>
#include <vector>

#include "perception/crf/crf_pairs.hpp"
#include "perception/crf/unary_trees.hpp"

namespace cluxel::perception {

/// An edge from the perspective of one end.
struct PairTerm {
  std::uint32_t features = 0;  ///< row of PairSamples::features
  float share = 1;             ///< 2 / sum of degrees
  std::uint8_t neighbour = 0;  ///< the other end's true label
};

/// Nodes whose own and neighbours' truth is known.
struct PairSamples {
  std::size_t columns = 0;
  std::vector<float> features;  ///< rows of edge features
  std::vector<PairTerm> terms;  ///< terms of node i: [offset[i], offset[i + 1])
  std::vector<std::uint32_t> offset{0};
  std::vector<LabelCosts> costs;  ///< -log of the unary's probabilities, from a unary that did not see the node
  std::vector<std::uint8_t> truth;
  std::vector<float> weight;

  std::size_t size() const { return truth.size(); }
};

/// Shape of the pairwise term before its weights are known.
struct PairShape {
  std::vector<HatKnots> knots;
  std::vector<bool> columns_used;  ///< empty: all
  float degree_power = 0;
  double l2 = 3.0;
};

/// The negative log pseudo-likelihood per unit of weight, with its gradient: convex. Parameters: the scale of the
/// unary, then weights row by row as in PairModel. Costs may become negative here; the model cuts them at 0.
class PseudoLikelihood {
 public:
  PseudoLikelihood(const PairSamples& samples, const PairShape& shape);
  std::size_t parameters() const { return 1 + (1 + kHats * samples_.columns) * kLabelPairCount; }
  double operator()(std::span<const double> x, std::span<double> gradient) const;

 private:
  struct Term {
    std::uint32_t row = 0;
    float hat = 0;
  };
  std::span<const Term> hatsOf(const PairTerm& term) const;

  const PairSamples& samples_;
  const PairShape& shape_;
  std::size_t hats_per_edge_;
  std::vector<Term> hats_;       // per row of features
  std::vector<float> strength_;  // per term: share^degree_power
  double total_weight_ = 0;
};

/// The pairwise term with the maximum pseudo-likelihood, with pair_scale 1.
PairModel fitPairs(const PairSamples& samples, const PairShape& shape);

}  // namespace cluxel::perception
