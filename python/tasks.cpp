// SPDX-License-Identifier: Apache-2.0
// Tasks in Python: inventory and search.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "gil.hpp"
#include "places.hpp"

namespace cluxel::python {

namespace {

using Words = std::vector<std::string>;
using OptionalPath = std::optional<std::filesystem::path>;

Inventory inventory(const Map& map, const WordOrWords& kinds, const OptionalPath& streets) {
  const InventoryOptions options{wordsOf(kinds), streets.value_or(std::filesystem::path())};
  const ReleasedGil released;
  return map.inventory(options);
}

SearchTour search(const Map& map, const std::string& class_name, const std::optional<PlaceArgument>& start,
                  const OptionalPath& places, double width_m, double max_slope, double max_step_m, double clearance_m,
                  double cell_m, const WordOrWords& without, bool with_gone, bool crosses_unobserved,
                  std::optional<double> budget_m, std::size_t max_stops, double view_m, double detection) {
  SearchOptions options;
  options.ground = {max_slope, max_step_m, clearance_m, cell_m, wordsOf(without), with_gone};
  options.width_m = width_m;
  if (start) options.start = placeOf(*start);
  options.places = places.value_or(std::filesystem::path());
  options.crosses_unobserved = crosses_unobserved;
  options.budget_m = budget_m;
  options.max_stops = max_stops;
  options.view_m = view_m;
  options.detection = detection;
  const ReleasedGil released;
  return map.search(class_name, options);
}

void bindInventory(py::module_& module) {
  py::class_<InventoryItem>(module, "InventoryItem",
                            "An entry of an inventory. Sizes are None where they do not apply to its kind.")
      .def_readonly("kind", &InventoryItem::kind, "Local name of its class: 'Tree', 'ParkingRow'.")
      .def_readonly("class_iri", &InventoryItem::class_iri, "IRI of its class.")
      .def_property_readonly(
          "object", [](const InventoryItem& item) { return orNone(item.object); },
          "IRI of the object or way; None for a row.")
      .def_property_readonly(
          "street", [](const InventoryItem& item) { return orNone(item.street); },
          "Name of the nearest street; None when no street is known within 25 m.")
      .def_property_readonly(
          "at", [](const InventoryItem& item) { return arrayOf(item.at); },
          "Position, of a tree that of its trunk: float64 array of shape (2,), x, y [m, map frame].")
      .def_readonly("height_m", &InventoryItem::height_m, "Top above the local ground [m].")
      .def_readonly("crown_m", &InventoryItem::crown_m,
                    "Diameter of the circle that is as large as the crown from above [m].")
      .def_readonly("width_m", &InventoryItem::width_m, "Of a row; of a sidewalk the median across it [m].")
      .def_readonly("length_m", &InventoryItem::length_m, "Of a row or sidewalk [m].")
      .def_readonly("vehicle_count", &InventoryItem::vehicle_count, "Vehicles of a row.")
      .def_property_readonly(
          "line", [](const InventoryItem& item) { return arrayOf(item.line); },
          "Course of a row or sidewalk: float64 array of shape (N, 2), x, y [m, map frame]; of others N is 0.")
      .def("__repr__", [](const InventoryItem& item) {
        return "<cluxel.InventoryItem " + item.kind + " at (" + shortText(item.at) + ") m>";
      });
  py::class_<Inventory>(module, "Inventory", "Entries and notes.")
      .def_readonly("items", &Inventory::items,
                    "list of InventoryItem: objects by class and IRI, then rows and sidewalks by place.")
      .def_readonly("notes", &Inventory::notes,
                    "What is not listed and why, streets that are all far away, and the like: list of str.")
      .def("__repr__", [](const Inventory& inventory) {
        return "<cluxel.Inventory " + std::to_string(inventory.items.size()) + " items>";
      });
}

void bindSearch(py::module_& module) {
  py::class_<KnownObject>(module, "KnownObject", "An object of the class that the map holds already.")
      .def_readonly("iri", &KnownObject::iri, "IRI of the object.")
      .def_readonly("distance_m", &KnownObject::distance_m, "Straight from the start [m].");
  py::class_<SearchStop>(module, "SearchStop", "A place to look from.")
      .def_property_readonly(
          "at", [](const SearchStop& stop) { return arrayOf(stop.at); },
          "float64 array of shape (2,), x, y [m, map frame].")
      .def_readonly("walk_m", &SearchStop::walk_m, "Length of the walk from the stop before [m].")
      .def_readonly("total_m", &SearchStop::total_m, "Length of the walk from the start [m].")
      .def_readonly("probability", &SearchStop::probability,
                    "Probability that the object is first seen from here, or on the way here.")
      .def_readonly("so_far", &SearchStop::so_far, "Probability that it is seen from here or before.")
      .def_property_readonly(
          "near_class", [](const SearchStop& stop) { return orNone(stop.near_class); },
          "Local name of the class of the usual place that most of the probability comes from; None: anywhere.")
      .def_property_readonly(
          "way", [](const SearchStop& stop) { return arrayOf(stop.way); },
          "Corners of the way from the stop before: float64 array of shape (N, 2), x, y [m, map frame].")
      .def("__repr__", [](const SearchStop& stop) { return "<cluxel.SearchStop (" + shortText(stop.at) + ") m>"; });
  py::class_<SearchTour>(module, "SearchTour", "A walk that finds objects of a class soon.")
      .def_readonly("known", &SearchTour::known, "list of KnownObject, nearest first.")
      .def_readonly("stops", &SearchTour::stops, "list of SearchStop, in the order of the walk.")
      .def("__repr__", [](const SearchTour& tour) {
        return "<cluxel.SearchTour " + std::to_string(tour.stops.size()) + " stops>";
      });
}

}  // namespace

void bindTasks(py::module_& module, py::class_<Map>& map) {
  bindInventory(module);
  bindSearch(module);
  const SearchOptions standard;
  map.def("inventory", &inventory, py::arg("kinds") = Words(), py::kw_only(), py::arg("streets") = py::none(),
          "Lists and measures what a town keeps lists of, as Inventory, without what later scans show to be gone.\n\n"
          "kinds: a class or several, named as for objects(), 'ParkingRow' and 'Sidewalk'; without any: street signs,\n"
          "street lamps, traffic lights, utility poles, trees, and both of these.\n"
          "streets: GeoJSON file of lines with names: each entry gets the name of its nearest street.\n"
          "Raises NotFoundError for an unknown class, InvalidArgumentError for one whose things are no objects,\n"
          "FaultyInputError for a faulty file.");
  map.def(
      "search", &search, py::arg("class_name"), py::kw_only(), py::arg("start") = py::none(),
      py::arg("places") = py::none(), py::arg("width_m") = standard.width_m,
      py::arg("max_slope") = standard.ground.max_slope, py::arg("max_step_m") = standard.ground.max_step_m,
      py::arg("clearance_m") = standard.ground.clearance_m, py::arg("cell_m") = standard.ground.cell_m,
      py::arg("without") = Words(), py::arg("with_gone") = false, py::arg("crosses_unobserved") = false,
      py::arg("budget_m") = py::none(), py::arg("max_stops") = standard.max_stops, py::arg("view_m") = standard.view_m,
      py::arg("detection") = standard.detection,
      "Plans a walk on which a further object of the class is likely seen soon, as SearchTour.\n\n"
      "start: (x, y) [m, map frame], an Object, its number, or a name: an IRI, at least four leading digits of its\n"
      "hash, or 'X,Y'; None: where the last scan was taken.\n"
      "places: Turtle file of usual places of classes; None: those of the ontology.\n"
      "width_m: free width that is needed. max_slope: rise over run. max_step_m: height of a kerb that can be\n"
      "crossed. clearance_m: what hangs higher is no obstacle. cell_m: 0.125, 0.25, 0.5 or 1.\n"
      "without: classes to leave out, 'Movable' or 'Static'. with_gone: keeps what later scans saw through.\n"
      "crosses_unobserved: the walk may cross ground that was not observed. budget_m: its largest length.\n"
      "view_m: how far an object is recognised. detection: share of the objects of the class in view of a scan\n"
      "that the map holds.\n"
      "Raises NotFoundError for an unknown class or place and a start without open ground within 2 m,\n"
      "InvalidArgumentError for numbers out of range.");
}

}  // namespace cluxel::python
