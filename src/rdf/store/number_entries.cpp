// SPDX-License-Identifier: Apache-2.0
// Most predicates have numbers only or none, so that few scans have to collect from two indexes.
#include "rdf/store/number_entries.hpp"

#include <algorithm>
#include <array>

#include "rdf/store/indexes/index_orders.hpp"
#include "rdf/store/quad_cursor.hpp"
#include "rdf/terms/term_record.hpp"

namespace cluxel::rdf {

bool NumberEntries::areApart() const {
  return transaction_.impl().environment->keepsNumbersApart();
}

ObjectKind NumberEntries::kindOf(TermId id) const {
  StoreSnapshot& snapshot = snapshotOf(transaction_.impl());
  if (id == kNoTerm || id > snapshot.termCount()) return ObjectKind::Link;
  const TermRecord term = decodeTerm(snapshot.record(id, transaction_.impl()));
  if (term.kind != TermKind::Literal) return ObjectKind::Link;
  switch (term.value.type) {
    case DecodedValue::Type::Integer:
    case DecodedValue::Type::Decimal:
    case DecodedValue::Type::Float:
    case DecodedValue::Type::Double:
      return ObjectKind::Number;
    default:
      return ObjectKind::Literal;
  }
}

const PageDirectory& NumberEntries::directory(QuadOrder order) const {
  return snapshotOf(transaction_.impl()).directory(tableOf(order), transaction_.impl());
}

bool NumberEntries::hasIn(QuadOrder order, TermId predicate) const {
  const PageDirectory& keys = directory(order);
  const KeyRange range = rangeOf(std::array{predicate});
  const PageDirectory::Position at = keys.lowerBound(range.first);
  return at.page < keys.pageCount() && toNumber(keys.page(at.page)[at.index]) <= range.last;
}

bool NumberEntries::has(TermId predicate) const {
  return hasIn(QuadOrder::Psog, predicate);
}

bool NumberEntries::hasOnly(TermId predicate) const {
  return has(predicate) && !hasIn(QuadOrder::Posg, predicate);
}

std::vector<TermId> NumberEntries::predicates() const {
  return distinctFirst(directory(QuadOrder::Psog));
}

NumberEntries::Keys NumberEntries::of(TermId predicate) const {
  StoreSnapshot& snapshot = snapshotOf(transaction_.impl());
  const std::string name = "numbers of " + std::to_string(predicate);
  if (auto known = std::static_pointer_cast<const std::vector<QuadKey>>(snapshot.kept(name))) return known;
  const QuadPattern all{.s = {}, .p = predicate, .o = {}, .g = {}};
  auto made = std::make_shared<const std::vector<QuadKey>>(matching(all, QuadOrder::Posg));
  snapshot.keep(name, made);
  return made;
}

std::vector<QuadKey> NumberEntries::matching(const QuadPattern& pattern, QuadOrder order) const {
  std::vector<QuadIds> found;
  const auto take = [&](QuadOrder source) {
    QuadCursor quads(std::make_unique<QuadCursor::Impl>(directory(source), layOut(pattern, source), source));
    for (QuadIds quad; quads.next(quad);) found.push_back(quad);
  };
  const bool is_any = pattern.o.value_or(kNoTerm) == kNoTerm, may_be_number = is_any || isNumber(*pattern.o);
  if (areApart() && may_be_number) take(QuadOrder::Psog);
  if (!areApart() || is_any || !may_be_number) take(QuadOrder::Posg);
  if (!std::is_sorted(found.begin(), found.end())) std::sort(found.begin(), found.end());
  const std::vector<Key128> numbers = keysOf(found, order);
  std::vector<QuadKey> keys(numbers.size());
  std::transform(numbers.begin(), numbers.end(), keys.begin(), toKey);
  return keys;
}

ObjectKind ObjectKinds::of(TermId id) {
  const std::size_t number = id / kChunkSize;
  if (chunks_.size() <= number) chunks_.resize(number + 1);
  std::unique_ptr<Chunk>& chunk = chunks_[number];
  if (!chunk) chunk = std::make_unique<Chunk>();
  std::optional<ObjectKind>& kind = (*chunk)[id % kChunkSize];
  if (!kind) kind = entries_.kindOf(id);
  return *kind;
}

std::vector<TermId> distinctFirst(const PageDirectory& directory) {
  std::vector<TermId> ids;
  PageDirectory::Position at = directory.begin();
  while (at.page < directory.pageCount()) {
    const TermId id = directory.page(at.page)[at.index].at(0);
    ids.push_back(id);
    if (id == ~TermId{0}) break;
    at = directory.lowerBound(Key128{id + 1} << 96U, at);
  }
  return ids;
}

}  // namespace cluxel::rdf
