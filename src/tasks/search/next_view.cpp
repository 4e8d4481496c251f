// SPDX-License-Identifier: Apache-2.0
// Makes the field of what is to be seen, and counts what each stop adds.
#include "tasks/search/next_view.hpp"

#include <algorithm>
#include <numeric>

#include "mapping/layers/stored_layers.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::tasks {

namespace {

/// By object, in the order of MapReader::objects().
std::vector<double> confidencesIn(const mapping::MapReader& map) {
  std::vector<double> confidences;
  mapping::forEachRecord(map.transaction(), [&](const ContentHash&, const mapping::ObjectRecord& record) {
    confidences.push_back(record.confidence);
  });
  return confidences;
}

/// Objects of low confidence. Surfaces are left out (nobody looks at them from a stop), and objects that are gone.
std::vector<bool> doubtfulAmong(const mapping::MapReader& map, const std::vector<double>& confidences, double below,
                                const std::vector<bool>& is_left_out) {
  const rdf::OntologyView ontology = ontologyViewOf(map.quads());
  std::vector<bool> is_doubtful;
  for (std::size_t i = 0; i < confidences.size(); ++i) {
    const bool is_surface = ontology.isA(map.objectClasses()[i], rdf::vocabulary::clx("Surface"));
    is_doubtful.push_back(confidences[i] < below && !is_surface && !is_left_out[i]);
  }
  return is_doubtful;
}

SearchField unobservedField(const TerrainGrid& terrain) {
  SearchField field{terrain.frame, {}, LargeArray<PlaceNumber>(terrain.frame.size(), kAnywhere)};
  for (const std::uint8_t seen : terrain.seen) field.probability.push_back(seen != 0 ? 0.0 : 1.0);
  return field;
}

SearchField doubtfulField(const std::vector<double>& confidences, const TerrainGrid& terrain,
                          const std::vector<bool>& is_doubtful) {
  std::vector<std::size_t> cells(confidences.size(), 0);
  for (const std::uint32_t thing : terrain.things)
    if (thing != kUnnamedThing) ++cells[thing];
  SearchField field{terrain.frame, LargeArray<double>(terrain.frame.size(), 0.0),
                    LargeArray<PlaceNumber>(terrain.frame.size(), kAnywhere)};
  for (std::uint32_t cell = 0; cell < terrain.frame.size(); ++cell)
    for (const std::uint32_t thing : terrain.thingsIn(cell))
      if (thing != kUnnamedThing && is_doubtful[thing])
        field.probability[cell] += (1 - confidences[thing]) / static_cast<double>(cells[thing]);
  return field;
}

void normalise(SearchField& field) {
  const double sum = std::accumulate(field.probability.begin(), field.probability.end(), 0.0);
  for (double& value : field.probability) value = sum > 0 ? value / sum : 0;
}

}  // namespace

NextViewAnswer nextViews(const mapping::MapReader& map, const NextViewRequest& request) {
  const Eigen::Vector2d from = request.from.empty() ? lastStop(map) : placeNamed(map, request.from);
  const TerrainGrid terrain = terrainIn(map, request.ways);
  const PassableGrid grid = passableIn(map, terrain, request.ways);
  SearchParams search;
  search.view_m = request.view_m;
  const std::vector<bool> is_left_out = leftOut(map, request.ways);
  const SightGrid sight = sightOf(map, terrain, is_left_out, search.eye_m);
  const std::vector<double> confidences = confidencesIn(map);
  std::vector<bool> is_doubtful = doubtfulAmong(map, confidences, request.below, is_left_out);
  NextViewAnswer answer;
  answer.frame = grid.frame;
  const double cell_m2 = grid.frame.cell_m * grid.frame.cell_m;
  answer.unobserved_m2 = static_cast<double>(std::count(terrain.seen.begin(), terrain.seen.end(), 0)) * cell_m2;
  answer.doubtful = static_cast<std::size_t>(std::count(is_doubtful.begin(), is_doubtful.end(), true));
  SearchField field = request.is_doubtful ? doubtfulField(confidences, terrain, is_doubtful) : unobservedField(terrain);
  normalise(field);
  std::vector<bool> is_seen(terrain.frame.size(), false);
  for (SearchStop& stop : tourOf(grid, sight, field, from, search, request.tour)) {
    NextView view{std::move(stop), 0, {}, {}};
    for (const std::uint32_t cell : view.stop.in_sight) {
      if (terrain.seen[cell] == 0 && !is_seen[cell]) view.area_m2 += cell_m2;
      is_seen[cell] = true;
      for (const std::uint32_t thing : terrain.thingsIn(cell))
        if (thing != kUnnamedThing && is_doubtful[thing]) {
          is_doubtful[thing] = false;
          view.objects.push_back(thing);
          view.confidences.push_back(confidences[thing]);
        }
    }
    answer.views.push_back(std::move(view));
  }
  return answer;
}

}  // namespace cluxel::tasks
