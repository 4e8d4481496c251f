// SPDX-License-Identifier: Apache-2.0
// A tour of stops from which a further object of a class is most likely seen for the least walk.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "tasks/search/search_field.hpp"
#include "tasks/ways/route.hpp"

namespace cluxel::tasks {

struct SearchStop {
  std::uint32_t cell = 0;
  double walk_m = 0;               ///< from the stop before, by the cheapest way
  double total_m = 0;              ///< from the start
  double probability = 0;          ///< that the object is first seen from here, or on the way here
  double so_far = 0;               ///< that it is seen from here or before
  PlaceNumber reason = kAnywhere;  ///< the place that most of the probability comes from
  std::vector<std::pair<PlaceNumber, double>> shares = {};  ///< of the probability, by place, largest first
  std::vector<std::uint32_t> way = {};                      ///< cells from the stop before, both included
  std::vector<std::uint32_t> in_sight =
      {};  ///< cells seen from here, or on the way here with `looks_on_way`; ascending
};

struct TourParams {
  double budget_m = 0;  ///< length of the whole walk; 0: no limit
  std::size_t max_stops = 10;
  double settle_m = 5;       ///< what a stop costs beside the walk
  bool looks_on_way = true;  ///< what is in sight of the way counts too
};

/// Greedy: the next stop is the one with most new probability in sight for each metre of walk and settling. Stops are
/// open cells of a lattice of half the view, and the start. With `looks_on_way` the 16 stops with most in sight are
/// compared by what is in sight on the way, too.
std::vector<SearchStop> tourOf(const PassableGrid& grid, const SightGrid& sight, const SearchField& field,
                               const Eigen::Vector2d& from, const SearchParams& search, const TourParams& params);

/// A search in a map.
struct SearchRequest {
  std::string class_name;             ///< what to look for: local name, clx:name or IRI
  std::string from;                   ///< as placeNamed(); empty: as lastStop()
  std::filesystem::path places = {};  ///< Turtle with usual places instead of the ontology's; empty: the ontology's
  WayRequest ways = {};
  SearchParams search = {};
  TourParams tour = {};
};

struct KnownObject {
  std::uint32_t object = 0;  ///< number in MapReader::objects()
  double distance_m = 0;     ///< straight from the start
};

struct SearchAnswer {
  GridFrame frame;
  std::vector<KnownObject> known;  ///< objects of the class that the map holds and that are there, nearest first
  std::vector<SearchStop> stops;
  std::vector<std::string> reasons;     ///< local names of near classes, by SearchStop::reason
  std::vector<rdf::UsualPlace> places;  ///< parallel to reasons
};

/// Where the sensor stood at last: where the last ray of the last scan starts. Throws Error (NotFound) when no scan
/// tells where its rays start, or several do and none has a time.
Eigen::Vector2d lastStop(const mapping::MapReader& map);
/// The usual places of a class in a Turtle file, as `search learn` writes it; those of the ontology without a file.
/// Throws Error (InvalidArgument) for a file that says nothing about the class.
std::vector<rdf::UsualPlace> usualPlacesOf(const rdf::OntologyView& ontology, const std::string& class_iri,
                                           const std::filesystem::path& file);
/// Throws Error (NotFound) for an unknown class or a start without open ground, and as requireClassOfObjects().
SearchAnswer searchFor(const mapping::MapReader& map, const SearchRequest& request);
std::string searchJson(const mapping::MapReader& map, const SearchAnswer& answer);

}  // namespace cluxel::tasks
