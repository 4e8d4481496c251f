// SPDX-License-Identifier: Apache-2.0
// Tiles are sorted along the direction in which they spread most. A strip ends when it has its share of the weight.
#include "mapping/strips/map_strips.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <map>
#include <utility>

#include "mapping/map_tables.hpp"

namespace cluxel::mapping {

namespace {

using perception::TileKey;
using perception::TileSet;

/// The direction in which places (one a column) spread most, by principal components. x when they spread alike.
Eigen::Vector2d longDirection(const Eigen::Matrix2Xd& places) {
  if (places.cols() < 2) return Eigen::Vector2d::UnitX();
  const Eigen::Matrix2Xd centred = places.colwise() - places.rowwise().mean();
  const Eigen::Matrix2d spread = centred * centred.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(spread);
  const Eigen::Vector2d values = solver.eigenvalues();
  if (!(values[1] > 1.01 * values[0])) return Eigen::Vector2d::UnitX();
  const Eigen::Vector2d along = solver.eigenvectors().col(1);
  return along.x() < 0 || (along.x() == 0 && along.y() < 0) ? Eigen::Vector2d(-along) : along;
}

std::vector<TileKey> sortedAlong(const TileSet& tiles) {
  std::vector<TileKey> sorted(tiles.begin(), tiles.end());
  Eigen::Matrix2Xd places(2, static_cast<Eigen::Index>(sorted.size()));
  for (std::size_t i = 0; i < sorted.size(); ++i)
    places.col(static_cast<Eigen::Index>(i)) = Eigen::Vector2d(sorted[i].x, sorted[i].y);
  const Eigen::Vector2d along = longDirection(places);
  const auto key = [&](const TileKey& tile) { return std::pair(along.x() * tile.x + along.y() * tile.y, tile); };
  std::sort(sorted.begin(), sorted.end(), [&](const TileKey& a, const TileKey& b) { return key(a) < key(b); });
  return sorted;
}

}  // namespace

std::vector<TileSet> stripsOf(const TileSet& tiles, std::size_t count,
                              const std::function<std::uint64_t(const TileKey&)>& weight_of) {
  std::map<TileKey, std::uint64_t> weights;
  std::uint64_t all = 0;
  for (const TileKey& tile : tiles) all += weights[tile] = weight_of(tile);
  std::vector<TileSet> strips(1);
  std::uint64_t of_strip = 0;
  for (const TileKey& tile : sortedAlong(tiles)) {
    if (of_strip > 0 && of_strip * count >= all) strips.emplace_back(), of_strip = 0;
    strips.back().insert(tile);
    of_strip += weights.at(tile);
  }
  return strips;
}

std::uint64_t cluxelsIn(const rdf::ReadTransaction& transaction, const TileSet& tiles,
                        const std::map<TileKey, perception::SummaryTile>& at_hand) {
  std::uint64_t cluxels = 0;
  for (const TileKey& tile : tiles) {
    if (const auto summary = at_hand.find(tile); summary != at_hand.end())
      cluxels += summary->second.size();
    else if (const auto block = transaction.block(tables::kSummaries, tables::keyOf(tile)))
      cluxels += perception::cluxelsIn(*block);
  }
  return cluxels;
}

std::vector<TileSet> layerStripsOf(const rdf::ReadTransaction& transaction, const TileSet& tiles, std::uint64_t cluxels,
                                   std::uint64_t whole_cluxels) {
  constexpr std::uint64_t kStripsOfWhole = 2;  // a strip is decided with what lies beside it, often as large
  const std::uint64_t of_strip = std::max<std::uint64_t>(1, whole_cluxels / kStripsOfWhole);
  const std::uint64_t count = std::max<std::uint64_t>(1, (cluxels + of_strip - 1) / of_strip);
  return stripsOf(tiles, count, [&](const TileKey& tile) {
    const auto block = transaction.block(tables::kSummaries, tables::keyOf(tile));
    return block ? block->size() : 0;
  });
}

}  // namespace cluxel::mapping
