// SPDX-License-Identifier: Apache-2.0
// Boosted oblivious trees: accuracy on a known problem, and determinism.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "perception/training/unary_training.hpp"

namespace cluxel::perception {

using namespace scan;
namespace {

/// Two columns decide the label, like elevation and height; a third is noise. A tenth of the labels are wrong.
UnaryRows checkerboard(std::uint32_t seed, std::size_t count) {
  std::mt19937 random(seed);
  const auto uniform = [&] { return static_cast<float>(random() % 10000U) / 10000.0F; };
  UnaryRows rows;
  rows.columns = 3;
  for (std::size_t i = 0; i < count; ++i) {
    const float x = uniform(), y = uniform();
    auto label = static_cast<std::size_t>(x * 3) + (y > 0.5F ? 2U : 0U);
    if (random() % 10U == 0) label = random() % kPrimitiveLabelCount;
    LabelValues target{};
    target[label] = 1;
    rows.targets.push_back(target);
    rows.features.insert(rows.features.end(), {x, y, uniform()});
  }
  return rows;
}

double accuracyOn(const TreeEnsemble& ensemble, const UnaryRows& rows) {
  const auto scores = scoreRows(ensemble, rows.features);
  double right = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto best = std::max_element(scores[i].begin(), scores[i].end()) - scores[i].begin();
    right += static_cast<double>(rows.targets[i][static_cast<std::size_t>(best)]);
  }
  return right / static_cast<double>(rows.size());
}

bool same(const TreeEnsemble& a, const TreeEnsemble& b) {
  if (a.trees.size() != b.trees.size() || a.bias != b.bias) return false;
  for (std::size_t t = 0; t < a.trees.size(); ++t) {
    if (a.trees[t].leaves != b.trees[t].leaves) return false;
    for (std::size_t d = 0; d < a.trees[t].splits.size(); ++d)
      if (a.trees[t].splits[d].column != b.trees[t].splits[d].column ||
          a.trees[t].splits[d].threshold != b.trees[t].splits[d].threshold)
        return false;
  }
  return true;
}

BoostingParams small() {
  return {.trees = 40, .depth = 4, .l2 = 1.0, .column_share = 0.9};
}

TEST(UnaryTraining, LearnsWhatTwoColumnsDecideTogether) {
  const TreeEnsemble ensemble = growTrees(checkerboard(1, 4000), small(), 1);
  EXPECT_GT(accuracyOn(ensemble, checkerboard(2, 4000)), 0.89);  // the noise limits it to 92 %
}

TEST(UnaryTraining, GivesTheSameTreesWithOneAndTwoThreads) {
  const UnaryRows rows = checkerboard(3, 2000);
  const TreeEnsemble one = growTrees(rows, small(), 1), two = growTrees(rows, small(), 2);
  EXPECT_TRUE(same(one, two));
  EXPECT_FALSE(same(one, growTrees(checkerboard(4, 2000), small(), 1)));
}

TEST(UnaryTraining, NeverAsksAboutAColumnThatIsSwitchedOff) {
  BoostingParams params = small();
  params.columns_used = {true, false, true};
  for (const ObliviousTree& tree : growTrees(checkerboard(5, 2000), params, 1).trees)
    for (const TreeSplit& split : tree.splits) EXPECT_NE(split.column, 1U);
}

TEST(UnaryTraining, FavoursARareLabelWhenItWeighsMore) {
  UnaryRows rows = checkerboard(6, 3000);
  const auto labelled = [&](const UnaryRows& trained) {
    std::size_t count = 0;
    for (const LabelValues& score : scoreRows(growTrees(trained, small(), 1), rows.features))
      count += static_cast<std::size_t>(std::max_element(score.begin(), score.end()) == score.begin() + 1);
    return count;
  };
  const std::size_t before = labelled(rows);
  UnaryRows weighted = rows;
  for (LabelValues& target : weighted.targets) target[1] *= 30.0F;
  EXPECT_GT(labelled(weighted), before);
}

TEST(UnaryTraining, SurvivesConstantColumnsAndValuesThatAreNotNumbers) {
  UnaryRows rows = checkerboard(7, 500);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    rows.features[3 * r + 2] = 1.0F;
    if (r % 7 == 0) rows.features[3 * r] = std::numeric_limits<float>::quiet_NaN();
  }
  for (const LabelValues& scores : scoreRows(growTrees(rows, small(), 1), rows.features))
    for (const float score : scores) EXPECT_TRUE(std::isfinite(score));
}

TEST(UnaryTraining, MakesNoTreesOfConstantColumns) {
  UnaryRows rows;
  rows.columns = 1;
  rows.features.assign(50, 2.0F);
  rows.targets.assign(50, LabelValues{1, 0, 0, 0, 0});
  const TreeEnsemble ensemble = growTrees(rows, small(), 1);
  EXPECT_TRUE(ensemble.trees.empty());
  EXPECT_GT(softmax(scoreRows(ensemble, std::vector<float>{7.0F}).front())[0], 0.99F);
}

TEST(UnaryTrees, ScoreARowAlikeAloneAndAmongOthers) {
  const UnaryRows rows = checkerboard(8, 700);
  const TreeEnsemble ensemble = growTrees(rows, small(), 1);
  const auto together = scoreRows(ensemble, rows.features);
  for (std::size_t r = 0; r < rows.size(); r += 37)
    EXPECT_EQ(scoreRows(ensemble, std::span(rows.features).subspan(3 * r, 3)).front(), together[r]);
}

TEST(UnaryTrees, TakeTheLeafThatTheAnswersSpell) {
  TreeEnsemble ensemble{2, {}, {{{{0, 0.5F}, {1, 10.0F}}, std::vector<LabelValues>(4)}}};
  for (std::size_t leaf = 0; leaf < 4; ++leaf) ensemble.trees[0].leaves[leaf][0] = static_cast<float>(leaf);
  const auto scores = scoreRows(ensemble, std::vector<float>{0.5F, 10.0F, 0.6F, 10.0F, 0.5F, 11.0F, 0.6F, 11.0F});
  for (std::size_t row = 0; row < 4; ++row) EXPECT_EQ(scores[row][0], static_cast<float>(row));
}

}  // namespace
}  // namespace cluxel::perception
