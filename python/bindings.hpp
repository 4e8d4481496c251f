// SPDX-License-Identifier: Apache-2.0
// What the sources of the Python module share. It includes the installed headers of Cluxel only.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "cluxel/cluxel.hpp"

namespace cluxel::python {

namespace py = pybind11;

void bindErrors(py::module_& module);
void bindTerms(py::module_& module);
void bindAnswers(py::module_& module);
void bindObjects(py::module_& module);
void bindPoints(py::module_& module);
void bindMaps(py::module_& module);
void bindChanges(py::module_& module, py::class_<Map>& map);
void bindTasks(py::module_& module, py::class_<Map>& map);
void bindWays(py::module_& module, py::class_<Map>& map);
void bindVisits(py::module_& module, py::class_<Map>& map);

/// An immutable tuple type with named fields, of the module `cluxel`.
py::object namedTuple(py::module_& module, const char* name, const char* fields, const char* doc);

/// Diagnostics as a Python tuple of `cluxel.Diagnostic`.
py::tuple tupleOf(const std::vector<Diagnostic>& diagnostics);

/// The text of a str; `what` says whose it is. Throws py::type_error for other values, and for a str with halves of
/// characters, which no encoding has.
std::string textOf(const py::handle& value, const std::string& what);

/// The term of a Python value: Term, bool, int, float or str. Throws Error (InvalidArgument) for others.
Term termOf(const py::handle& value);
/// A number or truth value of a literal, else its text.
py::object valueOf(const Term& term);
bool isIntegerType(const std::string& datatype);
bool isNumberType(const std::string& datatype);

/// None for an empty text and for the number 0, which stands for "unknown".
inline py::object orNone(const std::string& text) {
  return text.empty() ? py::object(py::none()) : py::object(py::str(text));
}
inline py::object orNone(std::size_t number) {
  return number == 0 ? py::object(py::none()) : py::object(py::int_(number));
}

/// The arrays of a PointCloud. Object numbers are signed here: -1 is no object.
struct Points {
  py::array_t<double> xyz;
  py::object intensity;
  py::array_t<std::uint8_t> label;
  py::array_t<std::int32_t> object;
};
/// Takes over the library's arrays. The GIL is held.
Points arraysOf(PointCloud&& cloud);

/// Makes NumPy's functions known to this module. pybind11 does it at the first array, behind a lock that is held while
/// Python imports NumPy and runs other threads; two threads would wait for each other for ever. So every array is made
/// after this. Raises ImportError when NumPy is not there.
void requireNumpy();

/// An array that owns `values`, without a copy.
template <typename Value, typename Element>
py::array_t<Value> arrayOwning(std::vector<Element>&& values) {
  static_assert(sizeof(Value) == sizeof(Element));
  requireNumpy();
  auto* owned = new std::vector<Element>(std::move(values));
  const py::capsule owner(owned, [](void* vector) { delete static_cast<std::vector<Element>*>(vector); });
  return py::array_t<Value>(static_cast<py::ssize_t>(owned->size()), reinterpret_cast<const Value*>(owned->data()),
                            owner);
}

/// An array of shape (3,): x, y, z.
inline py::array_t<double> arrayOf(const Position& position) {
  requireNumpy();
  const double xyz[3] = {position.x, position.y, position.z};
  return py::array_t<double>(3, xyz);
}

/// An array of shape (2, 3): the smallest and the largest x, y, z.
inline py::array_t<double> boxOf(const Position& min, const Position& max) {
  requireNumpy();
  const double corners[6] = {min.x, min.y, min.z, max.x, max.y, max.z};
  return py::array_t<double>({2, 3}, corners);
}

}  // namespace cluxel::python
