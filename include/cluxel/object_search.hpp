// SPDX-License-Identifier: Apache-2.0
// A walk on which a further object of a class is likely seen soon.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cluxel/ground_ways.hpp"

namespace cluxel {

/// Numbers out of range are refused.
struct SearchOptions {
  GroundOptions ground = {};
  double width_m = 0.6;                 ///< free width that is needed, 0 to 20
  std::optional<Place> start = {};      ///< absent: where the last scan was taken
  std::filesystem::path places = {};    ///< Turtle with usual places of classes; empty: those of the ontology
  bool crosses_unobserved = false;      ///< the walk may cross ground that was not observed
  std::optional<double> budget_m = {};  ///< largest length of the walk, above 0, to 1e6; absent: no limit
  std::size_t max_stops = 10;           ///< 1 to 100
  double view_m = 10;                   ///< distance within which an object is recognised, 1 to 100
  double detection = 0.8;               ///< share of the objects of the class in view of a scan that the map holds
};

/// An object of the class that the map holds already.
struct KnownObject {
  std::string iri;
  double distance_m = 0;  ///< straight from the start
};

struct SearchStop {
  GroundPosition at;
  double walk_m = 0;       ///< from the stop before
  double total_m = 0;      ///< from the start
  double probability = 0;  ///< that the object is first seen from here, or on the way here
  double so_far = 0;       ///< that it is seen from here or before
  /// Local name of the class of the usual place that most of the probability comes from; empty: anywhere.
  std::string near_class;
  std::vector<GroundPosition> way;  ///< corners of the way from the stop before
};

struct SearchTour {
  std::vector<KnownObject> known;  ///< nearest first
  std::vector<SearchStop> stops;   ///< in the order of the walk; empty: nothing is in sight within the budget
};

}  // namespace cluxel
