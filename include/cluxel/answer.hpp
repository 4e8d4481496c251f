// SPDX-License-Identifier: Apache-2.0
// The answer to a SPARQL query as a value: a table of terms, true or false, or triples.
#pragma once

#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "cluxel/error.hpp"
#include "cluxel/export.hpp"
#include "cluxel/term.hpp"

namespace cluxel {

/// The form of an answer: of SELECT, of ASK, and of CONSTRUCT or DESCRIBE.
enum class AnswerKind : std::uint8_t { Solutions, Boolean, Triples };

/// An immutable answer. Copies share their data and are cheap. Any number of threads may read one. It stays valid when
/// the map changes or is closed. An answer that was moved from may only be destroyed or assigned to.
class CLUXEL_API Answer {
 public:
  class Row;
  class Iterator;
  struct Data;  ///< of the library

  AnswerKind kind() const;

  /// The variables of a SELECT without "?", in its order; empty for other kinds.
  const std::vector<std::string>& variables() const;
  /// The number of solutions; 0 for other kinds.
  std::size_t size() const;
  bool empty() const { return size() == 0; }
  /// The term in a row and a column, both from 0; null when the variable is unbound there. Constant cost.
  /// Throws Error (InvalidArgument) outside the table.
  const Term* at(std::size_t row, std::size_t column) const;
  /// The column of a variable. Throws Error (InvalidArgument) when the answer has no such variable.
  std::size_t column(std::string_view variable) const;
  Row operator[](std::size_t row) const;
  Iterator begin() const;
  Iterator end() const;

  /// The answer of an ASK; false for other kinds.
  bool boolean() const;
  /// The triples of a CONSTRUCT or DESCRIBE without duplicates, each with the default graph as its graph; empty for
  /// other kinds.
  const std::vector<Quad>& triples() const;

  /// Warnings about classes, properties and graphs that the query names and the map does not know, with "did you mean".
  const std::vector<Diagnostic>& warnings() const;

 private:
  explicit Answer(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

  std::shared_ptr<const Data> data_;
};

/// One solution. Valid while its answer lives.
class CLUXEL_API Answer::Row {
 public:
  Row(const Answer& answer, std::size_t row) : answer_(&answer), row_(row) {}
  /// The value of a variable, or of a column from 0; null when unbound. Throws Error (InvalidArgument) when the answer
  /// has no such variable.
  const Term* find(std::string_view variable) const { return answer_->at(row_, answer_->column(variable)); }
  const Term* find(std::size_t column) const { return answer_->at(row_, column); }
  /// The IRI, label or lexical form of a variable's value; empty when unbound. Throws as find().
  std::string text(std::string_view variable) const;
  /// The value of a variable as a number; NaN when it is unbound or no number. Throws as find().
  double number(std::string_view variable) const;
  std::size_t index() const { return row_; }

 private:
  const Answer* answer_;
  std::size_t row_;
};

/// Runs over the solutions of an answer, while the answer lives: a std::input_iterator. One made without an answer may
/// only be assigned to, compared or destroyed.
class CLUXEL_API Answer::Iterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = Row;
  using difference_type = std::ptrdiff_t;
  using pointer = void;
  using reference = Row;

  Iterator() = default;
  Iterator(const Answer& answer, std::size_t row) : answer_(&answer), row_(row) {}
  Row operator*() const { return {*answer_, row_}; }
  Iterator& operator++() {
    ++row_;
    return *this;
  }
  Iterator operator++(int) {
    Iterator before = *this;
    ++row_;
    return before;
  }
  bool operator==(const Iterator&) const = default;

 private:
  const Answer* answer_ = nullptr;
  std::size_t row_ = 0;
};

inline Answer::Row Answer::operator[](std::size_t row) const {
  return {*this, row};
}
inline Answer::Iterator Answer::begin() const {
  return {*this, 0};
}
inline Answer::Iterator Answer::end() const {
  return {*this, size()};
}

}  // namespace cluxel
