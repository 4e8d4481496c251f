// SPDX-License-Identifier: Apache-2.0
// Boosting rounds: derivatives, one oblivious tree for all labels, leaves, scores.
#include "cluxel/perception/unary_training.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cluxel/base/parallel.hpp"
#include "perception/feature_bins.hpp"
#include "perception/hashed_share.hpp"

namespace cluxel {

namespace {

constexpr std::size_t kLabels = kPrimitiveLabelCount;
constexpr float kSmallestCurvature = 1e-6F;
constexpr std::size_t kRowsPerPiece = 8192;

/// First and second derivatives of the loss by each label's score; padded to whole vector registers.
struct alignas(16) Derivatives {
  std::array<float, 12> value{};  // 5 first, 5 second, 2 unused
  void add(const Derivatives& other) {
    for (std::size_t k = 0; k < value.size(); ++k) value[k] += other.value[k];
  }
};

Derivatives derivativesAt(const LabelValues& scores, const LabelValues& targets, float scale) {
  const LabelValues shares = softmax(scores);
  float weight = 0;
  for (const float target : targets) weight += scale * target;
  Derivatives at;
  for (std::size_t k = 0; k < kLabels; ++k) {
    at.value[k] = weight * shares[k] - scale * targets[k];
    at.value[kLabels + k] = std::max(weight * shares[k] * (1.0F - shares[k]), kSmallestCurvature * weight);
  }
  return at;
}

/// How far a row is from its label, times its weight.
float slopeOf(const Derivatives& at) {
  float sum = 0;
  for (std::size_t k = 0; k < kLabels; ++k) sum += std::abs(at.value[k]);
  return sum;
}

/// How much the loss falls when these rows get their best leaf, up to a factor of 2.
double gainOf(const Derivatives& sum, double l2) {
  double gain = 0;
  for (std::size_t k = 0; k < kLabels; ++k) {
    const double slope = static_cast<double>(sum.value[k]);
    gain += slope * slope / (static_cast<double>(sum.value[kLabels + k]) + l2);
  }
  return gain;
}

struct SplitChoice {
  double gain = -std::numeric_limits<double>::infinity();
  std::size_t column = 0, cut = 0;
};

/// The rows of one round and the leaves they have reached.
struct RoundRows {
  std::vector<std::uint32_t> row;
  std::vector<std::uint32_t> leaf;
  std::vector<Derivatives> derivatives;
};

/// The best cut of one column: all leaves of the level are cut there alike.
SplitChoice bestCut(const FeatureBins& bins, std::size_t column, const RoundRows& rows, std::size_t leaves, double l2) {
  SplitChoice best;
  const std::size_t cuts = bins.cuts(column).size();
  if (cuts == 0) return best;
  std::vector<Derivatives> histogram(leaves * (cuts + 1));
  const std::uint8_t* bin = bins.bins(column);
  for (std::size_t i = 0; i < rows.row.size(); ++i)
    histogram[rows.leaf[i] * (cuts + 1) + bin[rows.row[i]]].add(rows.derivatives[i]);
  std::vector<double> gain(cuts, 0.0);
  for (std::size_t leaf = 0; leaf < leaves; ++leaf) {
    Derivatives* const at = histogram.data() + leaf * (cuts + 1);
    for (std::size_t b = 1; b <= cuts; ++b) at[b].add(at[b - 1]);
    for (std::size_t cut = 0; cut < cuts; ++cut) {
      Derivatives above = at[cuts];
      for (std::size_t k = 0; k < above.value.size(); ++k) above.value[k] -= at[cut].value[k];
      for (std::size_t k = kLabels; k < 2 * kLabels; ++k) above.value[k] = std::max(above.value[k], 0.0F);
      gain[cut] += gainOf(at[cut], l2) + gainOf(above, l2);
    }
  }
  const auto most = std::max_element(gain.begin(), gain.end());
  return {*most, column, static_cast<std::size_t>(most - gain.begin())};
}

class Booster {
 public:
  Booster(const UnaryRows& rows, const BoostingParams& params, unsigned threads)
      : x_rows(rows), x_params(params), x_threads(threads), x_bins(rows, params, threads), x_scale(meanScale(rows)) {
    x_ensemble.columns = rows.columns;
    x_ensemble.bias = priorScores();
    x_scores.assign(rows.size(), x_ensemble.bias);
  }

  TreeEnsemble grow() {
    for (int round = 0; round < x_params.trees; ++round) {
      RoundRows rows = sample(round);
      const std::vector<SplitChoice> splits = chooseSplits(round, rows);
      if (splits.empty()) break;
      addTree(splits, rows);
    }
    return std::move(x_ensemble);
  }

 private:
  static float meanScale(const UnaryRows& rows) {
    double sum = 0;
    for (const LabelValues& targets : rows.targets)
      for (const float target : targets) sum += static_cast<double>(target);
    return sum > 0 ? static_cast<float>(static_cast<double>(rows.size()) / sum) : 1.0F;
  }

  LabelValues priorScores() const {
    std::array<double, kLabels> sums{};
    double total = 1e-9;
    for (const LabelValues& targets : x_rows.targets)
      for (std::size_t k = 0; k < kLabels; ++k) {
        sums[k] += static_cast<double>(targets[k]);
        total += static_cast<double>(targets[k]);
      }
    LabelValues scores;
    for (std::size_t k = 0; k < kLabels; ++k) scores[k] = static_cast<float>(std::log(sums[k] / total + 1e-4));
    return scores;
  }

