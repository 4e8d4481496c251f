// SPDX-License-Identifier: Apache-2.0
// Points to primitives, stage by stage, on one core: `perception_bench [--rounds N] [--digest] [SCANS...]` prints
// points per second. Without scans it takes Oakland part 2 from the outside data, and where that is absent a generated
// campus.
// --digest also prints a hash of every stage's output, which tells whether a faster program still says the same.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "cluxel/base/content_hash.hpp"
#include "cluxel/perception/scene_pipeline.hpp"
#include "cluxel/scan/scan_set.hpp"
#include "cluxel/simulation/campus.hpp"
#include "cluxel/simulation/laser.hpp"

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

/// Outputs of all stages of one pass.
struct Outputs {
  PerceivedTiles perceived;
  std::map<TileKey, LabelTile> labels;
  std::map<TileKey, ComponentTile> components;
  std::map<TileKey, ContactTile> contacts;
  Scene scene;
};

/// Collects the time of each stage.
class Stopwatch {
 public:
  /// Times `work` on every tile of `tiles`.
  template <typename Tiles, typename Work>
  void overTiles(const char* name, const Tiles& tiles, const Work& work) {
    once(name, [&] {
      for (const auto& [key, tile] : tiles) work(key);
    });
  }
  void once(const char* name, const std::function<void()>& work) { times_.push_back({name, secondsOf(work)}); }
  const std::vector<StageTime>& times() const { return times_; }

 private:
  std::vector<StageTime> times_;
};

using Segments = std::map<TileKey, std::vector<ScanSegment>>;

Segments splitAll(const std::vector<Scan>& scans) {
  Segments segments;
  for (const auto& scan : scans)
    for (auto& [key, segment] : splitScan(scan)) segments[key].push_back(std::move(segment));
  return segments;
}

TilePoints thinOne(const TileKey& key, const std::vector<ScanSegment>& parts, const ThinParams& params) {
  std::vector<const ScanSegment*> pointers;
  for (const auto& part : parts) pointers.push_back(&part);
  return thin(key, pointers, params);
}

/// One pass over all stages, with the time of each.
std::vector<StageTime> runOnce(const std::vector<Scan>& scans, const LabelModel& model, Outputs& out) {
  const PerceptionParams& params = model.perception;
  const SceneParams scene;
  auto& [points, cluxels, ground, features] = out.perceived;
  Stopwatch watch;
  Segments segments;
  watch.once("split into tiles", [&] { segments = splitAll(scans); });
  watch.overTiles("thin", segments,
                  [&](const TileKey& key) { points[key] = thinOne(key, segments.at(key), params.thin); });
  watch.overTiles("cover", points,
                  [&](const TileKey& key) { cluxels[key] = coverTile(ringIn(points, key), params.cover); });
  watch.overTiles("ground", points,
                  [&](const TileKey& key) { ground[key] = groundOf(ringIn(cluxels, key), params.ground); });
  watch.overTiles("graph and features", points, [&](const TileKey& key) {
    features[key] = computeFeatures(ringIn(cluxels, key), ringIn(ground, key), params.features);
  });
  const TileLabeller labeller(model);
  watch.overTiles("labels (CRF)", points, [&](const TileKey& key) {
    out.labels[key] = labeller.label(ringIn(features, key), scene.labelling);
  });
  watch.overTiles("components", points, [&](const TileKey& key) {
    out.components[key] = componentsOf(points.at(key), cluxels.at(key), features.at(key), out.labels.at(key),
                                       ringIn(ground, key), scene.component);
  });
  watch.overTiles("contacts", points, [&](const TileKey& key) {
    out.contacts[key] =
        contactsOf(ringIn(out.components, key), ringIn(cluxels, key), features.at(key), scene.component, scene.contact);
  });
  watch.once("primitives and relations", [&] {
    out.scene =
        assembleScene({points, cluxels, features, ground, out.labels, out.components, out.contacts}, scene.relation);
  });
  return watch.times();
}

