// SPDX-License-Identifier: Apache-2.0
// Length of the walk until 80 % of the objects of a class are found, on generated campuses whose map holds 30 % of the
// scans: search_bench [CLASS] [CAMPUSES] [judge|choose] [PLACES.ttl]. Without PLACES, usual places are learned on the
// campuses for choosing. Exit code 1 when the search with these places walks farther than the best sweep.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <numeric>

#include "rdf/vocabulary.hpp"
#include "search_walks.hpp"
#include "tasks/search/place_learning.hpp"
#include "tasks/search/search_tour.hpp"

namespace {

using namespace cluxel;
using namespace cluxel::bench;
namespace fs = std::filesystem;

// Seeds that nothing was chosen on, and others for choosing. Models learned from 11 to 16, tests use others below 100.
constexpr std::uint64_t kFirstJudged = 20'001, kFirstChoosing = 10'001;
constexpr std::size_t kChoosing = 10;

struct Line {
  std::uint64_t seed = 0;
  std::size_t targets = 0;
  std::vector<double> length_m;
};

const std::vector<std::string> kWalks{
    "search, learned", "search, ontology", "nearest unseen", "nearest unseen, known last", "lanes", "one who knows"};
constexpr std::size_t kFirstSweep = 2, kSweeps = 3;

fs::path learnedPlaces(const WorldParams& params, const fs::path& folder) {
  tasks::PlaceLearner learner;
  for (std::size_t i = 0; i < kChoosing; ++i) {
    simulation::CampusParams campus_params;
    campus_params.seed = kFirstChoosing + i;
    campus_params.size_m = params.size_m;
    campus_params.stops = static_cast<double>(simulation::maxStops(params.size_m));
    campus_params.points_per_stop = params.points_per_stop;
    const simulation::Campus campus = buildCampus(campus_params);
    const simulation::Laser laser(campus);
    const fs::path map = buildCampusMap(campus, laser, 1.0, folder, CLUXEL_SOURCE_DIR);
    learner.add(mapping::MapReader(map));
    fs::remove(map);
  }
  const fs::path file = folder / "places.ttl";
  std::ofstream(file) << placesTurtle(learner.learn(), learner.maps());
  return file;
}

Line measure(const WorldParams& params, const fs::path& places, const fs::path& folder) {
  const SearchWorld world(params, folder, CLUXEL_SOURCE_DIR);
  Line line{params.seed, world.targets().size(), {}};
  if (world.targets().empty()) return line;
  const rdf::OntologyView ontology = ontologyViewOf(world.map().quads());
  const std::string iri = rdf::vocabulary::clx(params.class_name);
  line.length_m = {searchLength(world, tasks::usualPlacesOf(ontology, iri, places)),
                   searchLength(world, ontology.find(iri)->places),
                   frontierLength(world, false),
                   frontierLength(world, true),
                   lanesLength(world),
                   knowingLength(world)};
  return line;
}

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

std::vector<double> columnOf(const std::vector<Line>& lines, std::size_t walk) {
  std::vector<double> column;
  for (const Line& line : lines) column.push_back(line.length_m[walk]);
  return column;
}

double meanOf(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Returns the walk that is the peer.
std::size_t report(const std::vector<Line>& lines, const std::string& class_name) {
  std::size_t peer = kFirstSweep;
  for (std::size_t walk = kFirstSweep; walk < kFirstSweep + kSweeps; ++walk)
    if (meanOf(columnOf(lines, walk)) < meanOf(columnOf(lines, peer))) peer = walk;
  std::printf("\n%zu campuses (generated), class %s; metres until 80 %% are found; peer: %s\n", lines.size(),
              class_name.c_str(), kWalks[peer].c_str());
  std::printf("%-27s %8s %8s %8s %8s   %s\n", "walk", "mean", "lower q", "median", "upper q", "less than the peer");
  for (std::size_t walk = 0; walk < kWalks.size(); ++walk) {
    const std::vector<double> column = columnOf(lines, walk);
    std::vector<double> saved;
    for (const Line& line : lines) saved.push_back(1 - line.length_m[walk] / line.length_m[peer]);
    std::printf("%-27s %8.1f %8.1f %8.1f %8.1f   %.1f %% of the sum; by campus %.1f %% (%.1f to %.1f)\n",
                kWalks[walk].c_str(), meanOf(column), quantile(column, 0.25), quantile(column, 0.5),
                quantile(column, 0.75), (1 - meanOf(column) / meanOf(columnOf(lines, peer))) * 100,
                quantile(saved, 0.5) * 100, quantile(saved, 0.25) * 100, quantile(saved, 0.75) * 100);
  }
  return peer;
}

}  // namespace

int main(int argc, char** argv) {
  WorldParams params;
  if (argc > 1) params.class_name = argv[1];
  const std::size_t campuses = argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 50;
  const bool is_choosing = argc > 3 && std::string(argv[3]) == "choose";
  const fs::path folder = fs::temp_directory_path() / ("search_bench_" + std::to_string(getpid()));
  fs::create_directories(folder);
  const fs::path places = argc > 4 ? fs::path(argv[4]) : learnedPlaces(params, folder);
  std::vector<Line> lines;
  for (std::size_t i = 0; i < campuses; ++i) {
    params.seed = (is_choosing ? kFirstChoosing : kFirstJudged) + i;
    Line line = measure(params, places, folder);
    std::printf("seed %llu: %zu targets", static_cast<unsigned long long>(line.seed), line.targets);
    for (const double length : line.length_m) std::printf("  %.0f", length);
    std::printf("\n");
    std::fflush(stdout);
    fs::remove(folder / ("campus" + std::to_string(params.seed) + ".clx"));
    if (!line.length_m.empty()) lines.push_back(std::move(line));
  }
  fs::remove_all(folder);
  if (lines.empty()) return 1;
  const std::size_t peer = report(lines, params.class_name);
  return meanOf(columnOf(lines, 0)) < meanOf(columnOf(lines, peer)) ? 0 : 1;
}
