// SPDX-License-Identifier: Apache-2.0
// Boosting rounds: derivatives, one oblivious tree for all labels, leaves, scores.
#include "perception/training/unary_training.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/mixed_bits.hpp"
#include "base/parallel.hpp"
#include "perception/training/feature_bins.hpp"

namespace cluxel::perception {

namespace {

constexpr float kMinCurvature = 1e-6F;
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
  for (std::size_t k = 0; k < scan::kPrimitiveLabelCount; ++k) {
    at.value[k] = weight * shares[k] - scale * targets[k];
    at.value[scan::kPrimitiveLabelCount + k] =
        std::max(weight * shares[k] * (1.0F - shares[k]), kMinCurvature * weight);
  }
  return at;
}

/// The weighted error of a row.
float slopeOf(const Derivatives& at) {
  float sum = 0;
  for (std::size_t k = 0; k < scan::kPrimitiveLabelCount; ++k) sum += std::abs(at.value[k]);
  return sum;
}

/// Twice the reduction of the loss when these rows get their best leaf.
double gainOf(const Derivatives& sum, double l2) {
  double gain = 0;
  for (std::size_t k = 0; k < scan::kPrimitiveLabelCount; ++k) {
    const double slope = static_cast<double>(sum.value[k]);
    gain += slope * slope / (static_cast<double>(sum.value[scan::kPrimitiveLabelCount + k]) + l2);
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

/// The best cut of one column, shared by all leaves of the level.
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
      for (std::size_t k = scan::kPrimitiveLabelCount; k < 2 * scan::kPrimitiveLabelCount; ++k)
        above.value[k] = std::max(above.value[k], 0.0F);
      gain[cut] += gainOf(at[cut], l2) + gainOf(above, l2);
    }
  }
  const auto highest = std::max_element(gain.begin(), gain.end());
  return {*highest, column, static_cast<std::size_t>(highest - gain.begin())};
}

class Booster {
 public:
  Booster(const UnaryRows& rows, const BoostingParams& params, unsigned threads)
      : rows_(rows), params_(params), threads_(threads), bins_(rows, params, threads), scale_(meanScale(rows)) {
    ensemble_.columns = rows.columns;
    ensemble_.bias = priorScores();
    scores_.assign(rows.size(), ensemble_.bias);
  }

  TreeEnsemble grow() {
    for (int round = 0; round < params_.trees; ++round) {
      RoundRows rows = sample(round);
      const std::vector<SplitChoice> splits = chooseSplits(round, rows);
      if (splits.empty()) break;
      addTree(splits, rows);
    }
    return std::move(ensemble_);
  }

 private:
  static float meanScale(const UnaryRows& rows) {
    double sum = 0;
    for (const LabelValues& targets : rows.targets)
      for (const float target : targets) sum += static_cast<double>(target);
    return sum > 0 ? static_cast<float>(static_cast<double>(rows.size()) / sum) : 1.0F;
  }

  LabelValues priorScores() const {
    std::array<double, scan::kPrimitiveLabelCount> sums{};
    double total = 1e-9;
    for (const LabelValues& targets : rows_.targets)
      for (std::size_t k = 0; k < scan::kPrimitiveLabelCount; ++k) {
        sums[k] += static_cast<double>(targets[k]);
        total += static_cast<double>(targets[k]);
      }
    LabelValues scores;
    for (std::size_t k = 0; k < scan::kPrimitiveLabelCount; ++k)
      scores[k] = static_cast<float>(std::log(sums[k] / total + 1e-4));
    return scores;
  }

