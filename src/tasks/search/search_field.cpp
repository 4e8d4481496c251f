// SPDX-License-Identifier: Apache-2.0
// Spreads probabilities over cells.
#include "tasks/search/search_field.hpp"

#include <algorithm>

#include "cluxel/error.hpp"
#include "tasks/ways/passable_grid.hpp"

namespace cluxel::tasks {

namespace {

/// The cells within the place's distance; empty when nothing of the class is in the map.
std::vector<std::uint32_t> cellsOf(const GridFrame& frame, const PlaceEvidence& place) {
  const NearestMarked nearest = nearestMarked(frame, place.is_there);
  std::vector<std::uint32_t> cells;
  for (std::uint32_t cell = 0; cell < frame.size(); ++cell)
    if (nearest.distance[cell] * frame.cell_m <= place.within_m) cells.push_back(cell);
  return cells;
}

}  // namespace

SearchField fieldOf(const GridFrame& frame, const std::vector<std::uint8_t>& seen,
                    const std::vector<PlaceEvidence>& places, const SearchParams& params) {
  constexpr double rounding = 1e-9;
  SearchField field{frame, std::vector<double>(frame.size(), 0.0), std::vector<std::uint8_t>(frame.size(), kAnywhere)};
  std::vector<double> largest_share(frame.size(), 0.0);
  double anywhere = 1;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::vector<std::uint32_t> cells = cellsOf(frame, places[i]);
    if (cells.empty()) continue;  // its probability stays with the places that are not named
    const double share = places[i].probability / static_cast<double>(cells.size());
    anywhere -= places[i].probability;
    for (const std::uint32_t cell : cells) {
      field.probability[cell] += share;
      if (share <= largest_share[cell]) continue;
      largest_share[cell] = share;
      field.reason[cell] = static_cast<std::uint8_t>(i);
    }
  }
  if (anywhere < -rounding)
    throw Error(ErrorKind::InvalidArgument,
                "the usual places of the class have probabilities that sum to more than 1; correct the ontology");
  const double rest = std::max(0.0, anywhere) / static_cast<double>(frame.size());
  double sum = 0;
  for (std::uint32_t cell = 0; cell < frame.size(); ++cell) {
    if (rest > largest_share[cell]) field.reason[cell] = kAnywhere;
    field.probability[cell] = (field.probability[cell] + rest) * (seen[cell] != 0 ? 1 - params.detection : 1.0);
    sum += field.probability[cell];
  }
  for (double& value : field.probability) value = sum > 0 ? value / sum : 0;
  return field;
}

}  // namespace cluxel::tasks
