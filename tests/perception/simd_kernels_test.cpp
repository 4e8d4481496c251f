// SPDX-License-Identifier: Apache-2.0
// The tree kernels of both widths are bit-identical to evaluating the trees row by row.
#include "perception/crf/simd_kernels.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <random>
#include <vector>

#include "perception/crf/tree_scoring.hpp"

namespace cluxel::perception {

using namespace scan;
namespace {

constexpr std::uint32_t kColumns = 9;

TreeEnsemble randomEnsemble(std::mt19937& random, std::size_t trees) {
  std::normal_distribution<float> normal;
  TreeEnsemble ensemble{.columns = kColumns, .bias = {0.1F, -0.2F, 0.3F, 0, 1}, .trees = {}};
  for (std::size_t t = 0; t < trees; ++t) {
    ObliviousTree& tree = ensemble.trees.emplace_back();
    for (std::size_t depth = random() % (kMaxTreeDepth + 1); depth > 0; --depth)
      tree.splits.push_back({static_cast<std::uint32_t>(random() % kColumns), normal(random)});
    tree.leaves.resize(std::size_t{1} << tree.splits.size());
    for (LabelValues& leaf : tree.leaves)
      for (float& value : leaf) value = normal(random);
  }
  return ensemble;
}

std::vector<float> randomRows(std::mt19937& random, const TreeEnsemble& ensemble, std::size_t rows) {
  std::normal_distribution<float> normal;
  std::vector<float> values(rows * kColumns);
  for (float& value : values) value = normal(random);
  for (std::size_t i = 0; i < values.size(); i += 5) values[i] = std::numeric_limits<float>::quiet_NaN();
  for (const ObliviousTree& tree : ensemble.trees)  // equal to a threshold: not above it
    for (const TreeSplit& split : tree.splits) values[random() % rows * kColumns + split.column] = split.threshold;
  return values;
}

LabelValues walkedOneByOne(const TreeEnsemble& ensemble, const float* row) {
  LabelValues sum = ensemble.bias;
  for (const ObliviousTree& tree : ensemble.trees) {
    std::size_t leaf = 0;
    for (std::size_t d = 0; d < tree.splits.size(); ++d)
      leaf |= row[tree.splits[d].column] > tree.splits[d].threshold ? std::size_t{1} << d : 0;
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += tree.leaves[leaf][k];
  }
  return sum;
}

void expectTheSameBits(const SimdKernels& kernels) {
  std::mt19937 random(3);
  for (const std::size_t trees : {0U, 1U, 9U, 10U, 11U, 37U})
    for (const std::size_t rows : {1U, 63U, 64U, 65U, 200U}) {
      const TreeEnsemble ensemble = randomEnsemble(random, trees);
      const auto features = randomRows(random, ensemble, rows);
      const auto scores = TreeScorer(ensemble, kernels).score(features);
      ASSERT_EQ(scores.size(), rows);
      for (std::size_t r = 0; r < rows; ++r)
        EXPECT_EQ(scores[r], walkedOneByOne(ensemble, features.data() + r * kColumns)) << r;
    }
}

TEST(SimdKernels, ScoreRowsWithFourLanesAsOneByOne) {
  expectTheSameBits(simdKernels<4>());
}

TEST(SimdKernels, ScoreRowsWithEightLanesAsOneByOne) {
  if (!hasEightLanes()) GTEST_SKIP() << "this machine has no AVX2";
  expectTheSameBits(simdKernels<8>());
}

}  // namespace
}  // namespace cluxel::perception
