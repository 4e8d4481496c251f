// SPDX-License-Identifier: Apache-2.0
// Optimisations of the perception stages: SIMD kernels, four eigenproblems at once, radix sort.
#include <Eigen/Eigenvalues>
#include <bit>
#include <boost/sort/pdqsort/pdqsort.hpp>
#include <boost/sort/spreadsort/integer_sort.hpp>
#include <cstdint>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "ablation.hpp"
#include "base/radix_order.hpp"
#include "bench_scans.hpp"
#include "perception/crf/pair_cost_table.hpp"
#include "perception/crf/tree_scoring.hpp"
#include "perception/features/cluxel_graph.hpp"
#include "perception/features/eigen_shape.hpp"
#include "perception/pipeline.hpp"

namespace cluxel::bench {

namespace {

using namespace perception;

/// Processor time of each stage, and the outputs.
struct StageRun final : StageObserver {
  TileOutputs outputs;
  std::map<Stage, double> seconds;
  void finished(Stage stage, double cpu_s) override { seconds[stage] += cpu_s; }
};

std::size_t checksumOf(const auto& rows) {
  std::size_t sum = 0;
  for (const auto& row : rows)
    for (const float value : row) sum = sum * 31 + std::bit_cast<std::uint32_t>(value);
  return sum;
}

/// Scores row by row and tree by tree.
std::vector<LabelValues> plainScores(const TreeEnsemble& ensemble, const std::vector<float>& features) {
  std::vector<LabelValues> scores(features.size() / ensemble.columns, ensemble.bias);
  for (std::size_t row = 0; row < scores.size(); ++row) {
    const float* values = features.data() + row * ensemble.columns;
    for (const ObliviousTree& tree : ensemble.trees) {
      std::size_t leaf = 0;
      for (std::size_t d = tree.splits.size(); d-- > 0;)
        leaf = 2 * leaf + (values[tree.splits[d].column] > tree.splits[d].threshold ? 1 : 0);
      for (std::size_t k = 0; k < scores[row].size(); ++k) scores[row][k] += tree.leaves[leaf][k];
    }
  }
  return scores;
}

Comparison treeComparison(const LabelModel& model, const StageRun& run) {
  std::vector<float> rows;
  for (const auto& [key, tile] : run.outputs.features)
    rows.insert(rows.end(), tile.features.begin(), tile.features.end());
  const auto& features = kept(std::move(rows));
  const TreeEnsemble& trees = model.unary;
  const auto scoredBy = [&features, &trees](const SimdKernels& kernels) {
    return [&features, scorer = std::make_shared<TreeScorer>(trees, kernels)] {
      return checksumOf(scorer->score(features));
    };
  };
  Comparison result{"scores of all cluxels by the trees", "labels", run.seconds.at(Stage::Labels), {}};
  if (hasEightLanes()) result.sides.push_back({"AVX2 kernel", scoredBy(simdKernels<8>())});
  result.sides.push_back({"four-lane kernel", scoredBy(simdKernels<4>())});
  result.sides.push_back({"plain loops", [&] { return checksumOf(plainScores(trees, features)); }});
  return result;
}

Comparison pairComparison(const LabelModel& model, const StageRun& run) {
  const std::size_t columns = model.pairs.knots.size();
  std::vector<PairCostTable::Edge> found;
  for (const auto& [key, tile] : run.outputs.features)
    for (std::size_t row = 0; row * columns < tile.edge_features.size(); ++row)
      found.push_back({tile.edge_features.data() + row * columns, static_cast<std::uint32_t>(12 + row % 20)});
  const auto& edges = kept(std::move(found));
  const auto computedBy = [&](const SimdKernels& kernels) {
    return [&edges, table = std::make_shared<PairCostTable>(model.pairs, kernels)] {
      return checksumOf(table->costsOf(edges));
    };
  };
  Comparison result{"pair costs of all edges", "labels", run.seconds.at(Stage::Labels), {}};
  if (hasEightLanes()) result.sides.push_back({"AVX2 kernel", computedBy(simdKernels<8>())});
  result.sides.push_back({"four-lane kernel", computedBy(simdKernels<4>())});
  result.sides.push_back(
      {"plain formula", [&edges, &model, columns] {
         std::vector<PairCosts> costs;
         for (const PairCostTable::Edge& edge : edges)
           costs.push_back(pairCostsOf(model.pairs, {edge.features, columns}, shareOf(edge.degrees)));
         return checksumOf(costs);
       }});
  return result;
}

/// The number of sets whose axis is steeper than 45 degrees: rounding differs between the sides.
std::size_t steepOf(const Eigen::Vector3d& axis) {
  return std::abs(axis.z()) > 0.70710678 ? 1 : 0;
}

std::size_t fourAtOnce(const std::vector<Covariance>& sets) {
  std::size_t steep = 0;
  FourShapes four;
  const auto keep = [&](std::size_t, const EigenShape& shape) { steep += steepOf(shape.axis); };
  for (std::size_t i = 0; i < sets.size(); ++i) four.add(i, sets[i], keep);
  four.finish(keep);
  return steep;
}

template <typename Number>
std::size_t eigenDirect(const std::vector<Covariance>& sets) {
  std::size_t steep = 0;
  for (const Covariance& s : sets) {
    const double trace = s[0] + s[3] + s[5];
    if (!(trace > kNoExtent_m2)) continue;
    Eigen::Matrix3d matrix;
    matrix << s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5];
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix<Number, 3, 3>> solver;
    solver.computeDirect((matrix / trace).template cast<Number>());
    steep += steepOf(solver.eigenvectors().col(2).template cast<double>());
  }
  return steep;
}

/// As many sets as the features of one tile solve, and alike: the balls of own and near cluxels, 1-rings and 2-rings of
/// own ones, and one for each occupied grid cell of two sizes.
void collectSets(const Ring<CluxelTile>& ring, std::vector<Covariance>& sets) {
  const RingCluxels cluxels = gatherCluxels(ring);
  const RingGraph graph = intersectionGraph(cluxels);
  const auto ballOf = [&](std::uint32_t c) {
    return covarianceOf(ring[cluxels.name[c].ring]->ball[cluxels.name[c].index]);
  };
  for (std::uint32_t c = 0; c < cluxels.size(); ++c)
    if (cluxels.near[c]) sets.push_back(ballOf(c));
  for (std::uint32_t c = cluxels.own_begin; c < cluxels.own_end; ++c) {
    MomentSum ring1, ring2;
    const auto add = [&](std::uint32_t other, MomentSum& sum) {
      const Eigen::Vector3f d = cluxels.center[other] - cluxels.center[c];
      sum.add(d.x(), d.y(), d.z());
    };
    add(c, ring1);
    add(c, ring2);
    for (const std::uint32_t first : graph.neighbours(c)) {
      add(first, ring1);
      for (const std::uint32_t second : graph.neighbours(first)) add(second, ring2);
    }
    sets.push_back(covarianceOf(ring1));
    sets.push_back(covarianceOf(ring2));
  }
  for (const float cell_m : {0.5F, 1.0F}) {
    std::set<std::array<int, 3>> cells;
    for (std::uint32_t c = cluxels.own_begin; c < cluxels.own_end; ++c) {
      const Eigen::Vector3i cell = (cluxels.center[c] / cell_m).array().floor().cast<int>();
      if (cells.insert({cell.x(), cell.y(), cell.z()}).second) sets.push_back(ballOf(c));
    }
  }
}

Comparison eigenComparison(const StageRun& run) {
  std::vector<Covariance> found;
  for (const auto& [key, tile] : run.outputs.cluxels) collectSets(ringIn(run.outputs.cluxels, key), found);
  const auto& sets = kept(std::move(found));
  return {"eigenvectors of all sets of the features",
          "features",
          run.seconds.at(Stage::Features),
          {{"four at once", [&] { return fourAtOnce(sets); }},
           {"Eigen computeDirect, float", [&] { return eigenDirect<float>(sets); }},
           {"Eigen computeDirect, double", [&] { return eigenDirect<double>(sets); }}}};
}

using Keys = std::vector<std::uint64_t>;

/// A grid cell of each point, z above y above x, as the grids of clustering have them.
std::vector<Keys> cellKeys(const TileOutputs& outputs) {
  std::vector<Keys> tiles;
  for (const auto& [key, tile] : outputs.points) {
    Keys keys;
    for (std::size_t i = 0; i < tile.size(); ++i) {
      const auto cell = [](float value) {
        return static_cast<std::uint64_t>(static_cast<std::int64_t>(value / 0.2F) + 4096);
      };
      keys.push_back(cell(tile.z[i]) << 42U | cell(tile.y[i]) << 21U | cell(tile.x[i]));
    }
    tiles.push_back(std::move(keys));
  }
  return tiles;
}

/// Sorts pairs of key and index by a library's algorithm.
template <typename Sort>
std::vector<std::uint32_t> orderBy(const Keys& keys, const Sort& sort) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> pairs(keys.size());
  for (std::uint32_t i = 0; i < keys.size(); ++i) pairs[i] = {keys[i], i};
  sort(pairs);
  std::vector<std::uint32_t> order(keys.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = pairs[i].second;
  return order;
}

/// Compacts key and index into one number and sorts the numbers.
template <typename Sort>
std::vector<std::uint32_t> orderCompacted(const Keys& keys, const Sort& sort) {
  const KeyBits packed(keys.size(), [&](std::size_t i) { return keys[i]; });
  Keys numbers(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) numbers[i] = packed(keys[i]) << 32U | i;
  sort(numbers);
  return {numbers.begin(), numbers.end()};  // the lower half of each
}

Comparison orderComparison(const StageRun& run) {
  const auto& tiles = kept(cellKeys(run.outputs));
  const auto side = [&tiles](const std::string& name, const auto& orderOfKeys) {
    return Side{name, [&tiles, orderOfKeys] {
                  std::size_t sum = 0;
                  for (const Keys& keys : tiles)
                    for (const std::uint32_t i : orderOfKeys(keys)) sum = sum * 31 + i;
                  return sum;
                }};
  };
  const auto std_sort = [](auto& values) { std::sort(values.begin(), values.end()); };
  const auto pdq = [](auto& values) { boost::sort::pdqsort_branchless(values.begin(), values.end()); };
  const auto spread = [](auto& values) { boost::sort::spreadsort::integer_sort(values.begin(), values.end()); };
  return {"order of the points of all tiles by cell",
          "cluxels",
          run.seconds.at(Stage::Cluxels),
          {side("radix order", [](const Keys& keys) { return orderOf(keys); }),
           side("std::sort, pairs", [=](const Keys& keys) { return orderBy(keys, std_sort); }),
           side("std::sort, compacted keys", [=](const Keys& keys) { return orderCompacted(keys, std_sort); }),
           side("Boost pdqsort, compacted keys", [=](const Keys& keys) { return orderCompacted(keys, pdq); }),
           side("Boost spreadsort, compacted keys", [=](const Keys& keys) { return orderCompacted(keys, spread); })}};
}

}  // namespace

std::vector<Comparison> stageComparisons(const std::vector<scan::Scan>& scans) {
  const LabelModel& model = kept(loadModel(sourceFolder() / "models/oakland"));
  static StageRun run;
  runStages(segmentsOf(scans), TileLabeller(model), {}, run.outputs, {.observer = &run});
  return {treeComparison(model, run), pairComparison(model, run), eigenComparison(run), orderComparison(run)};
}

}  // namespace cluxel::bench
