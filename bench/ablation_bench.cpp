// SPDX-License-Identifier: Apache-2.0
// What each optimisation gains over its plain alternative: `ablation_bench [--rounds N]` runs all sides in turn, in N
// rounds, and prints medians of processor time. All sides must give the same checksum.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "ablation.hpp"
#include "bench_scans.hpp"

namespace {

using namespace cluxel;

double processorSeconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

double medianOf(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Prints one row per side, with the share of the stage's time that it would add to the side in use.
void measure(const bench::Comparison& comparison, int rounds) {
  const std::size_t count = comparison.sides.size();
  std::vector<std::vector<double>> seconds(count);
  std::vector<std::size_t> checksums(count);
  for (int round = 0; round < rounds; ++round)
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t side = (i + static_cast<std::size_t>(round)) % count;
      const double start_s = processorSeconds();
      checksums[side] = comparison.sides[side].run();
      seconds[side].push_back(processorSeconds() - start_s);
    }
  const double used_s = medianOf(seconds[0]), whole_s = comparison.stage_s > 0 ? comparison.stage_s : used_s;
  for (std::size_t side = 0; side < count; ++side) {
    const double side_s = medianOf(seconds[side]);
    std::printf("| %s | %s | %.2f | %.2f | %s | %.0f %% | %s |\n", side == 0 ? comparison.what.c_str() : "",
                comparison.sides[side].name.c_str(), side_s * 1e3, side_s / used_s, comparison.stage.c_str(),
                100 * (side_s - used_s) / whole_s, checksums[side] == checksums[0] ? "yes" : "NO");
  }
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  int rounds = 21;
  for (int i = 1; i + 1 < argc; ++i)
    if (std::strcmp(argv[i], "--rounds") == 0) rounds = std::max(1, std::atoi(argv[++i]));
  const auto scans = bench::scansFor({});
  std::printf("%d alternating rounds, medians of processor time\n\n", rounds);
  std::printf("| what | side | ms | ratio | stage | of the stage | same values |\n");
  std::printf("|---|---|---:|---:|---|---:|---|\n");
  for (const bench::Comparison& comparison : bench::stageComparisons(scans)) measure(comparison, rounds);
  for (const bench::Comparison& comparison : bench::lookupComparisons()) measure(comparison, rounds);
  return 0;
}
