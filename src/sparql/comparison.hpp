// SPDX-License-Identifier: Apache-2.0
// Equality, order and effective boolean values of SPARQL, with type errors as a third answer.
#pragma once

#include <compare>
#include <optional>

#include "sparql/query_terms.hpp"

namespace cluxel::sparql {

/// The `=` operator: nothing for a type error.
std::optional<bool> equals(const Value& a, const Value& b, const QueryTerms& terms);
/// The order behind `<`, `>`, `<=`, `>=`: nothing for a type error, unordered for NaN and undecided times.
std::optional<std::partial_ordering> compare(const Value& a, const Value& b, const QueryTerms& terms);
bool sameTerm(const Value& a, const Value& b, const QueryTerms& terms);
std::optional<bool> effectiveBoolean(const Value& value, const QueryTerms& terms);

/// The total order of ORDER BY: unbound, blank nodes, IRIs, literals; numbers by value, then the other types; equal
/// values by their terms, so that only the same term is equal.
std::strong_ordering orderOf(const Value& a, const Value& b, const QueryTerms& terms);
/// orderOf without the comparison of terms at the end.
std::strong_ordering valueOrderOf(const Value& a, const Value& b, const QueryTerms& terms);
std::strong_ordering termOrderOf(const Value& a, const Value& b, const QueryTerms& terms);
std::strong_ordering termOrderOf(ValueId a, ValueId b, const QueryTerms& terms);
/// The place of a value's type in that order.
std::uint32_t orderRankOf(const Value& value);

}  // namespace cluxel::sparql
