// SPDX-License-Identifier: Apache-2.0
// A search in a map: usual places of the ontology, objects that are there, and the tour.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cluxel/error.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rdf/vocabulary.hpp"
#include "sparql/query_engine.hpp"
#include "tasks/search/search_tour.hpp"

namespace cluxel::tasks {

namespace {

double numberIn(const sparql::ResultTable& table, std::size_t row, std::size_t column) {
  const Term* term = table.at(row, column);
  return term == nullptr ? std::nan("") : std::strtod(term->text.c_str(), nullptr);
}

/// Cells where something of a class is: what stands in them, and the positions of what rules derive.
std::vector<std::uint8_t> cellsWith(const mapping::MapReader& map, const TerrainGrid& terrain,
                                    const rdf::OntologyView& ontology, const std::string& class_iri) {
  std::vector<std::uint8_t> marked(terrain.frame.size(), 0);
  for (std::uint32_t cell = 0; cell < terrain.frame.size(); ++cell)
    for (const std::uint32_t thing : terrain.thingsIn(cell))
      if (thing != kUnnamedThing && ontology.isA(map.objects()[thing].class_iri, class_iri)) marked[cell] = 1;
  const std::string query = "PREFIX clx: <" + std::string(rdf::vocabulary::kClx) + "> SELECT ?x ?y { ?o a <" +
                            class_iri + "> ; clx:x ?x ; clx:y ?y }";
  const sparql::ResultTable places = sparql::evaluateQuery(map.quads(), query).table;
  for (std::size_t row = 0; row < places.row_count; ++row)
    if (const auto cell = terrain.frame.cellAt({numberIn(places, row, 0), numberIn(places, row, 1)})) marked[*cell] = 1;
  return marked;
}

/// Where the sensor stood at last.
Eigen::Vector2d lastStop(const mapping::MapReader& map) {
  const std::vector<mapping::Cloud> clouds = map.clouds();
  if (clouds.empty()) throw Error(ErrorKind::NotFound, "the map holds no scans; name the start of the search");
  const auto last = std::max_element(clouds.begin(), clouds.end(), [](const auto& a, const auto& b) {
    return std::pair(a.time_s.value_or(-1e300), a.source) < std::pair(b.time_s.value_or(-1e300), b.source);
  });
  return last->T_map_sensor.translation().head<2>();
}

std::vector<KnownObject> knownOf(const mapping::MapReader& map, const rdf::OntologyView& ontology,
                                 const std::string& class_iri, const Eigen::Vector2d& from) {
  std::vector<KnownObject> known;
  for (std::uint32_t i = 0; i < map.objects().size(); ++i)
    if (ontology.isA(map.objects()[i].class_iri, class_iri))
      known.push_back({i, (placeNamed(map, map.objects()[i].id.hex()) - from).norm()});
  std::stable_sort(known.begin(), known.end(),
                   [](const auto& a, const auto& b) { return a.distance_m < b.distance_m; });
  return known;
}

double shown(double value) {
  return std::round(value * 1e4) / 1e4;
}

}  // namespace

SearchAnswer searchFor(const mapping::MapReader& map, const SearchRequest& request) {
  const rdf::OntologyView ontology = ontologyViewOf(map.quads());
  const std::string class_iri = classNamed(ontology, request.class_name);
  const Eigen::Vector2d from = request.from.empty() ? lastStop(map) : placeNamed(map, request.from);
  const TerrainGrid terrain = terrainOf(map, request.ways.terrain);
  const PassableGrid grid = passableIn(map, request.ways);
  SearchAnswer answer;
  answer.frame = grid.frame;
  answer.known = knownOf(map, ontology, class_iri, from);
  std::vector<PlaceEvidence> places;
  for (const rdf::UsualPlace& place : ontology.find(class_iri)->places) {
    const std::string name = mapping::localName(place.near_class);
    places.push_back({name, place.within_m, place.probability, cellsWith(map, terrain, ontology, place.near_class)});
    answer.reasons.push_back(name);
  }
  const SearchField field = fieldOf(grid.frame, terrain.seen, places, request.search);
  answer.stops = tourOf(grid, field, from, request.search, request.tour);
  return answer;
}

std::string searchJson(const mapping::MapReader& map, const SearchAnswer& answer) {
  nlohmann::ordered_json json{{"known", nlohmann::ordered_json::array()}, {"stops", nlohmann::ordered_json::array()}};
  for (const KnownObject& known : answer.known)
    json["known"].push_back(
        {{"object", rdf::iriOfObject(map.objects()[known.object].id)}, {"distance", shown(known.distance_m)}});
  for (const SearchStop& stop : answer.stops) {
    const Eigen::Vector2d place = answer.frame.centreOf(stop.cell);
    json["stops"].push_back({{"at", {place.x(), place.y()}},
                             {"walk", shown(stop.walk_m)},
                             {"total", shown(stop.total_m)},
                             {"probability", shown(stop.probability)},
                             {"soFar", shown(stop.so_far)},
                             {"near", stop.reason == kAnywhere ? nlohmann::ordered_json(nullptr)
                                                               : nlohmann::ordered_json(answer.reasons[stop.reason])}});
  }
  return json.dump(2);
}

}  // namespace cluxel::tasks
