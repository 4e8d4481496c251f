// SPDX-License-Identifier: Apache-2.0
// A search in a map: usual places of the ontology, objects that are there, and the tour.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/ascii.hpp"
#include "cluxel/error.hpp"
#include "mapping/clouds/ray_starts.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rdf/vocabulary.hpp"
#include "sparql/query_engine.hpp"
#include "tasks/finite_number.hpp"
#include "tasks/gone_things.hpp"
#include "tasks/named_class.hpp"
#include "tasks/objects_of_class.hpp"
#include "tasks/query_source.hpp"
#include "tasks/search/search_tour.hpp"

namespace cluxel::tasks {

namespace {

std::vector<KnownObject> knownOf(const mapping::MapReader& map, const std::string& class_iri,
                                 const Eigen::Vector2d& from, const std::vector<bool>& is_gone) {
  std::vector<KnownObject> known;
  for (const std::uint32_t i : objectsOfClass(map, class_iri))
    if (!is_gone[i]) known.push_back({i, (placeNamed(map, map.objectIds()[i].hex()) - from).norm()});
  std::stable_sort(known.begin(), known.end(),
                   [](const auto& a, const auto& b) { return a.distance_m < b.distance_m; });
  return known;
}

double shown(double value) {
  return std::round(value * 1e4) / 1e4;
}

}  // namespace

Eigen::Vector2d lastStop(const mapping::MapReader& map) {
  std::vector<mapping::Cloud> clouds = map.clouds();
  std::erase_if(clouds, [](const mapping::Cloud& cloud) { return !cloud.has_ray_starts; });
  if (clouds.empty())
    throw Error(ErrorKind::NotFound, "no scan of the map tells where its sensor stood; name the start",
                Remedy::NameStart);
  const auto last = std::max_element(clouds.begin(), clouds.end(), [](const auto& a, const auto& b) {
    return std::pair(a.time_s, a.id) < std::pair(b.time_s, b.id);  // no time is earlier than any
  });
  if (clouds.size() > 1 && !last->time_s)
    throw Error(ErrorKind::NotFound, "the scans of the map have no times, so that none is the last; name the start",
                Remedy::NameStart);
  return mapping::rayStartsOf(map.transaction(), *last).front().head<2>();
}

namespace {

/// clx:Name for an IRI of the vocabulary, so that messages suggest names.
std::string shortClass(const std::string& iri) {
  return iri.starts_with(rdf::vocabulary::kClx) ? "clx:" + iri.substr(rdf::vocabulary::kClx.size()) : iri;
}

/// Reads a usual place from a row ?place ?near ?within ?share. Collects its faults.
rdf::UsualPlace placeInRow(const rdf::OntologyView& ontology, const sparql::ResultTable& table, std::size_t row,
                           const std::filesystem::path& file, std::vector<Diagnostic>& faults) {
  const auto addFault = [&](const std::string& what, const std::string& hint) {
    const std::string place = mapping::localName(table.at(row, 0)->text);
    faults.push_back({Severity::Error, {.file = file.string()}, "usual place " + place + ": " + what, hint, ""});
  };
  const auto number = [&](std::size_t column, const char* name, double most, const char* wanted) {
    const Term* term = table.at(row, column);
    const auto value = term == nullptr ? std::nullopt : finiteNumber(trimmed(term->text));
    if (value && *value > 0 && *value <= most) return *value;
    addFault(term == nullptr ? "it has no " + std::string(name) : std::string(name) + " is '" + term->text + "'",
             wanted);
    return 0.0;
  };
  rdf::UsualPlace place;
  try {
    if (const Term* near = table.at(row, 1)) place.near_class = classNamed(ontology, shortClass(near->text));
  } catch (const Error& error) {
    addFault(std::string("clx:nearClass: ") + error.what(), "write a class of the ontology");
  }
  if (table.at(row, 1) == nullptr) addFault("it has no clx:nearClass", "write a class of the ontology");
  place.within_m = number(2, "clx:within", std::numeric_limits<double>::max(), "write a distance above 0 [m]");
  place.probability = number(3, "clx:probability", 1, "write a probability above 0 and at most 1");
  return place;
}

/// Throws InputError for places of a class that are too many or too probable.
void checkTogether(const std::vector<rdf::UsualPlace>& places, const std::string& class_name,
                   const std::filesystem::path& file) {
  constexpr double rounding = 1e-9;
  double sum = 0;
  for (const rdf::UsualPlace& place : places) sum += place.probability;
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", sum);
  if (sum > 1 + rounding)
    throw InputError({.file = file.string()},
                     "the probabilities of the usual places of " + class_name + " sum to " + text.data(),
                     "correct the file: they sum to at most 1");
  if (places.size() > kAnywhere)
    throw InputError({.file = file.string()},
                     "it has " + std::to_string(places.size()) + " usual places of " + class_name,
                     "write at most " + std::to_string(kAnywhere));
}

}  // namespace

std::vector<rdf::UsualPlace> usualPlacesOf(const rdf::OntologyView& ontology, const std::string& class_iri,
                                           const std::filesystem::path& file) {
  if (file.empty()) return ontology.find(class_iri)->places;
  const QuerySource source = openQuerySource(file);
  const std::string query = "PREFIX clx: <" + std::string(rdf::vocabulary::kClx) +
                            "> SELECT ?place ?near ?within ?share { ?place clx:usualFor <" + class_iri +
                            "> OPTIONAL { ?place clx:nearClass ?near } OPTIONAL { ?place clx:within ?within } "
                            "OPTIONAL { ?place clx:probability ?share } } ORDER BY DESC(?share) ?near ?within ?place";
  const sparql::ResultTable table = sparql::evaluateQuery(source.reader(), query).table;
  std::vector<rdf::UsualPlace> places;
  std::vector<Diagnostic> faults;
  for (std::size_t row = 0; row < table.row_count; ++row)
    places.push_back(placeInRow(ontology, table, row, file, faults));
  if (!faults.empty()) throw InputError(std::move(faults));
  if (places.empty())
    throw Error(ErrorKind::InvalidArgument, file.string() + ": no usual place of " + mapping::localName(class_iri) +
                                                " is in it; learn from maps that hold such objects");
  checkTogether(places, mapping::localName(class_iri), file);
  return places;
}

SearchAnswer searchFor(const mapping::MapReader& map, const SearchRequest& request) {
  const rdf::OntologyView ontology = ontologyViewOf(map.quads());
  const std::string class_iri = classNamed(map, ontology, request.class_name);
  requireClassOfObjects(map, ontology, class_iri);
  const Eigen::Vector2d from = request.from.empty() ? lastStop(map) : placeNamed(map, request.from);
  const TerrainGrid terrain = terrainIn(map, request.ways);
  const PassableGrid grid = passableIn(map, terrain, request.ways);
  const std::vector<bool> is_left_out = leftOut(map, request.ways);
  const std::vector<bool> is_gone = request.ways.with_gone ? std::vector<bool>(map.objectIds().size()) : goneAmong(map);
  SearchAnswer answer;
  answer.frame = grid.frame;
  answer.known = knownOf(map, class_iri, from, is_gone);
  answer.places = usualPlacesOf(ontology, class_iri, request.places);
  const std::vector<PlaceEvidence> places = evidenceOf(map, terrain, answer.places, is_left_out);
  for (const PlaceEvidence& place : places) answer.reasons.push_back(place.near_class);
  const SightGrid sight = sightOf(map, terrain, is_left_out, request.search.eye_m);
  const SearchField field = fieldOf(grid.frame, knownShare(map, terrain, sight, request.search), places);
  answer.stops = tourOf(grid, sight, field, from, request.search, request.tour);
  return answer;
}

std::string searchJson(const mapping::MapReader& map, const SearchAnswer& answer) {
  nlohmann::ordered_json json{{"known", nlohmann::ordered_json::array()}, {"stops", nlohmann::ordered_json::array()}};
  for (const KnownObject& known : answer.known)
    json["known"].push_back(
        {{"object", rdf::iriOfObject(map.objectIds()[known.object])}, {"distance", shown(known.distance_m)}});
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
