// SPDX-License-Identifier: Apache-2.0
// The pairwise term: its gradient against finite differences, and recovery by pseudo-likelihood.
#include "perception/crf/crf_pairs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "perception/crf/pair_cost_table.hpp"
#include "perception/training/pair_training.hpp"

namespace cluxel::perception {

using namespace scan;
namespace {

/// Nodes on a chain; the only edge feature determines the probability of equal labels.
PairSamples chainSamples(std::uint32_t seed, std::uint32_t nodes) {
  std::mt19937 random(seed);
  const auto uniform = [&] { return static_cast<float>(random() % 10000U) / 10000.0F; };
  PairSamples samples;
  samples.columns = 2;
  std::vector<std::uint8_t> label{0};
  for (std::uint32_t i = 0; i + 1 < nodes; ++i) {
    const float likeness = uniform();
    samples.features.insert(samples.features.end(), {likeness, uniform()});
    label.push_back(uniform() < likeness ? label.back() : static_cast<std::uint8_t>(random() % kPrimitiveLabelCount));
  }
  for (std::uint32_t i = 0; i < nodes; ++i) {
    if (i > 0) samples.terms.push_back({i - 1, 0.5F, label[i - 1]});
    if (i + 1 < nodes) samples.terms.push_back({i, 0.5F, label[i + 1]});
    samples.offset.push_back(static_cast<std::uint32_t>(samples.terms.size()));
    LabelCosts costs;
    for (std::size_t k = 0; k < costs.size(); ++k) costs[k] = 2.0F * uniform() + (k == label[i] ? 0.0F : 0.5F);
    samples.costs.push_back(costs);
    samples.truth.push_back(label[i]);
    samples.weight.push_back(0.5F + uniform());
  }
  return samples;
}

PairShape pairShape() {
  return {.knots = {{0.0F, 0.5F, 1.0F}, {0.0F, 0.4F, 1.0F}}, .columns_used = {}, .degree_power = 0.5F};
}

TEST(PairTraining, HasTheGradientThatFiniteDifferencesShow) {
  const PairSamples samples = chainSamples(1, 60);
  const PairShape shape = pairShape();
  const PseudoLikelihood objective(samples, shape);
  std::mt19937 random(2);
  std::vector<double> x(objective.parameters()), gradient(x.size()), unused(x.size());
  for (double& value : x) value = static_cast<double>(random() % 2000U) / 1000.0 - 1.0;
  objective(x, gradient);
  for (std::size_t k = 0; k < x.size(); ++k) {
    constexpr double step = 1e-5;
    std::vector<double> above = x, below = x;
    above[k] += step;
    below[k] -= step;
    EXPECT_NEAR(gradient[k], (objective(above, unused) - objective(below, unused)) / (2 * step), 1e-8)
        << "parameter " << k;
  }
}

TEST(PairTraining, IsConvexAlongRandomLines) {
  const PairSamples samples = chainSamples(3, 50);
  const PairShape shape = pairShape();
  const PseudoLikelihood objective(samples, shape);
  std::mt19937 random(4);
  std::vector<double> gradient(objective.parameters());
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<double> a(gradient.size()), b(a.size()), middle(a.size());
    for (std::size_t k = 0; k < a.size(); ++k) {
      a[k] = static_cast<double>(random() % 4000U) / 1000.0 - 2.0;
      b[k] = static_cast<double>(random() % 4000U) / 1000.0 - 2.0;
      middle[k] = 0.5 * (a[k] + b[k]);
    }
    EXPECT_LE(objective(middle, gradient), 0.5 * (objective(a, gradient) + objective(b, gradient)) + 1e-12);
  }
}

TEST(PairTraining, LearnsThatLikeEndsDifferRarely) {
  const PairModel model = fitPairs(chainSamples(5, 4000), pairShape());
  double alike = 0, unlike = 0;
  for (std::size_t pair = 0; pair < kLabelPairCount; ++pair) {
    alike += static_cast<double>(pairCostsOf(model, std::vector{0.95F, 0.5F}, 0.5F)[pair]);
    unlike += static_cast<double>(pairCostsOf(model, std::vector{0.05F, 0.5F}, 0.5F)[pair]);
  }
  EXPECT_GT(alike, 3 * unlike);
  EXPECT_GT(model.unary_scale, 0.2F);
}

TEST(PairTraining, GivesTheSameBitsTwice) {
  const PairModel first = fitPairs(chainSamples(6, 500), pairShape()),
                  second = fitPairs(chainSamples(6, 500), pairShape());
  EXPECT_EQ(first.weights, second.weights);
  EXPECT_EQ(first.unary_scale, second.unary_scale);
}

TEST(PairTraining, LeavesAColumnThatIsSwitchedOffWithoutWeight) {
  PairShape shape = pairShape();
  shape.columns_used = {true, false};
  const PairModel model = fitPairs(chainSamples(7, 500), shape);
  for (std::size_t hat = 0; hat < kHats; ++hat) EXPECT_EQ(model.weights[1 + kHats + hat], PairCosts{});
}

TEST(CrfPairs, HatsSumToOneEverywhere) {
  const HatKnots knots{-1, 0.25F, 2};
  for (float value = -3; value < 4; value += 0.125F) {
    const auto hats = hatsAt(knots, value);
    EXPECT_NEAR(hats[0] + hats[1] + hats[2], 1.0F, 1e-6F);
    for (const float hat : hats) EXPECT_GE(hat, 0.0F);
  }
  EXPECT_EQ(hatsAt(knots, std::numeric_limits<float>::quiet_NaN())[1], 1.0F);
}

TEST(CrfPairs, PullsKnotsOfConstantValuesApart) {
  const HatKnots knots = knotsOf(std::vector<float>(10, 3.0F));
  EXPECT_LT(knots[0], knots[1]);
  EXPECT_LT(knots[1], knots[2]);
}

TEST(CrfPairs, NeverPaysForADifference) {
  PairModel model{.pair_scale = 1, .knots = {}, .weights = {PairCosts{}}};
  model.weights[0].fill(-2.0F);
  EXPECT_EQ(pairCostsOf(model, {}, 1.0F), PairCosts{});
}

TEST(CrfPairs, CountsEdgesOfCrowdedNodesLess) {
  PairModel model{.pair_scale = 2, .degree_power = 1, .knots = {}, .weights = {PairCosts{}}};
  model.weights[0].fill(3.0F);
  EXPECT_FLOAT_EQ(pairCostsOf(model, {}, 0.25F)[0], 1.5F);
}

/// A model of random weights and knots.
PairModel randomModel(std::mt19937& random, std::size_t columns, float degree_power) {
  std::normal_distribution<float> normal;
  PairModel model{.pair_scale = 1.5F, .degree_power = degree_power, .knots = {}, .weights = {}};
  for (std::size_t c = 0; c < columns; ++c) {
    const float low = normal(random), middle = low + 0.01F + std::abs(normal(random));
    model.knots.push_back({low, middle, middle + 0.01F + std::abs(normal(random))});
  }
  model.weights.resize(1 + kHats * columns);
  for (PairCosts& row : model.weights)
    for (float& weight : row) weight = normal(random);
  return model;
}

/// Random edges for a model: some features lie on a knot, some are NaN.
std::vector<std::vector<float>> randomEdges(std::mt19937& random, const PairModel& model, std::size_t count) {
  std::normal_distribution<float> normal(0, 2);
  const std::size_t columns = model.knots.size();
  std::vector<std::vector<float>> edges(count, std::vector<float>(columns));
  for (std::size_t e = 0; e < count && columns > 0; ++e) {
    for (float& value : edges[e]) value = normal(random);
    if (e % 3 == 0) edges[e][e % columns] = model.knots[e % columns][e % kHats];
    if (e % 7 == 0) edges[e][e % columns] = std::numeric_limits<float>::quiet_NaN();
  }
  return edges;
}

void expectTheFormulasBits(const PairModel& model, const std::vector<std::vector<float>>& edges,
                           const SimdKernels& kernels) {
  std::vector<PairCostTable::Edge> listed;
  for (std::uint32_t degrees = 0; degrees < edges.size(); ++degrees) listed.push_back({edges[degrees].data(), degrees});
  const auto costs = PairCostTable(model, kernels).costsOf(listed);
  ASSERT_EQ(costs.size(), edges.size());
  for (std::uint32_t degrees = 0; degrees < edges.size(); ++degrees)
    EXPECT_EQ(costs[degrees], pairCostsOf(model, edges[degrees], shareOf(degrees))) << degrees;
}

TEST(CrfPairs, GiveTheSameBitsByTableOfAnyWidthAndByFormula) {
  std::mt19937 random(8);
  for (const std::size_t columns : {0U, 1U, 3U, 4U, 6U, 10U, 12U, 32U, 33U})
    for (const float degree_power : {0.0F, 0.5F, 1.0F}) {
      const PairModel model = randomModel(random, columns, degree_power);
      const auto edges = randomEdges(random, model, 299);  // not a multiple of the vector width
      expectTheFormulasBits(model, edges, simdKernels<4>());
      if (hasEightLanes()) expectTheFormulasBits(model, edges, simdKernels<8>());
    }
}

}  // namespace
}  // namespace cluxel::perception
