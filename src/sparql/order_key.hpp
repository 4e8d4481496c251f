// SPDX-License-Identifier: Apache-2.0
// Sort keys of ORDER BY that are mostly told apart by two numbers, without a look at the terms.
#pragma once

#include <compare>
#include <span>
#include <string_view>

#include "sparql/query_terms.hpp"

namespace cluxel::sparql {

struct OrderKey {
  std::uint32_t rank = 0;  ///< of the kind of value
  ValueId id = kUnbound;
  std::uint64_t bits = 0;      ///< of values of one rank: less bits, less value; equal ones say nothing
  const char* text = nullptr;  ///< where texts decide: they stay in place while the query runs
  std::size_t size = 0;

  std::string_view view() const { return {text, size}; }
};

/// As valueOrderOf() of the values; for keys of one OrderColumn.
std::strong_ordering compareKeys(const OrderKey& a, const OrderKey& b, const QueryTerms& terms);

/// The keys that one expression of ORDER BY has. Where its texts all begin alike, as IRIs of one namespace do, the bits
/// are taken from what follows.
class OrderColumn {
 public:
  /// The key of the next row; `earlier` begins with the first key made so far and has them `stride` apart.
  OrderKey add(const Value& value, QueryTerms& terms, std::span<OrderKey> earlier, std::size_t stride);

 private:
  void shorten(std::size_t common, std::span<OrderKey> earlier, std::size_t stride);

  std::uint32_t rank_ = 0;  ///< of the texts whose beginning is left out; 0: none yet
  std::string_view first_;  ///< one of them
  std::size_t common_ = 0;  ///< how many bytes they share
};

}  // namespace cluxel::sparql
