// SPDX-License-Identifier: Apache-2.0
// Sort keys of ORDER BY: two numbers decide most comparisons without reading terms.
#pragma once

#include <compare>
#include <span>
#include <string_view>

#include "sparql/exec/query_terms.hpp"

namespace cluxel::sparql {

struct OrderKey {
  std::uint32_t rank = 0;  ///< rank of the value's type
  ValueId id = kUnbound;
  std::uint64_t bits = 0;      ///< order-preserving prefix among values of one rank; equal bits do not decide
  const char* text = nullptr;  ///< the text to compare next; stable during the run
  std::size_t size = 0;

  std::string_view view() const { return {text, size}; }
};

/// The order of valueOrderOf(), for keys of one OrderColumn.
std::strong_ordering compareKeys(const OrderKey& a, const OrderKey& b, const QueryTerms& terms);

/// False when a value sorts after `last` for sure; decided without interning it.
bool mayPrecede(const Value& value, const OrderKey& last, bool descending, const QueryTerms& terms);
/// False when all numbers from `lower_bound` on sort after `last`.
bool mayPrecede(double lower_bound, const OrderKey& last);

/// The keys of one ORDER BY expression. If all texts share a prefix, as IRIs of one namespace do, the bits are taken
/// from the part after it.
class OrderColumn {
 public:
  /// The key of the next row. `earlier` points to the first key so far; keys are `stride` apart.
  OrderKey add(const Value& value, QueryTerms& terms, std::span<OrderKey> earlier, std::size_t stride);

 private:
  void shorten(std::size_t common, std::span<OrderKey> earlier, std::size_t stride);

  std::uint32_t rank_ = 0;  ///< rank of the texts with a shared prefix; 0 if none yet
  std::string_view first_;  ///< one of them
  std::size_t common_ = 0;  ///< length of the shared prefix
};

}  // namespace cluxel::sparql
