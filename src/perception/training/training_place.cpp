// SPDX-License-Identifier: Apache-2.0
// Training places from scans with truth: features by tile and the truth of each cluxel.
#include "cluxel/error.hpp"
#include "perception/pipeline.hpp"
#include "perception/training/training.hpp"

namespace cluxel::perception {

namespace {

void countTruth(const TileOutputs& tiles, const scan::Scan& scan, const scan::PointTruth& truth, const ThinParams& thin,
                std::map<TileKey, std::vector<TruthCounts>>& counts) {
  std::map<TileKey, RepresentativeFinder> finders;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (truth.primitive[i] < 0) continue;
    const Eigen::Vector3d p_map =
        scan::toMap(scan.T_map_sensor, {scan.points.x[i], scan.points.y[i], scan.points.z[i]});
    const TileKey key = tiles.grid.tileOf(p_map);
    const auto points = tiles.points.find(key);
    if (points == tiles.points.end()) continue;
    const auto finder = finders.try_emplace(key, points->second, thin).first;
    const std::uint32_t kept = finder->second.find(localPoint(tiles.grid, key, p_map));
    if (kept == RepresentativeFinder::kNone) continue;
    ++counts.at(key)[tiles.cluxels.at(key).point_cluxel[kept]][static_cast<std::size_t>(truth.primitive[i])];
  }
}

}  // namespace

TrainingPlace makePlace(std::span<const scan::Scan> scans, std::span<const scan::PointTruth> truth,
                        const PerceptionParams& params, unsigned threads) {
  TileOutputs tiles = perceive(scans, params, threads);
  TrainingPlace place;
  for (const auto& [key, cluxels] : tiles.cluxels) place.truth[key].resize(cluxels.size());
  for (std::size_t s = 0; s < scans.size(); ++s) {
    if (truth[s].primitive.size() != scans[s].points.size())
      throw InputError(SourceLocation{.file = scans[s].source},
                       "truth for " + std::to_string(truth[s].primitive.size()) + " points, but the scan has " +
                           std::to_string(scans[s].points.size()),
                       "give the truth that belongs to this scan");
    countTruth(tiles, scans[s], truth[s], params.thin, place.truth);
  }
  place.features = std::move(tiles.features);
  return place;
}

}  // namespace cluxel::perception
