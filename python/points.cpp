// SPDX-License-Identifier: Apache-2.0
// Points and scans in Python.
#include <pybind11/stl.h>

#include "bindings.hpp"

namespace cluxel::python {

namespace {

static_assert(static_cast<std::int32_t>(kNoObject) == -1);

py::array_t<double> xyzOf(const PointCloud& cloud) {
  requireNumpy();
  py::array_t<double> xyz({cloud.size(), std::size_t{3}});
  double* out = xyz.mutable_data();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    *out++ = cloud.x[i];
    *out++ = cloud.y[i];
    *out++ = cloud.z[i];
  }
  return xyz;
}

py::tuple labelNames() {
  constexpr auto kCount = static_cast<std::size_t>(PrimitiveLabel::Scatter) + 1;
  py::tuple names(kCount);
  for (std::size_t i = 0; i < kCount; ++i) names[i] = std::string(cluxel::nameOf(static_cast<PrimitiveLabel>(i)));
  return names;
}

void bindClouds(py::module_& module) {
  py::class_<Cloud>(module, "Cloud", "One scan of a map.")
      .def_readonly("id", &Cloud::id, "32 hexadecimal digits, the hash of what was measured.")
      .def_readonly("iri", &Cloud::iri, "IRI of the scan.")
      .def_readonly("source", &Cloud::source, "The file that it was read from.")
      .def_readonly("time_s", &Cloud::time_s, "Time since the epoch of the recording [s]; None when not recorded.")
      .def_readonly("has_pose", &Cloud::has_pose, "False: its points were given in the map frame.")
      .def_property_readonly(
          "T_map_sensor",
          [](const Cloud& cloud) {
            requireNumpy();
            return py::array_t<double>({4, 4}, cloud.T_map_sensor.data());
          },
          "Pose of the sensor: float64 array of shape (4, 4); T_map_sensor @ [x, y, z, 1] is in the map frame [m].")
      .def_readonly("point_count", &Cloud::point_count, "Number of its points.")
      .def_property_readonly(
          "box", [](const Cloud& cloud) { return boxOf(cloud.min, cloud.max); },
          "Bounds of its points: float64 array of shape (2, 3), smallest and largest x, y, z [m, map frame].")
      .def("__repr__", [](const Cloud& cloud) {
        return "<cluxel.Cloud " + cloud.id.substr(0, 8) + " " + std::to_string(cloud.point_count) + " points>";
      });
}

}  // namespace

Points arraysOf(PointCloud&& cloud) {
  Points points;
  points.xyz = xyzOf(cloud);
  points.intensity = cloud.intensity.size() == cloud.size() && cloud.size() > 0
                         ? py::object(arrayOwning<float>(std::move(cloud.intensity)))
                         : py::object(py::none());
  points.label = arrayOwning<std::uint8_t>(std::move(cloud.label));
  points.object = arrayOwning<std::int32_t>(std::move(cloud.object));
  return points;
}

void bindPoints(py::module_& module) {
  bindClouds(module);
  module.attr("LABELS") = labelNames();
  py::class_<Points>(module, "Points", "Points as arrays of the same length N, which belong to the caller.")
      .def_readonly("xyz", &Points::xyz, "float64 array of shape (N, 3) [m, map frame].")
      .def_readonly("intensity", &Points::intensity,
                    "float32 array of shape (N,) in the sensor's own scale; None when a scan has no intensities.")
      .def_readonly("label", &Points::label, "Surface around each point: uint8 array of shape (N,), place in LABELS.")
      .def_readonly("object", &Points::object,
                    "Object of each point: int32 array of shape (N,), Object.number; -1: no object.")
      .def(
          "__len__", [](const Points& points) { return points.label.size(); }, "Number of points.")
      .def("__repr__",
           [](const Points& points) { return "<cluxel.Points " + std::to_string(points.label.size()) + ">"; });
}

}  // namespace cluxel::python
