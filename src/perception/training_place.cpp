// SPDX-License-Identifier: Apache-2.0
// Scans with truth to places: perceived tiles and the truth of each cluxel.
#include "cluxel/base/diagnostic.hpp"
#include "cluxel/perception/training.hpp"

namespace cluxel {

namespace {

void countTruth(const PerceivedTiles& tiles, const Scan& scan, const PointTruth& truth, const ThinParams& thin,
                std::map<TileKey, std::vector<TruthCounts>>& counts) {
  std::map<TileKey, RepresentativeFinder> finders;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (truth.primitive[i] < 0) continue;
    const Eigen::Vector3d p_map = toMap(scan.T_map_sensor, {scan.points.x[i], scan.points.y[i], scan.points.z[i]});
    const TileKey key = tileOf(p_map);
    const auto points = tiles.points.find(key);
    if (points == tiles.points.end()) continue;
    const auto finder = finders.try_emplace(key, points->second, thin).first;
    const std::uint32_t kept = finder->second.find(localPoint(key, p_map));
    if (kept == RepresentativeFinder::kNone) continue;
    ++counts.at(key)[tiles.cluxels.at(key).point_cluxel[kept]][static_cast<std::size_t>(truth.primitive[i])];
  }
}

/// A number in [0, 1) from a seed and a point's number (splitmix64).
double hashedShare(std::uint64_t seed, std::uint64_t point) {
  std::uint64_t x = seed * 0x9E3779B97F4A7C15ULL + point * 0xD1B54A32D192ED03ULL + 0x632BE59BD9B4E019ULL;
  x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27U)) * 0x94D049BB133111EBULL;
  return static_cast<double>((x ^ (x >> 31U)) >> 11U) * 0x1.0p-53;
}

template <typename T>
std::vector<T> chosen(const std::vector<T>& values, const std::vector<std::size_t>& keep) {
  std::vector<T> rest;
  if (values.empty()) return rest;
  for (const std::size_t i : keep) rest.push_back(values[i]);
  return rest;
}

}  // namespace

TrainingPlace makePlace(std::span<const Scan> scans, std::span<const PointTruth> truth, const PerceptionParams& params,
                        unsigned threads) {
  PerceivedTiles tiles = perceive(scans, params, threads);
  TrainingPlace place;
  for (const auto& [key, cluxels] : tiles.cluxels) place.truth[key].resize(cluxels.size());
  for (std::size_t s = 0; s < scans.size(); ++s) {
    if (truth[s].primitive.size() != scans[s].points.size())
      throw InputError(SourceLocation{.file = scans[s].source}, "truth for " +
                       std::to_string(truth[s].primitive.size()) + " points, but the scan has " +
                       std::to_string(scans[s].points.size()), "give the truth that belongs to this scan");
    countTruth(tiles, scans[s], truth[s], params.thin, place.truth);
  }
  place.features = std::move(tiles.features);
  return place;
}

LabelledScans thinned(std::span<const Scan> scans, std::span<const PointTruth> truth, double share, std::uint64_t seed) {
  LabelledScans rest;
  for (std::size_t s = 0; s < scans.size(); ++s) {
    std::vector<std::size_t> keep;
    for (std::size_t i = 0; i < scans[s].points.size(); ++i)
      if (hashedShare(seed, i) < share) keep.push_back(i);
    const ScanPoints& points = scans[s].points;
    Scan scan;
    scan.points = {chosen(points.x, keep), chosen(points.y, keep), chosen(points.z, keep), chosen(points.intensity, keep),
                   chosen(points.label, keep), chosen(points.origin, keep)};
    scan.time_s = scans[s].time_s;
    scan.T_map_sensor = scans[s].T_map_sensor;
    scan.has_pose = scans[s].has_pose;
    scan.source = scans[s].source;
    scan.id = contentIdOf(scan);
    rest.scans.push_back(std::move(scan));
    rest.truth.push_back({chosen(truth[s].primitive, keep), {}, {}, {}});
  }
  return rest;
}

}  // namespace cluxel