  /// Rows sampled for one round: with high probability if their error is large, else rarely and with a higher weight.
  RoundRows sample(int round) const {
    std::vector<Derivatives> all(rows_.size());
    std::vector<float> size(rows_.size());
    parallelFor(rows_.size() / kRowsPerPiece + 1, threads_, [&](std::size_t piece) {
      const std::size_t end = std::min(rows_.size(), (piece + 1) * kRowsPerPiece);
      for (std::size_t r = piece * kRowsPerPiece; r < end; ++r) {
        all[r] = derivativesAt(scores_[r], rows_.targets[r], scale_);
        size[r] = slopeOf(all[r]);
      }
    });
    double mean = 1e-12;
    for (const float value : size) mean += static_cast<double>(value) / static_cast<double>(size.size());
    RoundRows rows;
    for (std::uint32_t r = 0; r < rows_.size(); ++r) {
      const double share = std::min(1.0, params_.row_share * (0.2 + 0.8 * static_cast<double>(size[r]) / mean));
      if (hashedShare(params_.seed, static_cast<std::uint64_t>(2 * round), r) >= share) continue;
      for (float& value : all[r].value) value *= static_cast<float>(1.0 / share);
      rows.row.push_back(r);
      rows.derivatives.push_back(all[r]);
    }
    rows.leaf.assign(rows.row.size(), 0);
    return rows;
  }

  std::vector<std::size_t> columnsOf(int round) const {
    std::vector<std::size_t> columns;
    for (std::size_t c = 0; c < bins_.columns(); ++c)
      if (hashedShare(params_.seed, static_cast<std::uint64_t>(2 * round + 1), c) < params_.column_share)
        columns.push_back(c);
    return columns;
  }

  std::vector<SplitChoice> chooseSplits(int round, RoundRows& rows) const {
    const std::vector<std::size_t> columns = columnsOf(round);
    std::vector<SplitChoice> splits;
    for (int level = 0; level < params_.depth; ++level) {
      std::vector<SplitChoice> choices(columns.size());
      parallelFor(columns.size(), threads_, [&](std::size_t i) {
        choices[i] = bestCut(bins_, columns[i], rows, std::size_t{1} << level, params_.l2);
      });
      SplitChoice best;
      for (const SplitChoice& choice : choices)
        if (choice.gain > best.gain) best = choice;
      if (!std::isfinite(best.gain)) break;
      const std::uint8_t* bin = bins_.bins(best.column);
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
      for (std::size_t k = 0; k < scan::kPrimitiveLabelCount; ++k) {
        const double step = -static_cast<double>(sums[leaf].value[k]) /
                            (static_cast<double>(sums[leaf].value[scan::kPrimitiveLabelCount + k]) + params_.l2);
        const double value = params_.learning_rate * std::clamp(step, -8.0, 8.0);
        leaves[leaf][k] = static_cast<float>(std::nearbyint(value / static_cast<double>(kLeafStep))) * kLeafStep;
      }
    return leaves;
  }

  void addTree(const std::vector<SplitChoice>& splits, const RoundRows& rows) {
    ObliviousTree tree;
    for (const SplitChoice& split : splits)
      tree.splits.push_back({static_cast<std::uint32_t>(split.column), bins_.cuts(split.column)[split.cut]});
    tree.leaves = leavesOf(rows, std::size_t{1} << splits.size());
    parallelFor(rows_.size() / kRowsPerPiece + 1, threads_, [&](std::size_t piece) {
      const std::size_t end = std::min(rows_.size(), (piece + 1) * kRowsPerPiece);
      for (std::size_t r = piece * kRowsPerPiece; r < end; ++r) {
        std::size_t leaf = 0;
        for (std::size_t level = 0; level < splits.size(); ++level)
          leaf |= static_cast<std::size_t>(bins_.bins(splits[level].column)[r] > splits[level].cut) << level;
        for (std::size_t k = 0; k < scan::kPrimitiveLabelCount; ++k) scores_[r][k] += tree.leaves[leaf][k];
      }
    });
    ensemble_.trees.push_back(std::move(tree));
  }

  const UnaryRows& rows_;
  const BoostingParams& params_;
  unsigned threads_;
  FeatureBins bins_;
  float scale_;
  TreeEnsemble ensemble_;
  std::vector<LabelValues> scores_;
};

}  // namespace

TreeEnsemble growTrees(const UnaryRows& rows, const BoostingParams& params, unsigned threads) {
  return Booster(rows, params, threads).grow();
}

}  // namespace cluxel::perception
