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

}  // namespace cluxel::python

PYBIND11_MODULE(cluxel, module) {
  using namespace cluxel::python;
  module.doc() =
      "Semantic maps of laser scans: build, open, query, update and explain them.\n\n"
      "Positions are metres in the map frame, z up. Angles are radians. Errors are subclasses of CluxelError.";
  module.attr("__version__") = std::string(cluxel::version());
  bindErrors(module);
  bindTerms(module);
  bindAnswers(module);
  bindObjects(module);
  bindPoints(module);
  bindMaps(module);
}
