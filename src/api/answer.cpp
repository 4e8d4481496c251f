// SPDX-License-Identifier: Apache-2.0
// Access to the tables of answers.
#include "cluxel/answer.hpp"

#include <algorithm>
#include <charconv>
#include <limits>

#include "api/answer_data.hpp"
#include "base/nearest_name.hpp"

namespace cluxel {

AnswerKind Answer::kind() const {
  switch (data_->result.kind) {
    case sparql::QueryResult::Kind::Boolean:
      return AnswerKind::Boolean;
    case sparql::QueryResult::Kind::Graph:
      return AnswerKind::Triples;
    default:
      return AnswerKind::Solutions;
  }
}

const std::vector<std::string>& Answer::variables() const {
  return data_->result.table.variables;
}
std::size_t Answer::size() const {
  return data_->result.table.row_count;
}
bool Answer::boolean() const {
  return data_->result.boolean;
}
const std::vector<Quad>& Answer::triples() const {
  return data_->result.graph;
}
const std::vector<Diagnostic>& Answer::warnings() const {
  return data_->warnings;
}

const Term* Answer::at(std::size_t row, std::size_t column) const {
  if (row >= size() || column >= variables().size())
    throw Error(ErrorKind::InvalidArgument, "row " + std::to_string(row) + ", column " + std::to_string(column) +
                                                ": the answer has " + std::to_string(size()) + " rows and " +
                                                std::to_string(variables().size()) + " columns, counted from 0");
  return data_->result.table.at(row, column);
}

std::size_t Answer::column(std::string_view variable) const {
  const auto place = std::find(variables().begin(), variables().end(), variable);
  if (place != variables().end()) return static_cast<std::size_t>(place - variables().begin());
  const std::string hint = suggestion(variable, variables());
  throw Error(ErrorKind::InvalidArgument,
              "the answer has no variable '" + std::string(variable) + "'" + (hint.empty() ? "" : "; " + hint));
}

std::string Answer::Row::text(std::string_view variable) const {
  const Term* term = find(variable);
  return term == nullptr ? std::string() : term->text;
}

double Answer::Row::number(std::string_view variable) const {
  const Term* term = find(variable);
  double value = 0;
  if (term == nullptr || term->kind != TermKind::Literal) return std::numeric_limits<double>::quiet_NaN();
  const char* end = term->text.data() + term->text.size();
  const auto [stop, error] = std::from_chars(term->text.data() + (term->text.starts_with('+') ? 1 : 0), end, value);
  return error == std::errc() && stop == end ? value : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace cluxel
