// SPDX-License-Identifier: Apache-2.0
// Pseudo-likelihood: the probability of each node's label given the true labels of its neighbours.
#include "perception/training/pair_training.hpp"

#include <algorithm>
#include <cmath>

#include "perception/training/lbfgs_minimise.hpp"

namespace cluxel::perception {

namespace {

using Scores = std::array<double, scan::kPrimitiveLabelCount>;

/// Replaces scores by probabilities (softmax) and returns log(sum of exp).
double normalise(Scores& scores) {
  const double highest = *std::max_element(scores.begin(), scores.end());
  double sum = 0;
  for (double& score : scores) sum += score = std::exp(score - highest);
  for (double& score : scores) score /= sum;
  return highest + std::log(sum);
}

}  // namespace

PseudoLikelihood::PseudoLikelihood(const PairSamples& samples, const PairShape& shape)
    : samples_(samples), shape_(shape), hats_per_edge_(1 + kHats * samples.columns) {
  const std::size_t edges = samples.columns == 0 ? 0 : samples.features.size() / samples.columns;
  hats_.reserve(std::max<std::size_t>(edges, 1) * hats_per_edge_);
  for (std::size_t e = 0; e < std::max<std::size_t>(edges, 1); ++e) {
    hats_.push_back({0, 1.0F});
    for (std::size_t c = 0; c < samples.columns; ++c) {
      const bool used = edges > 0 && (shape.columns_used.empty() || shape.columns_used[c]);
      const auto hats =
          used ? hatsAt(shape.knots[c], samples.features[e * samples.columns + c]) : std::array<float, kHats>{};
      for (std::size_t h = 0; h < kHats; ++h) hats_.push_back({static_cast<std::uint32_t>(1 + kHats * c + h), hats[h]});
    }
  }
  for (const PairTerm& term : samples.terms) strength_.push_back(std::pow(term.share, shape.degree_power));
  for (const float weight : samples.weight) total_weight_ += static_cast<double>(weight);
}

std::span<const PseudoLikelihood::Term> PseudoLikelihood::hatsOf(const PairTerm& term) const {
  return {hats_.data() + (samples_.columns == 0 ? 0 : term.features * hats_per_edge_), hats_per_edge_};
}

double PseudoLikelihood::operator()(std::span<const double> x, std::span<double> gradient) const {
  std::fill(gradient.begin(), gradient.end(), 0.0);
  const auto weightAt = [](std::size_t row, std::size_t pair) { return 1 + row * kLabelPairCount + pair; };
  double loss = 0;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    Scores scores;
    for (std::size_t a = 0; a < scan::kPrimitiveLabelCount; ++a)
      scores[a] = -x[0] * static_cast<double>(samples_.costs[i][a]);
    for (std::size_t t = samples_.offset[i]; t < samples_.offset[i + 1]; ++t) {
      const std::size_t b = samples_.terms[t].neighbour;
      for (const Term& hat : hatsOf(samples_.terms[t])) {
        if (hat.hat == 0.0F) continue;
        const double factor = static_cast<double>(hat.hat) * static_cast<double>(strength_[t]);
        for (std::size_t a = 0; a < scan::kPrimitiveLabelCount; ++a)
          if (a != b) scores[a] -= factor * x[weightAt(hat.row, labelPair(a, b))];
      }
    }
    const std::size_t truth = samples_.truth[i];
    const double weight = static_cast<double>(samples_.weight[i]) / total_weight_, true_score = scores[truth];
    loss += weight * (normalise(scores) - true_score);
    scores[truth] -= 1.0;
    for (std::size_t a = 0; a < scan::kPrimitiveLabelCount; ++a)
      gradient[0] -= weight * scores[a] * static_cast<double>(samples_.costs[i][a]);
    for (std::size_t t = samples_.offset[i]; t < samples_.offset[i + 1]; ++t) {
      const std::size_t b = samples_.terms[t].neighbour;
      for (const Term& hat : hatsOf(samples_.terms[t])) {
        if (hat.hat == 0.0F) continue;
        const double factor = weight * static_cast<double>(hat.hat) * static_cast<double>(strength_[t]);
        for (std::size_t a = 0; a < scan::kPrimitiveLabelCount; ++a)
          if (a != b) gradient[weightAt(hat.row, labelPair(a, b))] -= factor * scores[a];
      }
    }
  }
  const double l2 = shape_.l2 / total_weight_;
  for (std::size_t k = 1; k < x.size(); ++k) {
    loss += 0.5 * l2 * x[k] * x[k];
    gradient[k] += l2 * x[k];
  }
  return loss;
}

PairModel fitPairs(const PairSamples& samples, const PairShape& shape) {
  const PseudoLikelihood objective(samples, shape);
  std::vector<double> start(objective.parameters(), 0.0);
  start[0] = 1.0;
  const auto best = minimise([&](std::span<const double> x, std::span<double> g) { return objective(x, g); }, start,
                             {.iterations = 60, .precision = 1e-4});
  PairModel model;
  model.unary_scale = static_cast<float>(best[0]);
  model.pair_scale = 1.0F;
  model.degree_power = shape.degree_power;
  model.knots = shape.knots;
  model.weights.resize(1 + kHats * samples.columns);
  for (std::size_t row = 0; row < model.weights.size(); ++row)
    for (std::size_t pair = 0; pair < kLabelPairCount; ++pair)
      model.weights[row][pair] = static_cast<float>(best[1 + row * kLabelPairCount + pair]);
  return model;
}

}  // namespace cluxel::perception
