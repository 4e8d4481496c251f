// SPDX-License-Identifier: Apache-2.0
// Where a further object of a class may be: a probability for each cell, from usual places and from what was seen.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "rdf/ontology/ontology.hpp"
#include "tasks/search/sight_grid.hpp"

namespace cluxel::tasks {

/// A usual place of the class, as it is in the map.
struct PlaceEvidence {
  std::string near_class;  ///< local name
  double within_m = 0, probability = 0;
  LargeArray<std::uint8_t> is_there;  ///< per cell, 1: an object of that class is there
};

struct SearchParams {
  double detection = 0.8;  ///< share of the objects of the class that the map knows within view of a scan
  double view_m = 10;      ///< how far an object is recognised from a stop
  double fade = 3;         ///< beyond this many times view_m from all scans, the map knows nothing
  double eye_m = 1.2;      ///< height of the camera: higher obstacles hide what is behind them
};

/// The number of a usual place of the class.
using PlaceNumber = std::uint16_t;
/// No place: anywhere.
inline constexpr PlaceNumber kAnywhere = std::numeric_limits<PlaceNumber>::max();

struct SearchField {
  GridFrame frame;
  LargeArray<double> probability;  ///< that a further object is there; the sum is 1
  LargeArray<PlaceNumber> reason;  ///< the place that says most about the cell, or kAnywhere
};

/// The usual places as they are in the map.
std::vector<PlaceEvidence> evidenceOf(const mapping::MapReader& map, const TerrainGrid& terrain,
                                      const std::vector<rdf::UsualPlace>& places, const std::vector<bool>& is_left_out);

/// Per cell, the probability that the map knows an object of the class that is there: `detection` within view_m of a
/// place where rays of a scan start and which sees the cell, from there falling to 0 at fade times view_m. Scans that
/// do not tell where their rays start count where ground was measured. Cost: a field of view for each scan; where rays
/// of a scan start in several places, one for each square of a fifth of view_m (at least 1 m) in which some do.
LargeArray<float> knownShare(const mapping::MapReader& map, const TerrainGrid& terrain, const SightGrid& sight,
                             const SearchParams& params);

/// The probability of each place is spread evenly over the cells within its distance of the things that are there, the
/// rest over all cells; then a cell keeps the share that the map does not know. `known`: per cell, as knownShare().
/// Throws Error (InvalidArgument) for places whose probabilities sum to more than 1, and for more than kAnywhere
/// places.
SearchField fieldOf(const GridFrame& frame, const LargeArray<float>& known, const std::vector<PlaceEvidence>& places);

}  // namespace cluxel::tasks
