// SPDX-License-Identifier: Apache-2.0
// The Python module `cluxel`.
#include "bindings.hpp"

namespace cluxel::python {

py::object namedTuple(py::module_& module, const char* name, const char* fields, const char* doc) {
  const auto type = py::module_::import("collections").attr("namedtuple")(name, fields, py::arg("module") = "cluxel");
  type.attr("__doc__") = doc;
  module.attr(name) = type;
  return type;
}

namespace {

bool numpy_is_known = false;  ///< guarded by the GIL

}  // namespace

void requireNumpy() {
  if (numpy_is_known) return;
  py::module_::import("numpy");  // what it raises must not reach pybind11's lock
  py::array_t<double>(0);
  numpy_is_known = true;
}

}  // namespace cluxel::python

PYBIND11_MODULE(cluxel, module) {
  using namespace cluxel::python;
  module.doc() =
      "Semantic maps of laser scans: build, open, query, update and explain them.\n\n"
      "Positions are metres in the map frame, z up. Angles are radians. Errors are subclasses of CluxelError.";
  module.attr("__version__") = std::string(cluxel::version());
  try {
    requireNumpy();
  } catch (const py::error_already_set& error) {
    if (!error.matches(PyExc_ImportError)) throw;  // without NumPy, all but arrays works
  }
  bindErrors(module);
  bindTerms(module);
  bindAnswers(module);
  bindObjects(module);
  bindPoints(module);
  bindMaps(module);
}
