// SPDX-License-Identifier: Apache-2.0
// Pairs entries of a register with things of the map.
#include "tasks/inventory/register.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <tuple>

#include "base/quantile.hpp"
#include "tasks/inventory/observed_places.hpp"

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
                                     const RegisterParams& params) {
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
    if (!has_item[e]) rows[e] = {RegisterStatus::NotObserved, e, std::nullopt, kNotMeasured};
  for (std::size_t i = 0; i < items.size(); ++i)
    if (!is_taken[i] && items[i].is_listed)
      rows.push_back({RegisterStatus::NotInRegister, std::nullopt, i, kNotMeasured});
  return rows;
}

std::vector<double> heightsOf(const std::vector<RegisterEntry>& entries, const std::vector<RegisterItem>& items) {
  constexpr double kLeast_m = 1;  // nearly all that towns list is higher, and few things hide more
  std::map<std::string, double> of_class;
  std::vector<double> heights;
  for (const RegisterEntry& entry : entries) {
    const auto [known, is_new] = of_class.try_emplace(entry.class_iri, kLeast_m);
    std::vector<double> measured;
    for (std::size_t i = 0; is_new && i < items.size(); ++i)
      if (items[i].classes.contains(entry.class_iri) && std::isfinite(items[i].thing.height_m))
        measured.push_back(items[i].thing.height_m);
    std::sort(measured.begin(), measured.end());
    if (!measured.empty()) known->second = quantileOf(measured, 0.5);
    heights.push_back(entry.height_m.value_or(known->second));
  }
  return heights;
}

void tellMissing(const mapping::MapReader& map, const std::vector<RegisterEntry>& entries,
                 const std::vector<RegisterItem>& items, const RegisterParams& params, std::vector<RegisterRow>& rows) {
  const std::vector<double> heights = heightsOf(entries, items);
  std::vector<RegisterRow*> asked;
  std::vector<AskedPlace> places;
  for (RegisterRow& row : rows) {
    if (row.status != RegisterStatus::NotObserved) continue;
    asked.push_back(&row);
    places.push_back({entries[*row.entry].at, heights[*row.entry]});
  }
  const std::vector<bool> is_observed = observedPlaces(map, places, params.view_m);
  for (std::size_t i = 0; i < asked.size(); ++i)
    if (is_observed[i]) asked[i]->status = RegisterStatus::MissingInMap;
}

}  // namespace cluxel::tasks
