// SPDX-License-Identifier: Apache-2.0
// Where a further object of a class may be: a probability for each cell, from usual places and from what was seen.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tasks/ways/terrain_grid.hpp"

namespace cluxel::tasks {

/// A usual place of the class, as it is in the map.
struct PlaceEvidence {
  std::string near_class;  ///< local name
  double within_m = 0, probability = 0;
  std::vector<std::uint8_t> is_there;  ///< per cell, 1: an object of that class is there
};

struct SearchParams {
  double detection = 0.8;  ///< share of the objects of the class that the map knows where ground was seen
  double view_m = 10;      ///< how far an object is recognised from a stop
};

/// The number of a place in reasons, or this: anywhere.
inline constexpr std::uint8_t kAnywhere = 255;

struct SearchField {
  GridFrame frame;
  std::vector<double> probability;   ///< that a further object is there; the sum is 1
  std::vector<std::uint8_t> reason;  ///< the place that says most about the cell, or kAnywhere
};

/// The probability of each place is spread evenly over the cells within its distance of the things that are there, the
/// rest over all cells. Where ground was seen only what was overlooked can be. Throws Error (InvalidArgument) for
/// places whose probabilities sum to more than 1.
SearchField fieldOf(const GridFrame& frame, const std::vector<std::uint8_t>& seen,
                    const std::vector<PlaceEvidence>& places, const SearchParams& params);

}  // namespace cluxel::tasks
