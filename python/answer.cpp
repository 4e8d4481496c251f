// SPDX-License-Identifier: Apache-2.0
// Answers in Python: columns as NumPy arrays of numbers or lists of text, terms, rows, triples.
#include <pybind11/stl.h>

#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

#include "bindings.hpp"

namespace cluxel::python {

namespace {

template <typename Number>
std::optional<Number> numberOf(const std::string& text) {
  Number value{};
  const bool has_plus = text.starts_with('+') && !text.starts_with("+-");
  const char* const begin = text.data() + (has_plus ? 1 : 0);
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (stop != end) return std::nullopt;
  if constexpr (std::is_floating_point_v<Number>)
    if (error == std::errc::result_out_of_range) {  // infinite or 0, as the datatype has it
      const bool is_small = text.find("e-") != std::string::npos || text.find("E-") != std::string::npos;
      const Number size = is_small ? Number{0} : std::numeric_limits<Number>::infinity();
      return text.starts_with('-') ? -size : size;
    }
  return error == std::errc() ? std::optional(value) : std::nullopt;
}

std::optional<double> numberOf(const Term* term) {
  if (term == nullptr || term->kind != TermKind::Literal || !isNumberType(term->datatype)) return std::nullopt;
  return numberOf<double>(term->text);
}

/// What the cells of a column have in common.
enum class ColumnKind : std::uint8_t { Integers, LargeIntegers, Numbers, Text };

/// Whether a double holds it exactly.
bool isExactAsDouble(const Term& integer) {
  constexpr std::int64_t kExact = std::int64_t{1} << 53;
  const auto value = numberOf<std::int64_t>(integer.text);
  return value && -kExact <= *value && *value <= kExact;
}

ColumnKind columnKindOf(const Answer& answer, std::size_t column) {
  if (answer.empty()) return ColumnKind::Numbers;
  bool are_whole = true, fit_int64 = true, fit_double = true, has_number = false;
  for (std::size_t row = 0; row < answer.size(); ++row) {
    const Term* term = answer.at(row, column);
    if (term != nullptr && !numberOf(term)) return ColumnKind::Text;
    has_number = has_number || term != nullptr;
    are_whole = are_whole && (term == nullptr || isIntegerType(term->datatype));
    fit_int64 = fit_int64 && term != nullptr && numberOf<std::int64_t>(term->text);
    fit_double = fit_double && (term == nullptr || isExactAsDouble(*term));
  }
  if (!has_number) return ColumnKind::Text;
  if (!are_whole) return ColumnKind::Numbers;
  if (fit_int64) return ColumnKind::Integers;
  return fit_double ? ColumnKind::Numbers : ColumnKind::LargeIntegers;
}

py::array_t<double> numbersOf(const Answer& answer, std::size_t column) {
  std::vector<double> values(answer.size());
  for (std::size_t row = 0; row < values.size(); ++row)
    values[row] = numberOf(answer.at(row, column)).value_or(std::numeric_limits<double>::quiet_NaN());
  return arrayOwning<double>(std::move(values));
}

py::array_t<std::int64_t> integersOf(const Answer& answer, std::size_t column) {
  std::vector<std::int64_t> values(answer.size());
  for (std::size_t row = 0; row < values.size(); ++row)
    values[row] = *numberOf<std::int64_t>(answer.at(row, column)->text);
  return arrayOwning<std::int64_t>(std::move(values));
}

/// One Python value for each cell; None where the variable is unbound.
template <typename Convert>
py::list cellsOf(const Answer& answer, std::size_t column, const Convert& convert) {
  py::list cells(answer.size());
  for (std::size_t row = 0; row < answer.size(); ++row) {
    const Term* term = answer.at(row, column);
    cells[row] = term == nullptr ? py::object(py::none()) : convert(*term);
  }
  return cells;
}

py::list textsOf(const Answer& answer, std::size_t column) {
  return cellsOf(answer, column, [](const Term& term) -> py::object { return py::str(term.text); });
}

/// Python numbers of any size, in an array, so that it adds and compares as the others do.
py::object largeIntegersOf(const Answer& answer, std::size_t column) {
  const py::list cells = cellsOf(answer, column, [](const Term& term) { return valueOf(term); });
  return py::module_::import("numpy").attr("array")(cells, py::arg("dtype") = "object");
}

py::object columnOf(const Answer& answer, std::size_t column) {
  switch (columnKindOf(answer, column)) {
    case ColumnKind::Integers:
      return integersOf(answer, column);
    case ColumnKind::LargeIntegers:
      return largeIntegersOf(answer, column);
    case ColumnKind::Numbers:
      return numbersOf(answer, column);
    default:
      return textsOf(answer, column);
  }
}

py::dict columnsOf(const Answer& answer) {
  py::dict columns;
  for (std::size_t i = 0; i < answer.variables().size(); ++i)
    columns[py::str(answer.variables()[i])] = columnOf(answer, i);
  return columns;
}

py::list rowsOf(const Answer& answer) {
  py::list rows(answer.size());
  for (std::size_t row = 0; row < answer.size(); ++row) {
    py::tuple cells(answer.variables().size());
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const Term* term = answer.at(row, i);
      cells[i] = term == nullptr ? py::object(py::none()) : valueOf(*term);
    }
    rows[row] = cells;
  }
  return rows;
}

py::list triplesOf(const Answer& answer) {
  py::list triples;
  for (const Quad& quad : answer.triples()) triples.append(py::make_tuple(quad.subject, quad.predicate, quad.object));
  return triples;
}

const char* answerKindName(const Answer& answer) {
  switch (answer.kind()) {
    case AnswerKind::Boolean:
      return "boolean";
    case AnswerKind::Triples:
      return "triples";
    default:
      return "solutions";
  }
}

std::size_t lengthOf(const Answer& answer) {
  return answer.kind() == AnswerKind::Triples ? answer.triples().size() : answer.size();
}

bool truthOf(const Answer& answer) {
  return answer.kind() == AnswerKind::Boolean ? answer.boolean() : lengthOf(answer) > 0;
}

std::string reprOf(const Answer& answer) {
  std::string text = std::string("<cluxel.Answer ") + answerKindName(answer);
  if (answer.kind() == AnswerKind::Boolean) return text + (answer.boolean() ? " true>" : " false>");
  text += " " + std::to_string(lengthOf(answer));
  for (const std::string& variable : answer.variables()) text += " ?" + variable;
  return text + ">";
}

void bindColumns(py::class_<Answer>& answers) {
  answers
      .def(
          "__getitem__",
          [](const Answer& answer, const std::string& variable) { return columnOf(answer, answer.column(variable)); },
          py::arg("variable"),
          "The column of a variable, shape (rows,): an int64 array when all cells are whole numbers, a float64 array\n"
          "(NaN: unbound) when all bound cells are numbers, else a list of str with None for unbound cells. Whole\n"
          "numbers that such an array would round are an array of int and None (dtype object). Without rows: an empty\n"
          "float64 array. numbers(variable), texts(variable) and terms(variable) give the same type always.")
      .def(
          "numbers",
          [](const Answer& answer, const std::string& variable) { return numbersOf(answer, answer.column(variable)); },
          py::arg("variable"), "The column as a float64 array of shape (rows,); NaN where it is unbound or no number.")
      .def(
          "texts",
          [](const Answer& answer, const std::string& variable) { return textsOf(answer, answer.column(variable)); },
          py::arg("variable"), "The column as a list of str: IRI, label or lexical form; None where it is unbound.")
      .def(
          "terms",
          [](const Answer& answer, const std::string& variable) {
            return cellsOf(answer, answer.column(variable), [](const Term& term) { return py::cast(term); });
          },
          py::arg("variable"), "The column as a list of Term, with datatype and language; None where it is unbound.");
}

}  // namespace