  /// Rows drawn for one round: those that are still labelled badly nearly always, the others now and then and heavier.
  RoundRows sample(int round) const {
    std::vector<Derivatives> all(x_rows.size());
    std::vector<float> size(x_rows.size());
    parallelFor(x_rows.size() / kRowsPerPiece + 1, x_threads, [&](std::size_t piece) {
      const std::size_t end = std::min(x_rows.size(), (piece + 1) * kRowsPerPiece);
      for (std::size_t r = piece * kRowsPerPiece; r < end; ++r) {
        all[r] = derivativesAt(x_scores[r], x_rows.targets[r], x_scale);
        size[r] = slopeOf(all[r]);
      }
    });
    double mean = 1e-12;
    for (const float value : size) mean += static_cast<double>(value) / static_cast<double>(size.size());
    RoundRows rows;
    for (std::uint32_t r = 0; r < x_rows.size(); ++r) {
      const double share = std::min(1.0, x_params.row_share * (0.2 + 0.8 * static_cast<double>(size[r]) / mean));
      if (hashedShare(x_params.seed, static_cast<std::uint64_t>(2 * round), r) >= share) continue;
      for (float& value : all[r].value) value *= static_cast<float>(1.0 / share);
      rows.row.push_back(r);
      rows.derivatives.push_back(all[r]);
    }
    rows.leaf.assign(rows.row.size(), 0);
    return rows;
  }

  std::vector<std::size_t> columnsOf(int round) const {
    std::vector<std::size_t> columns;
    for (std::size_t c = 0; c < x_bins.columns(); ++c)
      if (hashedShare(x_params.seed, static_cast<std::uint64_t>(2 * round + 1), c) < x_params.column_share)
        columns.push_back(c);
    return columns;
  }

  std::vector<SplitChoice> chooseSplits(int round, RoundRows& rows) const {
    const std::vector<std::size_t> columns = columnsOf(round);
    std::vector<SplitChoice> splits;
    for (int level = 0; level < x_params.depth; ++level) {
      std::vector<SplitChoice> choices(columns.size());
      parallelFor(columns.size(), x_threads, [&](std::size_t i) {
        choices[i] = bestCut(x_bins, columns[i], rows, std::size_t{1} << level, x_params.l2);
      });
      SplitChoice best;
      for (const SplitChoice& choice : choices)
        if (choice.gain > best.gain) best = choice;
      if (!std::isfinite(best.gain)) break;
      const std::uint8_t* bin = x_bins.bins(best.column);
      for (std::size_t i = 0; i < rows.row.size(); ++i)
        rows.leaf[i] |= static_cast<std::uint32_t>(bin[rows.row[i]] > best.cut) << level;
      splits.push_back(best);
    }
    return splits;
  }

  std::vector<LabelValues> leavesOf(const RoundRows& rows, std::size_t count) const {
    std::vector<Derivatives> sums(count);
    for (std::size_t i = 0; i < rows.row.size(); ++i) sums[rows.leaf[i]].add(rows.derivatives[i]);
    std::vector<LabelValues> leaves(count);
    for (std::size_t leaf = 0; leaf < count; ++leaf)
      for (std::size_t k = 0; k < kLabels; ++k) {
        const double step = -static_cast<double>(sums[leaf].value[k]) /
                            (static_cast<double>(sums[leaf].value[kLabels + k]) + x_params.l2);
        const double value = x_params.learning_rate * std::clamp(step, -8.0, 8.0);
        leaves[leaf][k] = static_cast<float>(std::nearbyint(value / static_cast<double>(kLeafStep))) * kLeafStep;
      }
    return leaves;
  }

  void addTree(const std::vector<SplitChoice>& splits, const RoundRows& rows) {
    ObliviousTree tree;
    for (const SplitChoice& split : splits)
      tree.splits.push_back({static_cast<std::uint32_t>(split.column), x_bins.cuts(split.column)[split.cut]});
    tree.leaves = leavesOf(rows, std::size_t{1} << splits.size());
    parallelFor(x_rows.size() / kRowsPerPiece + 1, x_threads, [&](std::size_t piece) {
      const std::size_t end = std::min(x_rows.size(), (piece + 1) * kRowsPerPiece);
      for (std::size_t r = piece * kRowsPerPiece; r < end; ++r) {
        std::size_t leaf = 0;
        for (std::size_t level = 0; level < splits.size(); ++level)
          leaf |= static_cast<std::size_t>(x_bins.bins(splits[level].column)[r] > splits[level].cut) << level;
        for (std::size_t k = 0; k < kLabels; ++k) x_scores[r][k] += tree.leaves[leaf][k];
      }
    });
    x_ensemble.trees.push_back(std::move(tree));
  }

  const UnaryRows& x_rows;
  const BoostingParams& x_params;
  unsigned x_threads;
  FeatureBins x_bins;
  float x_scale;
  TreeEnsemble x_ensemble;
  std::vector<LabelValues> x_scores;
};

}  // namespace

TreeEnsemble growTrees(const UnaryRows& rows, const BoostingParams& params, unsigned threads) {
  return Booster(rows, params, threads).grow();
}

}  // namespace cluxel
