// SPDX-License-Identifier: Apache-2.0
// Inventories as values: sizes that were not measured are absent.
#include <cmath>

#include "api/task_values.hpp"
#include "api/way_values.hpp"
#include "tasks/ask/inventory_task.hpp"

namespace cluxel {

namespace {

std::optional<double> measured(double value) {
  return std::isnan(value) ? std::nullopt : std::optional(value);
}

InventoryItem valueOf(const tasks::InventoryItem& found) {
  InventoryItem item;
  item.kind = found.kind;
  item.class_iri = found.class_iri;
  item.object = found.object;
  item.street = found.street;
  item.at = groundPositionOf(found.at);
  item.height_m = measured(found.height_m);
  item.crown_m = measured(found.crown_m);
  item.width_m = measured(found.width_m);
  item.length_m = measured(found.length_m);
  if (isRow(found)) item.vehicle_count = found.count;
  item.line = lineOf(found.line);
  return item;
}

class NotesOfStreets : public ProgressSink {
 public:
  explicit NotesOfStreets(std::vector<std::string>& notes) : notes_(notes) {}
  void note(std::string_view message) override { notes_.emplace_back(message); }

 private:
  std::vector<std::string>& notes_;
};

}  // namespace

Inventory inventoryIn(const mapping::MapReader& map, const InventoryOptions& options) {
  const tasks::InventoryParams params = tasks::inventoryOfKinds(map, options.kinds);
  Inventory inventory;
  NotesOfStreets notes(inventory.notes);
  std::vector<tasks::Street> streets;
  if (!options.streets.empty()) streets = tasks::readStreets(options.streets, map.inputs(), notes);
  const tasks::Inventory found = tasks::inventoryOf(map, params, streets);
  for (const tasks::InventoryItem& item : found.items) inventory.items.push_back(valueOf(item));
  for (std::string& note : tasks::notesOf(map, params, found)) inventory.notes.push_back(std::move(note));
  return inventory;
}

}  // namespace cluxel
