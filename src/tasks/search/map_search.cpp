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
#include "tasks/query_source.hpp"
#include "tasks/search/search_tour.hpp"

namespace cluxel::tasks {

namespace {

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

Eigen::Vector2d lastStop(const mapping::MapReader& map) {
  const std::vector<mapping::Cloud> clouds = map.clouds();
  if (clouds.empty()) throw Error(ErrorKind::NotFound, "the map holds no scans; name the start of the search");
  const auto last = std::max_element(clouds.begin(), clouds.end(), [](const auto& a, const auto& b) {
    return std::pair(a.time_s.value_or(-1e300), a.source) < std::pair(b.time_s.value_or(-1e300), b.source);
  });
  return last->T_map_sensor.translation().head<2>();
}

std::vector<rdf::UsualPlace> usualPlacesOf(const rdf::OntologyView& ontology, const std::string& class_iri,
                                           const std::filesystem::path& file) {
  if (file.empty()) return ontology.find(class_iri)->places;
  const QuerySource source = openQuerySource(file);
  const std::string query = "PREFIX clx: <" + std::string(rdf::vocabulary::kClx) +
                            "> SELECT ?near ?within ?share { ?place clx:usualFor <" + class_iri +
                            "> ; clx:nearClass ?near ; clx:within ?within ; clx:probability ?share } "
                            "ORDER BY DESC(?share) ?near ?within";
  const sparql::ResultTable table = sparql::evaluateQuery(source.reader(), query).table;
  std::vector<rdf::UsualPlace> places;
  for (std::size_t row = 0; row < table.row_count; ++row)
    places.push_back({classNamed(ontology, table.at(row, 0)->text),
                      std::strtod(table.at(row, 1)->text.c_str(), nullptr),
                      std::strtod(table.at(row, 2)->text.c_str(), nullptr)});
  if (places.empty())
    throw Error(ErrorKind::InvalidArgument, file.string() + ": no usual place of " + mapping::localName(class_iri) +
                                                " is in it; learn from maps that hold such objects");
  return places;
}

SearchAnswer searchFor(const mapping::MapReader& map, const SearchRequest& request) {
  const rdf::OntologyView ontology = ontologyViewOf(map.quads());
  const std::string class_iri = classNamed(ontology, request.class_name);
  const Eigen::Vector2d from = request.from.empty() ? lastStop(map) : placeNamed(map, request.from);
  const TerrainGrid terrain = terrainOf(map, request.ways.terrain);
  const PassableGrid grid = passableIn(map, terrain, request.ways);
  SearchAnswer answer;
  answer.frame = grid.frame;
  answer.known = knownOf(map, ontology, class_iri, from);
  answer.places = usualPlacesOf(ontology, class_iri, request.places);
  const std::vector<PlaceEvidence> places = evidenceOf(map, terrain, ontology, answer.places);
  for (const PlaceEvidence& place : places) answer.reasons.push_back(place.near_class);
  const SightGrid sight = sightOf(map, terrain, request.search.eye_m);
  const SearchField field = fieldOf(grid.frame, knownShare(map, terrain, sight, request.search), places);
  answer.stops = tourOf(grid, sight, field, from, request.search, request.tour);
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
