// SPDX-License-Identifier: Apache-2.0
// The tasks of a map: each reads one commit with a reader of its own.
#include "api/map_impl.hpp"
#include "api/task_values.hpp"

namespace cluxel {

Inventory Map::inventory(const InventoryOptions& options) const {
  return impl_->readingAlone([&](const mapping::MapReader& map) { return inventoryIn(map, options); });
}

Routes Map::routes(const Place& start, const Place& goal, const RouteOptions& options) const {
  return impl_->readingAlone([&](const mapping::MapReader& map) { return routesIn(map, start, goal, options); });
}

CostMap Map::costMap(const GroundOptions& options) const {
  return impl_->readingAlone([&](const mapping::MapReader& map) { return costMapIn(map, options); });
}

SearchTour Map::search(std::string_view class_name, const SearchOptions& options) const {
  return impl_->readingAlone(
      [&](const mapping::MapReader& map) { return searchIn(map, std::string(class_name), options); });
}

SiteChanges Map::changes(const VisitOptions& options) const {
  return impl_->readingAlone([&](const mapping::MapReader& map) { return changesIn(map, options); });
}

}  // namespace cluxel
