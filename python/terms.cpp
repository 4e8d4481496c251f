// SPDX-License-Identifier: Apache-2.0
// RDF terms in Python, and Python values as terms.
#include <pybind11/operators.h>
#include <pybind11/stl.h>

#include <optional>
#include <set>
#include <string_view>

#include "bindings.hpp"

namespace cluxel::python {

namespace {

constexpr std::string_view kXsd = "http://www.w3.org/2001/XMLSchema#";

const char* termKindName(const Term& term) {
  switch (term.kind) {
    case TermKind::Iri:
      return "iri";
    case TermKind::BlankNode:
      return "blank";
    default:
      return "literal";
  }
}

/// As Turtle and SPARQL have it: letters, then groups of letters and digits.
bool isLanguageTag(std::string_view text) {
  const auto isLetter = [](char c) { return ('a' <= c && c <= 'z') || ('A' <= c && c <= 'Z'); };
  const auto isDigit = [](char c) { return '0' <= c && c <= '9'; };
  bool is_first = true, is_filled = false;
  for (const char c : text) {
    if (c == '-') {
      if (!is_filled) return false;
      is_first = is_filled = false;
    } else if (isLetter(c) || (isDigit(c) && !is_first)) {
      is_filled = true;
    } else {
      return false;
    }
  }
  return is_filled;
}

Term literalOf(const std::string& text, const std::optional<std::string>& datatype,
               const std::optional<std::string>& language) {
  if (datatype && language)
    throw Error(ErrorKind::InvalidArgument, "a literal has a datatype or a language, not both: leave one out");
  if (datatype) return Term::literal(text, *datatype);
  if (language && !isLanguageTag(*language))
    throw Error(ErrorKind::InvalidArgument, "'" + *language +
                                                "' is no language tag: write letters and digits in groups that are "
                                                "joined by '-', such as 'en' or 'de-CH'");
  return language ? Term::langLiteral(text, *language) : Term::literal(text);
}

bool isLocalXsd(const std::string& datatype, const std::set<std::string_view>& names) {
  const std::string_view text = datatype;
  return text.starts_with(kXsd) && names.contains(text.substr(kXsd.size()));
}

std::size_t hashOf(const Term& term) {
  return static_cast<std::size_t>(py::hash(py::str(toNTriples(term))));
}

}  // namespace

bool isIntegerType(const std::string& datatype) {
  static const std::set<std::string_view> names{"integer",
                                                "long",
                                                "int",
                                                "short",
                                                "byte",
                                                "nonNegativeInteger",
                                                "unsignedLong",
                                                "unsignedInt",
                                                "unsignedShort",
                                                "unsignedByte",
                                                "positiveInteger",
                                                "nonPositiveInteger",
                                                "negativeInteger"};
  return isLocalXsd(datatype, names);
}

bool isNumberType(const std::string& datatype) {
  static const std::set<std::string_view> names{"decimal", "double", "float"};
  return isIntegerType(datatype) || isLocalXsd(datatype, names);
}

/// Python reads more than XML Schema: blanks, "1_000" and "infinity".
bool isNumberText(const std::string& text, const std::string& datatype) {
  if (isLocalXsd(datatype, {"double", "float"}))
    return text.find_first_not_of("0123456789+-.eE") == std::string::npos || text == "INF" || text == "+INF" ||
           text == "-INF" || text == "NaN";
  return text.find_first_not_of("0123456789+-.") == std::string::npos;
}

std::string textOf(const py::handle& value, const std::string& what) {
  if (!py::isinstance<py::str>(value))
    throw py::type_error(what + " is a str, not " +
                         py::str(py::type::handle_of(value).attr("__name__")).cast<std::string>());
  Py_ssize_t size = 0;
  const char* const text = PyUnicode_AsUTF8AndSize(value.ptr(), &size);
  if (text != nullptr) return {text, static_cast<std::size_t>(size)};
  PyErr_Clear();
  throw py::type_error(what + " is a str that cannot be written as UTF-8: " + py::repr(value).cast<std::string>());
}

/// A number of NumPy as Python has it; other values as they are.
py::object withoutNumpy(const py::handle& value) {
  const py::object generic = py::module_::import("numpy").attr("generic");
  return py::isinstance(value, generic) ? value.attr("item")() : py::reinterpret_borrow<py::object>(value);
}

Term termOf(const py::handle& given) {
  const py::object value = withoutNumpy(given);
  if (py::isinstance<Term>(value)) return value.cast<Term>();
  if (py::isinstance<py::bool_>(value)) return Term::boolean(value.cast<bool>());
  if (py::isinstance<py::int_>(value))
    return Term::literal(py::str(value).cast<std::string>(), std::string(kXsd) + "integer");
  if (py::isinstance<py::float_>(value)) return Term::real(value.cast<double>());
  if (py::isinstance<py::str>(value)) return Term::literal(textOf(value, "a value"));
  throw Error(ErrorKind::InvalidArgument, "a value is Term, str, bool, int or float (also of NumPy), not " +
                                              py::str(py::type::handle_of(given).attr("__name__")).cast<std::string>() +
                                              "; cluxel.Term.iri(...) makes an IRI");
}

py::object valueOf(const Term& term) {
  if (term.kind == TermKind::Literal) {
    PyObject* number = nullptr;
    const py::str text(term.text);
    if (isNumberType(term.datatype) && isNumberText(term.text, term.datatype))
      number = isIntegerType(term.datatype) ? PyLong_FromUnicodeObject(text.ptr(), 10) : PyFloat_FromString(text.ptr());
    if (number != nullptr) return py::reinterpret_steal<py::object>(number);
    PyErr_Clear();  // an ill-typed literal keeps its text
    if (isLocalXsd(term.datatype, {"boolean"})) {
      if (term.text == "true" || term.text == "1") return py::bool_(true);
      if (term.text == "false" || term.text == "0") return py::bool_(false);
    }
  }
  return py::str(term.text);
}

void bindTerms(py::module_& module) {
  py::class_<Term>(module, "Term", "An RDF 1.1 term: an IRI, a blank node or a literal. Immutable, hashable.")
      .def_static(
          "iri", [](const std::string& iri) { return Term::iri(iri); }, py::arg("iri"), "The term of an IRI.")
      .def_static("literal", &literalOf, py::arg("text"), py::arg("datatype") = py::none(),
                  py::arg("language") = py::none(),
                  "A literal with the IRI of a datatype, or a language tag, or neither (xsd:string).")
      .def_property_readonly("kind", &termKindName, "'iri', 'blank' or 'literal'.")
      .def_readonly("text", &Term::text, "The IRI, the blank node's label, or the lexical form.")
      .def_property_readonly(
          "datatype", [](const Term& term) { return orNone(term.datatype); }, "IRI of a literal's datatype, else None.")
      .def_property_readonly(
          "language", [](const Term& term) { return orNone(term.language); }, "Language tag of a literal, else None.")
      .def_property_readonly("value", &valueOf, "int, float or bool of such a literal, else the text.")
      .def("n3", &toNTriples, "The term in N-Triples form.")
      .def(py::self == py::self)
      .def(py::self < py::self)
      .def("__hash__", &hashOf)
      .def("__str__", [](const Term& term) { return term.text; })
      .def("__repr__", [](const Term& term) { return "<cluxel.Term " + toNTriples(term) + ">"; });
}

}  // namespace cluxel::python
