// SPDX-License-Identifier: Apache-2.0
// Computes and compares sort keys.
#include "sparql/exec/order_key.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "sparql/values/comparison.hpp"

namespace cluxel::sparql {
namespace {

std::uint64_t sortable(double number) {
  if (std::isnan(number)) return 0;
  if (number == 0) number = 0;  // normalises -0
  const auto bits = std::bit_cast<std::uint64_t>(number);
  return (bits >> 63) != 0 ? ~bits : bits | (1ull << 63);
}

std::uint64_t sortable(std::string_view text) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    bits = bits << 8 | (i < text.size() ? static_cast<unsigned char>(text[i]) : 0u);
  }
  return bits;
}

OrderKey keyOf(const Value& value, QueryTerms& terms) {
  OrderKey key;
  key.id = terms.intern(value);
  key.rank = orderRankOf(value);
  if (value.isNumeric()) key.bits = sortable(value.number);
  if (value.type == Value::Type::Boolean) key.bits = static_cast<std::uint64_t>(value.integer);
  if (value.isStringLike() || value.type == Value::Type::Iri) {
    const std::string_view text = terms.view(key.id).text;
    key.text = text.data();
    key.size = text.size();
  }
  return key;
}

}  // namespace

OrderKey OrderColumn::add(const Value& value, QueryTerms& terms, std::span<OrderKey> earlier, std::size_t stride) {
  OrderKey key = keyOf(value, terms);
  if (key.text == nullptr) return key;
  const std::string_view text = key.view();
  if (rank_ == 0) {
    rank_ = key.rank;
    first_ = text;
    common_ = text.size();
  }
  if (key.rank != rank_) {
    key.bits = sortable(text);
    return key;
  }
  const auto compared = std::min(common_, text.size());
  const auto common = static_cast<std::size_t>(
      std::mismatch(text.begin(), text.begin() + compared, first_.begin()).first - text.begin());
  if (common < common_) shorten(common, earlier, stride);
  key.bits = sortable(text.substr(common_));
  return key;
}

void OrderColumn::shorten(std::size_t common, std::span<OrderKey> earlier, std::size_t stride) {
  common_ = common;
  for (std::size_t i = 0; i < earlier.size(); i += stride) {
    if (earlier[i].rank == rank_) earlier[i].bits = sortable(earlier[i].view().substr(common_));
  }
}

std::strong_ordering compareKeys(const OrderKey& a, const OrderKey& b, const QueryTerms& terms) {
  if (a.rank != b.rank) return a.rank <=> b.rank;
  if (a.bits != b.bits) return a.bits <=> b.bits;
  if (a.id == b.id) return std::strong_ordering::equal;
  if (a.text != nullptr && b.text != nullptr) return a.view().compare(b.view()) <=> 0;
  return valueOrderOf(terms.valueOf(a.id), terms.valueOf(b.id), terms);
}

bool mayPrecede(const Value& value, const OrderKey& last, bool descending, const QueryTerms& terms) {
  std::strong_ordering order = orderRankOf(value) <=> last.rank;
  if (order == 0 && value.isNumeric()) order = sortable(value.number) <=> last.bits;
  if (order == 0 && (value.isStringLike() || value.type == Value::Type::Iri) && last.text != nullptr) {
    std::string scratch;
    order = terms.textOf(value, scratch).compare(last.view()) <=> 0;
  }
  return descending ? order >= 0 : order <= 0;
}

bool mayPrecede(double lower_bound, const OrderKey& last) {
  const std::uint32_t rank = orderRankOf(Value::ofDouble(lower_bound));
  return rank < last.rank || (rank == last.rank && sortable(lower_bound) <= last.bits);
}

}  // namespace cluxel::sparql
