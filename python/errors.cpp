// SPDX-License-Identifier: Apache-2.0
// Errors of the library as Python exceptions: one class for each ErrorKind, with place and remedy.
#include <pybind11/stl.h>

#include <array>

#include "bindings.hpp"

namespace cluxel::python {

namespace {

struct ErrorClass {
  ErrorKind kind;
  const char* kind_name;
  const char* class_name;
  PyObject* second_base;  ///< the built-in exception that Python programs expect, or null
  const char* doc;
};

const std::array<ErrorClass, 5>& errorClasses() {
  static const std::array<ErrorClass, 5> classes{{
      {ErrorKind::InvalidArgument, "InvalidArgument", "InvalidArgumentError", PyExc_ValueError,
       "An argument, name or combination of arguments is not allowed."},
      {ErrorKind::NotFound, "NotFound", "NotFoundError", PyExc_LookupError, "Nothing has the name that was asked for."},
      {ErrorKind::FaultyInput, "FaultyInput", "FaultyInputError", PyExc_ValueError,
       "Unreadable scans, or a faulty query, rule, ontology, label map or model."},
      {ErrorKind::StoreUnavailable, "StoreUnavailable", "StoreUnavailableError", nullptr,
       "The map cannot be opened, locked, read or written."},
      {ErrorKind::BudgetExceeded, "BudgetExceeded", "BudgetExceededError", nullptr,
       "A limit of time, rows or memory was exceeded."},
  }};
  return classes;
}

/// References that the module holds as long as the interpreter runs.
struct PythonClasses {
  std::array<PyObject*, 5> errors{};
  PyObject* diagnostic = nullptr;
};
PythonClasses python_classes;

/// What a Python program passes to help itself, or the command that does what no argument of this module does; empty
/// where a Python program meets no such error.
const char* remedyText(Remedy remedy) {
  switch (remedy) {
    case Remedy::ReplaceMap:
      return "pass force=True to replace it";
    case Remedy::NameHome:
      return "pass home=FOLDER, or set CLUXEL_HOME, to name the folder that holds ontology, rules and models";
    case Remedy::NamePoses:
      return "pass poses=FILE to name the poses";
    case Remedy::DropStatements:
      return "pass drop_statements=True to drop them";
    case Remedy::NameStart:
      return "pass start=PLACE to name the start";
    case Remedy::NameTime:
      return "pass since=TIME to tell from when on scans count as later";
    case Remedy::NameValue:
      return "pass bindings={NAME: VALUE} to give a variable its value";
    case Remedy::NameService:
      return "this module asks no other store; 'cluxel query --service IRI=FILE' does";
    case Remedy::NameLoadFile:
      return "this module loads no file; 'cluxel update --load IRI=FILE' does";
    case Remedy::ChooseInputs:
      return "pass use=MAP to name that map";
    case Remedy::NameTransform:
      return "pass T_first_second=MATRIX, which takes the second map to the first";
    case Remedy::MoveScans:
      return "Map.repose() gives scans of a map other poses";
    case Remedy::MergeMaps:
      return "cluxel.merge() makes one map of several";
    case Remedy::ListClouds:
      return "Map.clouds() lists the scans of a map";
    default:
      return "";
  }
}

py::object diagnosticOf(const Diagnostic& diagnostic) {
  const SourceLocation& place = diagnostic.location;
  return py::reinterpret_borrow<py::object>(python_classes.diagnostic)(
      diagnostic.severity == Severity::Error ? "error" : "warning", diagnostic.message, orNone(place.file),
      orNone(place.line), orNone(place.column), place.byte_offset, orNone(diagnostic.hint),
      orNone(diagnostic.source_line));
}

void raise(const Error& error, const std::vector<Diagnostic>& diagnostics) {
  const auto kind = static_cast<std::size_t>(error.kind());
  const std::string remedy = remedyText(error.remedy());
  const std::string text = remedy.empty() ? error.what() : error.what() + ("\n  hint: " + remedy);
  const py::object type = py::reinterpret_borrow<py::object>(python_classes.errors[kind]);
  const py::object instance = type(text);
  instance.attr("remedy") = orNone(remedy);
  instance.attr("diagnostics") = tupleOf(diagnostics);
  if (!diagnostics.empty()) {
    const py::object first = diagnosticOf(diagnostics.front());
    for (const char* name : {"file", "line", "column", "byte_offset", "hint"}) instance.attr(name) = first.attr(name);
  }
  PyErr_SetObject(type.ptr(), instance.ptr());
}

void translate(std::exception_ptr thrown) {
  try {
    std::rethrow_exception(std::move(thrown));
  } catch (const InputError& error) {
    raise(error, error.diagnostics());
  } catch (const Error& error) {
    raise(error, {});
  }
}

py::object newException(py::module_& module, const char* name, const py::object& bases, const py::dict& members,
                        const char* doc) {
  const std::string full_name = std::string("cluxel.") + name;
  const auto type =
      py::reinterpret_steal<py::object>(PyErr_NewExceptionWithDoc(full_name.c_str(), doc, bases.ptr(), members.ptr()));
  if (!type) throw py::error_already_set();
  module.attr(name) = type;
  return type;
}

py::object baseException(py::module_& module) {
  py::dict members;
  for (const char* name : {"kind", "file", "line", "column", "byte_offset", "hint", "remedy"})
    members[name] = py::none();
  members["diagnostics"] = py::tuple();
  return newException(
      module, "CluxelError", py::reinterpret_borrow<py::object>(PyExc_Exception), members,
      "Base of all errors of Cluxel. str(error) says what is wrong, where, and what to do.\n\n"
      "kind: name of the error's kind, such as 'FaultyInput'.\n"
      "file, line, column: place of the first fault; lines and columns count from 1, columns in bytes.\n"
      "byte_offset: place in a binary file, instead of line and column.\n"
      "hint: what to write instead. remedy: the argument that helps.\n"
      "diagnostics: all faults of the input, as a tuple of Diagnostic.\n"
      "What is not known is None.");
}

}  // namespace

py::tuple tupleOf(const std::vector<Diagnostic>& diagnostics) {
  py::tuple all(diagnostics.size());
  for (std::size_t i = 0; i < diagnostics.size(); ++i) all[i] = diagnosticOf(diagnostics[i]);
  return all;
}

void bindErrors(py::module_& module) {
  python_classes.diagnostic =
      namedTuple(
          module, "Diagnostic", "severity message file line column byte_offset hint source_line",
          "A fault or a warning: severity ('error' or 'warning'), message, file, line and column (from 1, columns "
          "in bytes) or byte_offset, hint, and the text of the line. What is not known is None.")
          .release()
          .ptr();
  const py::object base = baseException(module);
  for (const ErrorClass& error : errorClasses()) {
    py::dict members;
    members["kind"] = error.kind_name;
    const py::object bases =
        error.second_base == nullptr
            ? base
            : py::object(py::make_tuple(base, py::reinterpret_borrow<py::object>(error.second_base)));
    const py::object type = newException(module, error.class_name, bases, members, error.doc);
    python_classes.errors[static_cast<std::size_t>(error.kind)] = type.inc_ref().ptr();
  }
  py::register_exception_translator(&translate);
}

}  // namespace cluxel::python
