// SPDX-License-Identifier: Apache-2.0
// A tour of stops from which a further object of a class is most likely seen for the least walk.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "tasks/search/search_field.hpp"
#include "tasks/ways/route.hpp"

namespace cluxel::tasks {

struct SearchStop {
  std::uint32_t cell = 0;
  double walk_m = 0;                ///< from the stop before, by the cheapest way
  double total_m = 0;               ///< from the start
  double probability = 0;           ///< that the object is first seen from here
  double so_far = 0;                ///< that it is seen from here or before
  std::uint8_t reason = kAnywhere;  ///< the place that most of the probability comes from
};

struct TourParams {
  double budget_m = 0;  ///< length of the whole walk; 0: no limit
  std::size_t max_stops = 10;
  double min_probability = 0.002;  ///< a stop with less ends the tour
  double settle_m = 5;             ///< what a stop costs beside the walk
};

/// Greedy: the next stop is the one with most new probability within view for each metre of walk and settling. Stops
/// are open cells of a lattice of half the view, and the start. What stands between a stop and a cell is not regarded.
std::vector<SearchStop> tourOf(const PassableGrid& grid, const SearchField& field, const Eigen::Vector2d& from,
                               const SearchParams& search, const TourParams& params);

/// A search in a map.
struct SearchRequest {
  std::string class_name;  ///< what to look for: local name, clx:name or IRI
  std::string from;        ///< as placeNamed(); empty: the position of the last scan
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
  std::vector<KnownObject> known;  ///< objects of the class that the map holds, nearest first
  std::vector<SearchStop> stops;
  std::vector<std::string> reasons;  ///< local names of near classes, by SearchStop::reason
};

/// Throws Error (NotFound) for an unknown class or a start without open ground.
SearchAnswer searchFor(const mapping::MapReader& map, const SearchRequest& request);
std::string searchJson(const mapping::MapReader& map, const SearchAnswer& answer);

}  // namespace cluxel::tasks
