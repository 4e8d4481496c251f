// SPDX-License-Identifier: Apache-2.0
// Where to stand next: places from which most unobserved ground, or most doubtful objects, are in sight.
#pragma once

#include "tasks/search/search_tour.hpp"

namespace cluxel::tasks {

struct NextViewRequest {
  std::string from;          ///< as placeNamed(); empty: the position of the last scan
  bool is_doubtful = false;  ///< look at doubtful objects instead of unobserved ground
  double below = 0.7;        ///< an object of less confidence is doubtful
  double view_m = 15;
  WayRequest ways = {};
  TourParams tour = {};
};

struct NextView {
  SearchStop stop;
  double area_m2 = 0;                  ///< of unobserved ground that comes into sight
  std::vector<std::uint32_t> objects;  ///< doubtful ones that come into sight, numbers in MapReader::objects()
  std::vector<double> confidences;     ///< parallel to `objects`
};

struct NextViewAnswer {
  GridFrame frame;
  double unobserved_m2 = 0;     ///< of all cells
  std::size_t doubtful = 0;     ///< objects in all
  std::vector<NextView> views;  ///< in the order of the walk
};

/// The greedy tour over a field that is even over the unobserved cells, or over the cells of doubtful objects (as 1
/// minus their confidence). A cell or object counts where it is first in sight. Throws as searchFor().
NextViewAnswer nextViews(const mapping::MapReader& map, const NextViewRequest& request);

}  // namespace cluxel::tasks
