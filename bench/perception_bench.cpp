// SPDX-License-Identifier: Apache-2.0
// Points to primitives, stage by stage, on one core: `perception_bench [--rounds N] [--digest] [SCANS...]` prints
// points per second, the best of N rounds for each stage. Without scans it uses Oakland part 2 from the outside data,
// or a generated campus where that is absent. --digest also prints a hash of every stage's output: a faster program
// must produce identical output.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <span>
#include <string>
#include <vector>

#include "base/content_hash.hpp"
#include "bench_scans.hpp"
#include "perception/pipeline.hpp"

namespace {

using namespace cluxel;

struct StageTime {
  std::string name;
  double seconds = 0;
};

/// Processor time, so that other work on the machine counts less.
double processorSeconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// Collects the time of each stage.
class Stopwatch final : public perception::StageObserver {
 public:
  void finished(perception::Stage stage, double cpu_s) override {
    for (auto& [name, seconds] : times_)
      if (name == nameOf(stage)) return void(seconds += cpu_s);
    times_.push_back({std::string(nameOf(stage)), cpu_s});
  }
  template <typename Work>
  auto timed(const char* name, const Work& work) {
    const double start_s = processorSeconds();
    auto result = work();
    times_.push_back({name, processorSeconds() - start_s});
    return result;
  }
  const std::vector<StageTime>& times() const { return times_; }

 private:
  std::vector<StageTime> times_;
};

/// Outputs of one pass.
struct Outputs {
  perception::TileOutputs tiles;
  perception::Scene scene;
};

/// One pass over all stages, with the time of each.
std::vector<StageTime> runOnce(const std::vector<scan::Scan>& scans, const perception::LabelModel& model,
                               Outputs& out) {
  const perception::SceneParams params;
  const perception::TileLabeller labeller(model);
  Stopwatch watch;
  auto segments = watch.timed("split into tiles", [&] { return perception::segmentsOf(scans); });
  runStages(std::move(segments), labeller, params, out.tiles, {.observer = &watch});
  out.scene = watch.timed("scene", [&] { return assembleScene(out.tiles, params.relation); });
  return watch.times();
}

void print(const std::vector<StageTime>& best, const Outputs& out, std::size_t points) {
  std::size_t kept = 0, cluxels = 0, edges = 0;
  for (const auto& [key, tile] : out.tiles.points) kept += tile.size();
  for (const auto& [key, tile] : out.tiles.features) {
    cluxels += tile.size();
    edges += tile.edge_target.size();
  }
  std::printf("%zu points in %zu tiles, %zu after thinning, %zu cluxels, %zu edges, %zu primitives\n\n", points,
              out.tiles.points.size(), kept, cluxels, edges / 2, out.scene.primitives.size());
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

ContentHash digestOf(const perception::Scene& scene) {
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
  row("points", digestOf(out.tiles.points));
  row("cluxels", digestOf(out.tiles.cluxels));
  row("ground", digestOf(out.tiles.ground));
  row("features", digestOf(out.tiles.features));
  row("labels", digestOf(out.tiles.labels));
  row("components", digestOf(out.tiles.components));
  row("contacts", digestOf(out.tiles.contacts));
  row("scene", digestOf(out.scene));
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
  const auto scans = bench::scansFor(inputs);
  const perception::LabelModel model = perception::loadModel(bench::sourceFolder() / "models/oakland");
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
