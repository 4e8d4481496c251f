// SPDX-License-Identifier: Apache-2.0
// Points to features, stage by stage, on one core: `perception_bench [--rounds N] SCANS...` prints points per second.
#include <ctime>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "cluxel/perception/tile_pipeline.hpp"
#include "cluxel/scan/scan_set.hpp"

namespace {

using namespace cluxel;

struct StageTime {
  std::string name;
  double seconds = 0;
};

/// Processor time, so that other work on the machine counts less.
double secondsOf(const std::function<void()>& work) {
  const std::clock_t start = std::clock();
  work();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

/// One pass over all stages, with the time of each; outputs go to `tiles`.
std::vector<StageTime> runOnce(const std::vector<Scan>& scans, const PerceptionParams& params, PerceivedTiles& tiles) {
  std::vector<StageTime> times;
  const auto timed = [&](const char* name, const std::function<void()>& work) { times.push_back({name, secondsOf(work)}); };
  std::map<TileKey, std::vector<ScanSegment>> segments;
  timed("split into tiles", [&] {
    for (const auto& scan : scans)
      for (auto& [key, segment] : splitScan(scan)) segments[key].push_back(std::move(segment));
  });
  timed("thin", [&] {
    for (const auto& [key, parts] : segments) {
      std::vector<const ScanSegment*> pointers;
      for (const auto& part : parts) pointers.push_back(&part);
      tiles.points[key] = thin(key, pointers, params.thin);
    }
  });
  timed("cover", [&] {
    for (const auto& [key, points] : tiles.points) tiles.cluxels[key] = coverTile(ringIn(tiles.points, key), params.cover);
  });
  timed("ground", [&] {
    for (const auto& [key, points] : tiles.points) tiles.ground[key] = groundOf(ringIn(tiles.cluxels, key), params.ground);
  });
  timed("graph and features", [&] {
    for (const auto& [key, points] : tiles.points)
      tiles.features[key] = computeFeatures(ringIn(tiles.cluxels, key), ringIn(tiles.ground, key), params.features);
  });
  return times;
}

void print(const std::vector<StageTime>& best, const PerceivedTiles& tiles, std::size_t points) {
  std::size_t kept = 0, cluxels = 0, edges = 0;
  for (const auto& [key, tile] : tiles.points) kept += tile.size();
  for (const auto& [key, tile] : tiles.features) {
    cluxels += tile.size();
    edges += tile.edge_target.size();
  }
  std::printf("%zu points in %zu tiles, %zu after thinning, %zu cluxels, %zu edges\n\n", points, tiles.points.size(), kept,
              cluxels, edges / 2);
  std::printf("| stage | ms | share | Mpoints/s | ns/point |\n|---|---:|---:|---:|---:|\n");
  double total = 0;
  for (const auto& stage : best) total += stage.seconds;
  const auto row = [&](const std::string& name, double seconds) {
    std::printf("| %s | %.1f | %.0f %% | %.2f | %.0f |\n", name.c_str(), seconds * 1e3, 100 * seconds / total,
                static_cast<double>(points) / seconds * 1e-6, seconds / static_cast<double>(points) * 1e9);
  };
  for (const auto& stage : best) row(stage.name, stage.seconds);
  row("all", total);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::filesystem::path> inputs;
  int rounds = 3;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--rounds") == 0 && i + 1 < argc)
      rounds = std::atoi(argv[++i]);
    else
      inputs.emplace_back(argv[i]);
  }
  ProgressSink sink;
  const ScanSet set = ScanSet::open(inputs, {}, sink);
  std::vector<Scan> scans;
  std::size_t points = 0;
  for (std::size_t i = 0; i < set.size(); ++i) {
    scans.push_back(set.load(i));
    points += scans.back().points.size();
  }
  std::vector<StageTime> best;
  PerceivedTiles tiles;
  for (int round = 0; round < rounds; ++round) {
    const auto times = runOnce(scans, {}, tiles);
    if (best.empty()) best = times;
    for (std::size_t i = 0; i < times.size(); ++i) best[i].seconds = std::min(best[i].seconds, times[i].seconds);
  }
  print(best, tiles, points);
  return 0;
}