void bindAnswers(py::module_& module) {
  py::class_<Answer> answers(
      module, "Answer",
      "The answer to a query. It stays valid when the map changes.\n\n"
      "SELECT: answer['height'] is a column, len(answer) the number of rows, and iterating gives rows.\n"
      "ASK: bool(answer). CONSTRUCT and DESCRIBE: answer.triples, and len(answer) counts them.");
  bindColumns(answers);
  answers
      .def_property_readonly("kind", &answerKindName,
                             "'solutions' (SELECT), 'boolean' (ASK) or 'triples' (CONSTRUCT, DESCRIBE).")
      .def_property_readonly("variables", &Answer::variables, "The variables of a SELECT without '?', in its order.")
      .def_property_readonly("columns", &columnsOf, "dict from variable to column, as answer[variable] gives it.")
      .def_property_readonly("triples", &triplesOf, "The triples as (subject, predicate, object) of Term.")
      .def_property_readonly(
          "warnings", [](const Answer& answer) { return tupleOf(answer.warnings()); },
          "Classes, properties and graphs that the query names and the map does not know, as Diagnostic.")
      .def("__len__", &lengthOf, "Number of rows, or of triples.")
      .def("__bool__", &truthOf, "The answer of an ASK; for others, whether there is a row or a triple.")
      .def(
          "__iter__", [](const Answer& answer) { return py::iter(rowsOf(answer)); },
          "Iterates over rows: tuples of int, float, bool, str, or None where a variable is unbound.")
      .def("__repr__", &reprOf);
}

}  // namespace cluxel::python
