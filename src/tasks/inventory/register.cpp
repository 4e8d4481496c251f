// SPDX-License-Identifier: Apache-2.0
// Pairs entries of a register with things of the map.
#include "tasks/inventory/register.hpp"

#include <algorithm>
#include <tuple>

#include "tasks/gone_things.hpp"
#include "tasks/search/search_field.hpp"

namespace cluxel::tasks {

const char* nameOf(RegisterStatus status) {
  switch (status) {
    case RegisterStatus::Matched:
      return "matched";
    case RegisterStatus::MissingInMap:
      return "missing in the map";
    case RegisterStatus::NotObserved:
      return "not observed";
    case RegisterStatus::NotInRegister:
      return "not in the register";
  }
  return "";
}

std::vector<RegisterRow> compareWith(const std::vector<RegisterEntry>& entries, const std::vector<RegisterItem>& items,
                                     const std::vector<bool>& is_observed, const RegisterParams& params) {
  std::vector<std::tuple<bool, double, std::size_t, std::size_t>> pairs;  // first: the thing is of a subclass
  for (std::size_t e = 0; e < entries.size(); ++e)
    for (std::size_t i = 0; i < items.size(); ++i) {
      const InventoryItem& thing = items[i].thing;
      const double distance = (entries[e].at - thing.at).norm();
      if (distance > params.within_m || !items[i].classes.contains(entries[e].class_iri)) continue;
      pairs.emplace_back(entries[e].class_iri != thing.class_iri, distance, e, i);
    }
  std::sort(pairs.begin(), pairs.end());
  std::vector<RegisterRow> rows(entries.size());
  std::vector<bool> is_taken(items.size(), false), has_item(entries.size(), false);
  for (const auto& [is_of_subclass, distance, e, i] : pairs) {
    if (has_item[e] || is_taken[i]) continue;
    has_item[e] = is_taken[i] = true;
    rows[e] = {RegisterStatus::Matched, e, i, distance};
  }
  for (std::size_t e = 0; e < entries.size(); ++e)
    if (!has_item[e])
      rows[e] = {is_observed[e] ? RegisterStatus::MissingInMap : RegisterStatus::NotObserved, e, std::nullopt,
                 kNotMeasured};
  for (std::size_t i = 0; i < items.size(); ++i)
    if (!is_taken[i] && items[i].is_listed)
      rows.push_back({RegisterStatus::NotInRegister, std::nullopt, i, kNotMeasured});
  return rows;
}

std::vector<bool> observedPlaces(const mapping::MapReader& map, const std::vector<RegisterEntry>& entries,
                                 const RegisterParams& params) {
  const TerrainGrid terrain = terrainOf(map);
  SearchParams sight;
  sight.view_m = params.view_m;
  sight.fade = 1;
  const std::vector<float> known = knownShare(map, terrain, sightOf(map, terrain, goneAmong(map), sight.eye_m), sight);
  std::vector<bool> is_observed;
  for (const RegisterEntry& entry : entries) {
    const auto cell = terrain.frame.cellAt(entry.at);
    is_observed.push_back(cell && known[*cell] > 0);
  }
  return is_observed;
}

}  // namespace cluxel::tasks
