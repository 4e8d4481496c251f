// SPDX-License-Identifier: Apache-2.0
// Spreads probabilities over cells.
#include "tasks/search/search_field.hpp"

#include <algorithm>
#include <cmath>

#include "cluxel/error.hpp"
#include "mapping/clouds/ray_starts.hpp"
#include "tasks/ways/class_cells.hpp"
#include "tasks/ways/passable_grid.hpp"

namespace cluxel::tasks {

namespace {

/// The cells within the place's distance; empty when nothing of the class is in the map.
LargeArray<std::uint32_t> cellsOf(const GridFrame& frame, const PlaceEvidence& place) {
  const NearestMarked nearest = nearestMarked(frame, place.is_there);
  LargeArray<std::uint32_t> cells;
  for (std::uint32_t cell = 0; cell < frame.size(); ++cell)
    if (nearest.distance[cell] * frame.cell_m <= place.within_m) cells.push_back(cell);
  return cells;
}

/// From anywhere in a square of this side much the same is seen, so that one view of it is enough.
double alike_m(const SearchParams& params) {
  constexpr double kLeast_m = 1, kShareOfView = 0.2;
  return std::max(kLeast_m, kShareOfView * params.view_m);
}

/// What a scan knows that was measured from a place.
void addView(const SightGrid& sight, const Eigen::Vector2d& stop, const SearchParams& params,
             LargeArray<float>& known) {
  const double far_m = params.view_m * std::max(1.0, params.fade);
  for (const std::uint32_t cell : visibleFrom(sight, stop, far_m)) {
    const double distance_m = (sight.frame.centreOf(cell) - stop).norm();
    const double share = std::clamp((far_m - distance_m) / std::max(1e-9, far_m - params.view_m), 0.0, 1.0);
    const double here = params.detection * (distance_m <= params.view_m ? 1.0 : share);
    known[cell] = std::max(known[cell], static_cast<float>(here));
  }
}

}  // namespace

std::vector<PlaceEvidence> evidenceOf(const mapping::MapReader& map, const TerrainGrid& terrain,
                                      const std::vector<rdf::UsualPlace>& places,
                                      const std::vector<bool>& is_left_out) {
  std::vector<PlaceEvidence> evidence;
  for (const rdf::UsualPlace& place : places)
    evidence.push_back({mapping::localName(place.near_class), place.within_m, place.probability,
                        cellsWith(map, terrain, place.near_class, is_left_out)});
  return evidence;
}

LargeArray<float> knownShare(const mapping::MapReader& map, const TerrainGrid& terrain, const SightGrid& sight,
                             const SearchParams& params) {
  const GridFrame& frame = sight.frame;
  LargeArray<float> known(frame.size(), 0.0F);
  for (const mapping::Cloud& cloud : map.clouds()) {
    const std::vector<Eigen::Vector3d> starts = mapping::rayStartsOf(map.transaction(), cloud, alike_m(params));
    for (std::uint32_t cell = 0; starts.empty() && cell < frame.size(); ++cell)
      if (terrain.seen[cell] != 0) known[cell] = std::max(known[cell], static_cast<float>(params.detection));
    for (const Eigen::Vector3d& start : starts) addView(sight, start.head<2>(), params, known);
  }
  return known;
}

SearchField fieldOf(const GridFrame& frame, const LargeArray<float>& known, const std::vector<PlaceEvidence>& places) {
  constexpr double rounding = 1e-9;
  if (places.size() > kAnywhere)
    throw Error(ErrorKind::InvalidArgument, "the class has " + std::to_string(places.size()) +
                                                " usual places; write at most " + std::to_string(kAnywhere));
  SearchField field{frame, LargeArray<double>(frame.size(), 0.0), LargeArray<PlaceNumber>(frame.size(), kAnywhere)};
  LargeArray<double> largest_share(frame.size(), 0.0);
  double anywhere = 1;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const LargeArray<std::uint32_t> cells = cellsOf(frame, places[i]);
    if (cells.empty()) continue;  // its probability stays with the places that are not named
    const double share = places[i].probability / static_cast<double>(cells.size());
    anywhere -= places[i].probability;
    for (const std::uint32_t cell : cells) {
      field.probability[cell] += share;
      if (share <= largest_share[cell]) continue;
      largest_share[cell] = share;
      field.reason[cell] = static_cast<PlaceNumber>(i);
    }
  }
  if (anywhere < -rounding)
    throw Error(ErrorKind::InvalidArgument,
                "the usual places of the class in the ontology have probabilities that sum to more than 1; "
                "correct the ontology");
  const double rest = std::max(0.0, anywhere) / static_cast<double>(frame.size());
  double sum = 0;
  for (std::uint32_t cell = 0; cell < frame.size(); ++cell) {
    if (rest > largest_share[cell]) field.reason[cell] = kAnywhere;
    field.probability[cell] = (field.probability[cell] + rest) * (1 - static_cast<double>(known[cell]));
    sum += field.probability[cell];
  }
  for (double& value : field.probability) value = sum > 0 ? value / sum : 0;
  return field;
}

}  // namespace cluxel::tasks
