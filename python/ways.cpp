// SPDX-License-Identifier: Apache-2.0
// Routes and cost maps in Python.
#include <pybind11/stl.h>

#include <array>

#include "gil.hpp"
#include "places.hpp"

namespace cluxel::python {

namespace {

constexpr std::array kGroundKinds{"free", "thing", "step", "too steep", "unobserved"};
static_assert(static_cast<std::size_t>(GroundKind::Unobserved) + 1 == kGroundKinds.size());
constexpr std::array kBarrierKinds{"unobserved", "thing", "too steep", "too narrow", "step"};
static_assert(static_cast<std::size_t>(BarrierKind::Step) + 1 == kBarrierKinds.size());

/// The cells of a CostMap as an array.
struct CostMapArray {
  py::array_t<double> origin;
  double cell_m;
  py::object cells;
};

Routes routes(const Map& map, const PlaceArgument& start, const PlaceArgument& goal, double width_m, double max_slope,
              double max_step_m, double clearance_m, double cell_m, const WordOrWords& without, bool with_gone,
              const std::optional<std::string>& near, std::size_t alternatives) {
  const RouteOptions options{{max_slope, max_step_m, clearance_m, cell_m, wordsOf(without), with_gone},
                             width_m,
                             near.value_or(std::string()),
                             alternatives};
  const Place from = placeOf(start), to = placeOf(goal);
  const ReleasedGil released;
  return map.routes(from, to, options);
}

CostMap costMapOf(const Map& map, const GroundOptions& options) {
  const ReleasedGil released;
  return map.costMap(options);
}

CostMapArray costMap(const Map& map, double max_slope, double max_step_m, double clearance_m, double cell_m,
                     const WordOrWords& without, bool with_gone) {
  CostMap found = costMapOf(map, {max_slope, max_step_m, clearance_m, cell_m, wordsOf(without), with_gone});
  const auto rows = static_cast<py::ssize_t>(found.rows), columns = static_cast<py::ssize_t>(found.columns);
  return {arrayOf(GroundPosition{found.min_x, found.min_y}), found.cell_m,
          arrayOwning<std::uint8_t>(std::move(found.cells)).reshape({rows, columns})};
}

py::tuple groundKinds() {
  py::tuple names(kGroundKinds.size());
  for (std::size_t i = 0; i < kGroundKinds.size(); ++i) names[i] = std::string(kGroundKinds[i]);
  return names;
}

void bindRoutes(py::module_& module) {
  py::class_<Route>(module, "Route", "A way over the ground.")
      .def_property_readonly(
          "line", [](const Route& route) { return arrayOf(route.line); },
          "Corners of the way: float64 array of shape (N, 2), x, y [m, map frame].")
      .def_readonly("length_m", &Route::length_m, "Length of the way [m].")
      .def_readonly("cost", &Route::cost,
                    "A metre costs 1, more on slopes, beside things and far from what it should stay near.")
      .def_readonly("climb_m", &Route::climb_m, "Sum of all that goes up [m].")
      .def_readonly("steepest", &Route::steepest, "Largest slope, rise over run.")
      .def_readonly("highest_step_m", &Route::highest_step_m, "Of the kerbs that it crosses [m].")
      .def_readonly("narrowest_m", &Route::narrowest_m, "Free width at the narrowest place [m]; None without things.")
      .def("__repr__",
           [](const Route& route) { return "<cluxel.Route " + std::to_string(std::lround(route.length_m)) + " m>"; });
  py::class_<Barrier>(module, "Barrier", "A stretch of closed ground on the way that crosses the least of it.")
      .def_property_readonly(
          "kind", [](const Barrier& barrier) { return kBarrierKinds.at(static_cast<std::size_t>(barrier.kind)); },
          "'unobserved', 'thing', 'too steep', 'too narrow' or 'step'.")
      .def_property_readonly(
          "object", [](const Barrier& barrier) { return orNone(barrier.object); },
          "IRI of the object of 'thing' and 'too narrow'; None: none, or no object that the map knows.")
      .def_property_readonly(
          "at", [](const Barrier& barrier) { return arrayOf(barrier.at); },
          "Where it begins: float64 array of shape (2,), x, y [m, map frame].")
      .def_readonly("length_m", &Barrier::length_m, "Length of the stretch [m].")
      .def_readonly("measured", &Barrier::measured,
                    "Slope (rise over run), free width or height of the step [m]; None for other kinds.")
      .def_readonly("text", &Barrier::text, "The same in English.")
      .def("__repr__", [](const Barrier& barrier) { return "<cluxel.Barrier " + barrier.text + ">"; });
  py::class_<Routes>(module, "Routes", "Ways from one place to another, or what closes them.")
      .def_readonly("routes", &Routes::routes, "list of Route, best first; empty: no way leads there.")
      .def_readonly("barriers", &Routes::barriers, "Without a route, what is in the way: list of Barrier.")
      .def(
          "__bool__", [](const Routes& found) { return !found.routes.empty(); }, "Whether a way leads there.")
      .def("__repr__",
           [](const Routes& found) { return "<cluxel.Routes " + std::to_string(found.routes.size()) + ">"; });
}

void bindCostMap(py::module_& module) {
  module.attr("GROUND_KINDS") = groundKinds();
  py::class_<CostMapArray>(module, "CostMap", "The ground of a map as square cells along the axes of the map frame.")
      .def_readonly("origin", &CostMapArray::origin,
                    "Corner of cells[0, 0] with the smallest x and y: float64 array of shape (2,) [m, map frame].")
      .def_readonly("cell_m", &CostMapArray::cell_m, "Edge length of a cell [m]; the resolution of the grid.")
      .def_readonly("cells", &CostMapArray::cells,
                    "uint8 array of shape (rows, columns), place in GROUND_KINDS. cells[r, c] has its centre at\n"
                    "origin + cell_m * (c + 0.5, r + 0.5).")
      .def("__repr__", [](const CostMapArray& found) {
        return "<cluxel.CostMap " + py::str(found.cells.attr("shape")).cast<std::string>() + " cells>";
      });
}

}  // namespace

void bindWays(py::module_& module, py::class_<Map>& map) {
  bindRoutes(module);
  bindCostMap(module);
  const RouteOptions standard;
  const GroundOptions& ground = standard.ground;
  map.def("routes", &routes, py::arg("start"), py::arg("goal"), py::kw_only(), py::arg("width_m") = standard.width_m,
          py::arg("max_slope") = ground.max_slope, py::arg("max_step_m") = ground.max_step_m,
          py::arg("clearance_m") = ground.clearance_m, py::arg("cell_m") = ground.cell_m,
          py::arg("without") = std::vector<std::string>(), py::arg("with_gone") = false, py::arg("near") = py::none(),
          py::arg("alternatives") = standard.alternatives,
          "Finds ways over the ground from one place to another, or tells what closes them, as Routes.\n\n"
          "start, goal: as `start` of search(); each is moved to the nearest open ground within 2 m.\n"
          "near: a class: the way should stay near such things. alternatives: largest number of routes, 1 to 9.\n"
          "The other arguments are those of search().\n"
          "Raises NotFoundError for an unknown class or object, a place without open ground near it, and when the map\n"
          "holds nothing of the class `near`; InvalidArgumentError for numbers out of range.");
  map.def("cost_map", &costMap, py::kw_only(), py::arg("max_slope") = ground.max_slope,
          py::arg("max_step_m") = ground.max_step_m, py::arg("clearance_m") = ground.clearance_m,
          py::arg("cell_m") = ground.cell_m, py::arg("without") = std::vector<std::string>(),
          py::arg("with_gone") = false,
          "The ground as a grid for the navigation software of a robot, which adds the robot's width, as CostMap.\n\n"
          "The arguments are those of search().");
}

}  // namespace cluxel::python
