// SPDX-License-Identifier: Apache-2.0
// Objects and their parts in Python.
#include <pybind11/stl.h>

#include <cstdio>

#include "bindings.hpp"

namespace cluxel::python {

namespace {

std::string extentRepr(const Extent& extent, const char* type, const std::string& label) {
  char text[160];
  std::snprintf(text, sizeof text, "<cluxel.%s %.60s at (%.2f, %.2f, %.2f) m>", type, label.c_str(), extent.centroid.x,
                extent.centroid.y, extent.centroid.z);
  return text;
}

void bindExtent(py::module_& module) {
  py::class_<Extent>(module, "Extent",
                     "Where something lies and how large it is [m, map frame], rounded to millimetres.")
      .def_property_readonly(
          "centroid", [](const Extent& extent) { return arrayOf(extent.centroid); },
          "Mean of its points: float64 array of shape (3,) [m, map frame].")
      .def_property_readonly(
          "box", [](const Extent& extent) { return boxOf(extent.min, extent.max); },
          "Corners of its box along the axes of the map frame: float64 array of shape (2, 3), smallest and largest\n"
          "x, y, z [m].")
      .def_readonly("length_m", &Extent::length_m, "Longer side of the smallest upright box [m].")
      .def_readonly("width_m", &Extent::width_m, "Shorter side of the smallest upright box [m].")
      .def_readonly("height_m", &Extent::height_m, "From the lowest to the highest point [m].")
      .def_readonly("bottom_m", &Extent::bottom_m, "Lowest point above the local ground [m].")
      .def_readonly("top_m", &Extent::top_m, "Highest point above the local ground [m].")
      .def_readonly("point_count", &Extent::point_count, "Number of its points after thinning.");
}

}  // namespace

void bindObjects(py::module_& module) {
  bindExtent(module);
  py::class_<ObjectPart, Extent>(module, "ObjectPart", "A part of an object: the trunk of a tree.")
      .def_readonly("iri", &ObjectPart::iri, "IRI of the part.")
      .def_readonly("class_iri", &ObjectPart::class_iri, "IRI of its class.")
      .def_readonly("label", &ObjectPart::label, "English label of its class.")
      .def("__repr__", [](const ObjectPart& part) { return extentRepr(part, "ObjectPart", part.label); });
  py::class_<Object, Extent>(module, "Object", "An object that the rules found.")
      .def_readonly("number", &Object::number, "Its place in Map.objects(), which is sorted by IRI.")
      .def_readonly("iri", &Object::iri, "IRI of the object.")
      .def_readonly("class_iri", &Object::class_iri, "IRI of its class.")
      .def_readonly("label", &Object::label, "English label of its class: 'tree'.")
      .def_readonly("confidence", &Object::confidence, "Confidence in [0, 1].")
      .def_readonly("rule", &Object::rule, "The rule that made it.")
      .def_readonly("heading_rad", &Object::heading_rad,
                    "Direction of its longer side, from the x axis of the map towards y [rad].")
      .def_readonly("parts", &Object::parts, "Its parts, sorted by IRI: list of ObjectPart.")
      .def_readonly("first_seen", &Object::first_seen,
                    "Time of the first scan that speaks for it: str, xsd:dateTime in UTC, or None.")
      .def_readonly("last_seen", &Object::last_seen, "Time of the last scan that speaks for it, or None.")
      .def_readonly("seen_through", &Object::seen_through,
                    "It is gone: time of the first scan after last_seen that saw through its place. None: it is not\n"
                    "known to be gone.")
      .def("__repr__", [](const Object& object) { return extentRepr(object, "Object", object.label); });
}

}  // namespace cluxel::python
