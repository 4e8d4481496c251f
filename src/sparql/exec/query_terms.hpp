// SPDX-License-Identifier: Apache-2.0
// The terms of one query: stored terms by their ids, and computed terms.
#pragma once

#include <deque>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>

#include "sparql/exec/id_table.hpp"
#include "sparql/results/result_table.hpp"
#include "sparql/values/value.hpp"

namespace cluxel::sparql {

/// Equal terms have equal ids; a computed term that the store contains has the store's id. Grows with each computed
/// term.
class QueryTerms : public TermLookup {
 public:
  explicit QueryTerms(const rdf::QuadReader& reader) : reader_(reader) {}
  QueryTerms(const QueryTerms&) = delete;
  QueryTerms& operator=(const QueryTerms&) = delete;

  Value valueOf(ValueId id) const;
  /// The text of a stored term is stable while the reader exists, that of a computed term until rewind(): sort keys
  /// point to it.
  rdf::TermView view(ResultId id) const override;
  /// Prefetches for valueOf().
  void expectValues(std::span<const ValueId> ids) const { reader_.expectValues(ids); }
  Term termOf(ValueId id) const;
  ValueId intern(Term term);
  /// The id of a value; kUnbound for an error value.
  ValueId intern(const Value& value);

  /// The lexical form, IRI or label.
  std::string textOf(const Value& value) const;
  /// As above, without a copy if possible; valid while `value`, `scratch` and the transaction exist.
  std::string_view textOf(const Value& value, std::string& scratch) const;
  std::string languageOf(const Value& value) const;
  std::string datatypeOf(const Value& value) const;
  /// The exact value of an Integer or Decimal.
  Decimal exactOf(const Value& value) const;
  CalendarTime calendarOf(const Value& value) const;
  Duration durationOf(const Value& value) const;
  Term termOf(const Value& value) const;

  const rdf::QuadReader& reader() const { return reader_; }
  std::size_t computedBytes() const { return computed_bytes_; }
  /// The number of computed terms. rewind() to it drops the terms of a run and keeps the constants of the query.
  std::size_t mark() const { return computed_.size(); }
  void rewind(std::size_t mark);

 private:
  /// A computed term. Datatypes and languages are held once.
  struct Computed {
    TermKind kind;
    std::string text;
    const std::string *datatype, *language;
  };
  static rdf::TermView viewOf(const Computed& term) { return {term.kind, term.text, *term.datatype, *term.language}; }
  const Computed& computedAt(ValueId id) const;
  const std::string* heldOnce(std::string& name);
  bool isSame(ValueId id, const Term& term) const;
  Value valueOfStored(ValueId id) const;

  const rdf::QuadReader& reader_;
  std::deque<Computed> computed_;
  std::unordered_set<std::string> names_;  ///< the datatypes and languages of computed_
  const std::string* last_name_ = nullptr;
  mutable std::unordered_map<ValueId, Value> decoded_;  ///< values that are decoded from text
  IdTable known_;
  mutable std::size_t computed_bytes_ = 0;  ///< of computed_, names_, known_ and decoded_
};

}  // namespace cluxel::sparql
