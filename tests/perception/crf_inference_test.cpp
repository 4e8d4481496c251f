// SPDX-License-Identifier: Apache-2.0
// Inference against exact enumeration on small graphs and alpha-expansion on larger ones.
#include "perception/crf/crf_inference.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "perception/crf_oracle_fixture.hpp"

namespace cluxel::perception {

using namespace scan;
namespace {

TEST(CrfGraph, CountsAPairOfLabelsInBothOrdersAlike) {
  CrfGraph graph{{LabelCosts{1, 2, 3, 4, 5}, LabelCosts{1, 2, 3, 4, 5}}, {{0, 1}}, {PairCosts{}}};
  graph.pair_costs[0][labelPair(1, 3)] = 10.0F;
  EXPECT_DOUBLE_EQ(oracle::energyOf(graph, std::vector<std::uint8_t>{1, 3}), 16.0);
  EXPECT_DOUBLE_EQ(oracle::energyOf(graph, std::vector<std::uint8_t>{3, 1}), 16.0);
  EXPECT_DOUBLE_EQ(oracle::energyOf(graph, std::vector<std::uint8_t>{3, 3}), 8.0);
}

TEST(CrfInference, TakesTheCheapestLabelOfALoneNode) {
  const CrfGraph graph{{LabelCosts{3, 1, 2, 5, 4}}, {}, {}};
  const InferenceResult result = inferTrws(graph, {});
  EXPECT_EQ(result.labels, std::vector<std::uint8_t>{1});
  EXPECT_NEAR(static_cast<double>(result.marginals[0][2] / result.marginals[0][1]), std::exp(-1.0), 1e-5);
}

TEST(CrfInference, HasNothingToSayOfAnEmptyGraph) {
  const InferenceResult result = inferTrws({}, {});
  EXPECT_TRUE(result.labels.empty());
  EXPECT_EQ(result.lower_bound, 0.0);
}

TEST(CrfInference, IsExactOnChains) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 100; ++trial) {
    const CrfGraph graph = oracle::randomChain(random, 7);
    const InferenceResult result = inferTrws(graph, {.sweeps = 1});
    const oracle::Labelling best = oracle::enumerate(graph);
    EXPECT_NEAR(oracle::energyOf(graph, result.labels), best.energy, 1e-4);
    EXPECT_NEAR(result.lower_bound, best.energy, 1e-4);
  }
}

TEST(CrfInference, GivesTheMinMarginalsOfAChain) {
  std::mt19937 random(8);
  for (int trial = 0; trial < 20; ++trial) {
    const CrfGraph graph = oracle::randomChain(random, 6);
    const InferenceResult result = inferTrws(graph, {.sweeps = 2});
    const auto expected = oracle::enumerateMinMarginals(graph);
    for (std::size_t i = 0; i < graph.size(); ++i)
      for (std::size_t a = 0; a < kPrimitiveLabelCount; ++a) {
        const double ratio = static_cast<double>(result.marginals[i][a] / result.marginals[i][result.labels[i]]);
        EXPECT_NEAR(ratio, std::exp(-expected[i][a]), 1e-4);
      }
  }
}

TEST(CrfInference, IsWithinTwoPercentOfTheBestOfAllLabellingsOnTinyGraphs) {
  std::mt19937 random(9);
  double found = 0, best = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const CrfGraph graph = oracle::randomGraph(random, {.nodes = 7, .potts = trial % 2 == 0});
    const InferenceResult result = inferTrws(graph, {.sweeps = 10});
    const double least = oracle::enumerate(graph).energy;
    EXPECT_LE(result.lower_bound, least + 1e-4);
    EXPECT_GE(oracle::energyOf(graph, result.labels), least - 1e-4);
    found += oracle::energyOf(graph, result.labels);
    best += least;
  }
  EXPECT_LE(found, 1.02 * best);
}

TEST(CrfOracle, ExpandsToTheOptimumOfMostTinyPottsGraphs) {
  std::mt19937 random(10);
  int optimal = 0;
  for (int trial = 0; trial < 50; ++trial) {
    const CrfGraph graph = oracle::randomGraph(random, {.nodes = 7});
    const double least = oracle::enumerate(graph).energy;
    const double expanded = oracle::expandAlpha(graph).energy;
    EXPECT_GE(expanded, least - 1e-6);
    EXPECT_LE(expanded, 2.0 * least + 1e-6);
    if (expanded <= least + 1e-6) ++optimal;
  }
  EXPECT_GE(optimal, 45);
}

TEST(CrfInference, IsAsGoodAsAlphaExpansionOnNoisyGrids) {
  std::mt19937 random(11);
  for (int trial = 0; trial < 5; ++trial) {
    const CrfGraph graph = oracle::noisyGrid(random, 40);
    const InferenceResult result = inferTrws(graph, {.sweeps = 5});
    const double expanded = oracle::expandAlpha(graph).energy;
    EXPECT_LE(oracle::energyOf(graph, result.labels), expanded + 0.005 * std::abs(expanded));
    EXPECT_LE(result.lower_bound, expanded);
  }
}

TEST(CrfInference, NeverLosesBoundByMoreSweeps) {
  std::mt19937 random(12);
  const CrfGraph graph = oracle::noisyGrid(random, 20);
  double bound = -1e30;
  for (unsigned sweeps = 1; sweeps <= 12; ++sweeps) {
    const double now = inferTrws(graph, {.sweeps = sweeps}).lower_bound;
    EXPECT_GE(now, bound - 1e-3);
    bound = now;
  }
}

TEST(CrfInference, GivesTheSameBitsTwice) {
  std::mt19937 random(13);
  const CrfGraph graph = oracle::noisyGrid(random, 15);
  const InferenceResult first = inferTrws(graph, {}), second = inferTrws(graph, {});
  EXPECT_EQ(first.labels, second.labels);
  EXPECT_EQ(first.marginals, second.marginals);
}

}  // namespace
}  // namespace cluxel::perception
