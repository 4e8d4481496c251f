// SPDX-License-Identifier: Apache-2.0
// The terms of one query: the store's by their ids, and beside them the terms that the query computes.
#pragma once

#include <deque>
#include <string>
#include <string_view>
#include <unordered_map>

#include "cluxel/sparql/result_table.hpp"
#include "sparql/value.hpp"

namespace cluxel::sparql {

/// Equal terms have equal ids: a computed term that the store knows has the store's id. Grows with each computed term.
class QueryTerms : public TermLookup {
 public:
  explicit QueryTerms(const QuadReader& reader) : reader_(reader) {}
  QueryTerms(const QueryTerms&) = delete;
  QueryTerms& operator=(const QueryTerms&) = delete;

  Value valueOf(ValueId id) const;
  /// The text stays in place while the reader lives, that of a computed term until rewind() drops it: sort keys point
  /// to it.
  TermView view(ResultId id) const override;
  void expect(std::span<const ResultId> ids) const override { reader_.expectViews(ids); }
  /// The same for valueOf().
  void expectValues(std::span<const ValueId> ids) const { reader_.expectValues(ids); }
  Term termOf(ValueId id) const;
  ValueId intern(const Term& term);
  /// The id of a value; kUnbound for an error.
  ValueId intern(const Value& value);

  /// Lexical form, IRI or label.
  std::string textOf(const Value& value) const;
  /// The same without a copy where there is one already; valid while `value`, `scratch` and the transaction live.
  std::string_view textOf(const Value& value, std::string& scratch) const;
  std::string languageOf(const Value& value) const;
  std::string datatypeOf(const Value& value) const;
  /// The exact number of an Integer or Decimal.
  Decimal exactOf(const Value& value) const;
  CalendarTime calendarOf(const Value& value) const;
  Duration durationOf(const Value& value) const;
  Term termOf(const Value& value) const;

  const QuadReader& reader() const { return reader_; }
  std::size_t computedBytes() const { return computed_bytes_; }
  /// The number of computed terms, to rewind() to: what a query's text names stays, what a run computed goes.
  std::size_t mark() const { return computed_.size(); }
  void rewind(std::size_t mark);

 private:
  struct TermHash {
    std::size_t operator()(const Term& term) const;
  };
  Value valueOfStored(ValueId id) const;

  const QuadReader& reader_;
  std::deque<Term> computed_;
  mutable std::unordered_map<ValueId, Value> decoded_;  ///< values that need their text read
  std::unordered_map<Term, ValueId, TermHash> id_of_;
  std::size_t computed_bytes_ = 0;
};

}  // namespace cluxel::sparql
