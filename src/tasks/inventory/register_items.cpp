// SPDX-License-Identifier: Apache-2.0
// Collects the things of a map that a register is compared with.
#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "mapping/map_reader.hpp"
#include "mapping/thing_history.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/vocabulary.hpp"
#include "sparql/query_engine.hpp"
#include "tasks/gone_things.hpp"
#include "tasks/inventory/register.hpp"

namespace cluxel::tasks {

namespace {

/// Things without doubles. A row has no IRI; its place stands for it.
class RegisterThings {
 public:
  RegisterItem& add(InventoryItem thing) {
    const auto [place, is_new] = numbers_.try_emplace(
        thing.object.empty() ? std::tuple(thing.kind, thing.at.x(), thing.at.y()) : keyOf(thing.object), items_.size());
    if (is_new) items_.push_back({.thing = std::move(thing)});
    return items_[place->second];
  }
  std::vector<RegisterItem> take() { return std::move(items_); }

 private:
  using Key = std::tuple<std::string, double, double>;
  static Key keyOf(const std::string& iri) { return {iri, 0, 0}; }

  std::vector<RegisterItem> items_;
  std::map<Key, std::size_t> numbers_;
};

/// What the map says is of a class, with its place; a place of derived things that has none is where its members are.
/// Without objects and parking rows: those are in the inventory.
std::vector<InventoryItem> thingsTyped(const mapping::MapReader& map, const std::string& class_iri) {
  const std::string query = "PREFIX clx: <" + std::string(rdf::vocabulary::kClx) +
                            "> SELECT ?thing (AVG(?px) AS ?x) (AVG(?py) AS ?y) { ?thing a <" + class_iri +
                            "> FILTER NOT EXISTS { ?thing a clx:ParkingRow } FILTER NOT EXISTS { GRAPH <" +
                            std::string(rdf::vocabulary::kGraphObserved) +
                            "> { ?thing clx:confidence ?sure } } "
                            "{ ?thing clx:x ?px ; clx:y ?py } UNION { ?thing clx:hasMember ?m . "
                            "?m clx:x ?px ; clx:y ?py FILTER NOT EXISTS { ?thing clx:x ?own } } } "
                            "GROUP BY ?thing ORDER BY ?thing";
  const sparql::ResultTable table = sparql::evaluateQuery(map.quads(), query).table;
  std::vector<InventoryItem> found;
  for (std::size_t row = 0; row < table.row_count; ++row) {
    if (table.at(row, 1) == nullptr || table.at(row, 2) == nullptr) continue;
    const auto number = [&](std::size_t column) { return std::stod(table.at(row, column)->text); };
    InventoryItem& item = found.emplace_back();
    item.kind = map.classNames().nameOf(class_iri);
    item.class_iri = class_iri;
    item.object = table.at(row, 0)->text;
    item.at = {number(1), number(2)};
  }
  return found;
}

/// Objects that are gone, with their parts and primitives.
std::set<std::string> namesOfGone(const mapping::MapReader& map, const std::vector<bool>& is_gone) {
  std::set<std::string> gone;
  for (std::size_t i = 0; i < is_gone.size(); ++i) {
    if (!is_gone[i]) continue;
    const std::string object = rdf::iriOfObject(map.objectIds()[i]);
    gone.insert(object);
    for (const Quad& quad : mapping::quadsAbout(map.quads(), object, rdf::vocabulary::kGraphObserved))
      if (quad.predicate.text == rdf::vocabulary::clx("hasPart") ||
          quad.predicate.text == rdf::vocabulary::clx("hasPrimitive"))
        gone.insert(quad.object.text);
  }
  return gone;
}

}  // namespace

RegisterItems registerItems(const mapping::MapReader& map, const InventoryParams& params,
                            const std::vector<RegisterEntry>& entries) {
  const rdf::OntologyView ontology = ontologyViewOf(map.quads());
  std::set<std::string> classes;
  for (const RegisterEntry& entry : entries) classes.insert(entry.class_iri);
  const std::set<std::string> gone = namesOfGone(map, goneAmong(map));
  RegisterThings things;
  Inventory listed = inventoryOf(map, params);
  for (InventoryItem& item : listed.items) things.add(std::move(item)).is_listed = true;
  std::size_t rows_left_out = listed.rows_left_out;
  for (const std::string& class_iri : classes) {
    InventoryParams of_class{.classes = {class_iri}};
    of_class.with_rows = ontology.isA(rdf::vocabulary::clx("ParkingRow"), class_iri);
    of_class.with_sidewalks = ontology.isA(rdf::vocabulary::clx("Sidewalk"), class_iri);
    Inventory meant = inventoryOf(map, of_class);
    for (InventoryItem& item : meant.items) things.add(std::move(item)).classes.insert(class_iri);
    rows_left_out = std::max(rows_left_out, meant.rows_left_out);  // those of one class are among those of another
    for (InventoryItem& item : thingsTyped(map, class_iri))
      if (!gone.contains(item.object)) things.add(std::move(item)).classes.insert(class_iri);
  }
  return {things.take(), rows_left_out};
}

}  // namespace cluxel::tasks
