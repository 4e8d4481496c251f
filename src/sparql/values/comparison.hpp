// SPDX-License-Identifier: Apache-2.0
// SPARQL equality, order and effective boolean value; type errors are returned as none.
#pragma once

#include <compare>
#include <optional>

#include "sparql/exec/query_terms.hpp"

namespace cluxel::sparql {

/// The `=` operator; none for a type error.
std::optional<bool> equals(const Value& a, const Value& b, const QueryTerms& terms);
/// The order of `<`, `>`, `<=`, `>=`; none for a type error, unordered for NaN and incomparable times.
std::optional<std::partial_ordering> compare(const Value& a, const Value& b, const QueryTerms& terms);
bool sameTerm(const Value& a, const Value& b, const QueryTerms& terms);
std::optional<bool> effectiveBoolean(const Value& value, const QueryTerms& terms);

/// The total order of ORDER BY: unbound, blank nodes, IRIs, literals; among literals, numbers by value, then other
/// types. Equal values are ordered by term, so that only identical terms are equal.
std::strong_ordering orderOf(const Value& a, const Value& b, const QueryTerms& terms);
/// orderOf() without the final comparison of terms.
std::strong_ordering valueOrderOf(const Value& a, const Value& b, const QueryTerms& terms);
std::strong_ordering termOrderOf(const Value& a, const Value& b, const QueryTerms& terms);
std::strong_ordering termOrderOf(ValueId a, ValueId b, const QueryTerms& terms);
/// The rank of a value's type in that order.
std::uint32_t orderRankOf(const Value& value);

}  // namespace cluxel::sparql