void print(const std::vector<StageTime>& best, const Outputs& out, std::size_t points) {
  std::size_t kept = 0, cluxels = 0, edges = 0;
  for (const auto& [key, tile] : out.perceived.points) kept += tile.size();
  for (const auto& [key, tile] : out.perceived.features) {
    cluxels += tile.size();
    edges += tile.edge_target.size();
  }
  std::printf("%zu points in %zu tiles, %zu after thinning, %zu cluxels, %zu edges, %zu primitives\n\n", points,
              out.perceived.points.size(), kept, cluxels, edges / 2, out.scene.primitives.size());
  std::printf("| stage | ms | share | Mpoints/s | ns/point |\n|---|---:|---:|---:|---:|\n");
  double total = 0;
  for (const auto& stage : best) total += stage.seconds;
  const auto row = [&](const std::string& name, double seconds) {
    std::printf("| %s | %.1f | %.0f %% | %.2f | %.0f |\n", name.c_str(), seconds * 1e3, 100 * seconds / total,
                static_cast<double>(points) / seconds * 1e-6, seconds / static_cast<double>(points) * 1e9);
  };
  for (const auto& stage : best) row(stage.name, stage.seconds);
  row("points to primitives", total);
}

template <typename Tiles>
ContentHash digestOf(const Tiles& tiles) {
  ContentHasher hasher;
  for (const auto& [key, tile] : tiles) hasher.addText(toBytes(tile));
  return hasher.finish();
}

ContentHash digestOf(const Scene& scene) {
  ContentHasher hasher;
  for (const auto& primitive : scene.primitives) {
    hasher.add(primitive.id).add(primitive.label).addSpan(std::span<const double>(primitive.attributes));
    hasher.addSpan(std::span<const std::uint32_t>(primitive.cluxels));
  }
  for (const auto& relation : scene.relations)
    hasher.add(relation.kind).add(relation.from).add(relation.to).add(relation.measure);
  return hasher.finish();
}

void printDigests(const Outputs& out) {
  const auto row = [](const char* name, const ContentHash& hash) {
    std::printf("%-12s %s\n", name, hash.hex().c_str());
  };
  std::printf("\n");
  row("points", digestOf(out.perceived.points));
  row("cluxels", digestOf(out.perceived.cluxels));
  row("ground", digestOf(out.perceived.ground));
  row("features", digestOf(out.perceived.features));
  row("labels", digestOf(out.labels));
  row("components", digestOf(out.components));
  row("contacts", digestOf(out.contacts));
  row("scene", digestOf(out.scene));
}

std::vector<Scan> loadScans(const std::vector<std::filesystem::path>& inputs) {
  ProgressSink sink;
  const ScanSet set = ScanSet::open(inputs, {}, sink);
  std::vector<Scan> scans;
  for (std::size_t i = 0; i < set.size(); ++i) scans.push_back(set.load(i));
  return scans;
}

std::vector<Scan> generatedScans() {
  const Campus campus = buildCampus({.seed = 1, .stops = 6});
  const Laser laser(campus);
  std::vector<Scan> scans;
  for (std::size_t stop = 0; stop < campus.stops.size(); ++stop) scans.push_back(laser.scanAt(stop).scan);
  return scans;
}

std::vector<Scan> scansFor(const std::vector<std::filesystem::path>& inputs) {
  if (!inputs.empty()) return loadScans(inputs);
  const std::filesystem::path source = CLUXEL_SOURCE_DIR;
  const char* given = std::getenv("CLUXEL_DATA");
  const auto oakland = (given != nullptr ? std::filesystem::path(given) : source / "../shared/data") / "oakland3d";
  if (std::filesystem::exists(oakland)) {
    std::printf("Oakland 3-D, part 2: ");
    return loadScans({oakland});
  }
  std::printf("outside data absent, a generated campus instead: ");
  return generatedScans();
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::filesystem::path> inputs;
  int rounds = 10;
  bool digest = false;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--rounds") == 0 && i + 1 < argc)
      rounds = std::atoi(argv[++i]);
    else if (std::strcmp(argv[i], "--digest") == 0)
      digest = true;
    else
      inputs.emplace_back(argv[i]);
  }
  const auto scans = scansFor(inputs);
  const LabelModel model = loadModel(std::filesystem::path(CLUXEL_SOURCE_DIR) / "models/oakland");
  std::size_t points = 0;
  for (const auto& scan : scans) points += scan.points.size();
  std::vector<StageTime> best;
  Outputs out;
  for (int round = 0; round < rounds; ++round) {
    out = {};
    const auto times = runOnce(scans, model, out);
    if (best.empty()) best = times;
    for (std::size_t i = 0; i < times.size(); ++i) best[i].seconds = std::min(best[i].seconds, times[i].seconds);
  }
  print(best, out, points);
  if (digest) printDigests(out);
  return 0;
}
