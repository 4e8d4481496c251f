// SPDX-License-Identifier: Apache-2.0
// Answers of tasks as values of the facade.
#pragma once

#include <string>

#include "cluxel/ground_ways.hpp"
#include "cluxel/inventory_item.hpp"
#include "cluxel/object_search.hpp"
#include "cluxel/visit_changes.hpp"
#include "mapping/map_reader.hpp"

namespace cluxel {

/// These throw as the functions of Map.
Inventory inventoryIn(const mapping::MapReader& map, const InventoryOptions& options);
Routes routesIn(const mapping::MapReader& map, const Place& start, const Place& goal, const RouteOptions& options);
CostMap costMapIn(const mapping::MapReader& map, const GroundOptions& options);
SearchTour searchIn(const mapping::MapReader& map, const std::string& class_name, const SearchOptions& options);
SiteChanges changesIn(const mapping::MapReader& map, const VisitOptions& options);

}  // namespace cluxel
