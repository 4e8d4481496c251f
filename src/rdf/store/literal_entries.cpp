// SPDX-License-Identifier: Apache-2.0
// A map has about a hundred predicates, so that a literal is looked up under each of them.
#include "rdf/store/literal_entries.hpp"

#include <algorithm>
#include <array>
#include <memory>

#include "rdf/store/quad_reader_impl.hpp"

namespace cluxel::rdf {

namespace {

using Position = PageDirectory::Position;

/// The predicates of a snapshot, found once.
std::shared_ptr<const std::vector<TermId>> predicatesOf(const ReadTransaction& transaction) {
  constexpr const char* kName = "predicates";
  StoreSnapshot& snapshot = snapshotOf(transaction.impl());
  if (auto known = std::static_pointer_cast<const std::vector<TermId>>(snapshot.kept(kName))) return known;
  auto made = std::make_shared<const std::vector<TermId>>(QuadReader(transaction).predicates());
  snapshot.keep(kName, made);
  return made;
}

/// Calls `take` for each predicate that has the literal, with the position of its first key in posg and the greatest
/// possible one.
template <typename Take>
void forEachPredicate(const ReadTransaction& transaction, const PageDirectory& posg, TermId literal, const Take& take) {
  const auto predicates = predicatesOf(transaction);
  std::vector<Key128> first;
  first.reserve(predicates->size());
  for (const TermId predicate : *predicates) first.push_back(rangeOf(std::array{predicate, literal}).first);
  std::vector<Position> found(first.size());
  posg.lowerBounds(first, found);
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (found[i].page == posg.pageCount()) continue;
    const Key128 last = rangeOf(std::array{(*predicates)[i], literal}).last;
    if (toNumber(posg.page(found[i].page)[found[i].index]) <= last) take(found[i], last);
  }
}

}  // namespace

bool LiteralEntries::mayMatch(const std::optional<TermId>& object) const {
  if (!transaction_.impl().environment->omitsLiterals()) return false;
  return !object || *object == kNoTerm || isLiteral(*object);
}

std::vector<QuadKey> LiteralEntries::of(const QuadPattern& pattern) const {
  StoreSnapshot& snapshot = snapshotOf(transaction_.impl());
  std::vector<Key128> found;
  const auto take = [&](const QuadKey& key, QuadOrder order) {
    found.push_back(toNumber(toQuad(key, order), QuadOrder::Ospg));
  };
  const bool has_subject = pattern.s && *pattern.s != kNoTerm, has_object = pattern.o && *pattern.o != kNoTerm;
  if (has_object && !has_subject && numbers_.areApart() && numbers_.isNumber(*pattern.o)) {
    for (const TermId predicate : numbers_.predicates()) {
      const NumberEntries::Keys keys = numbers_.of(predicate);  // another thread may replace the kept ones
      for (const QuadKey& key : keysWithin(*keys, rangeOf(std::array{predicate, *pattern.o})))
        take(key, QuadOrder::Posg);
    }
  } else if (has_object && !has_subject) {
    const PageDirectory& posg = snapshot.directory(Table::Posg, transaction_.impl());
    forEachPredicate(transaction_, posg, *pattern.o, [&](Position at, Key128 last) {
      for (; at.page < posg.pageCount(); at = {at.page + 1, 0})
        for (const QuadKey& key : posg.page(at.page).subspan(at.index)) {
          if (toNumber(key) > last) return;
          take(key, QuadOrder::Posg);
        }
    });
  } else {
    QuadPattern in_spog{.s = pattern.s, .p = {}, .o = pattern.o, .g = {}};
    QuadCursor quads = QuadReader(transaction_).scan(in_spog, QuadOrder::Spog);
    for (auto block = quads.nextBlock(); !block.empty(); block = quads.nextBlock())
      for (const QuadKey& key : block)
        if (!has_object || key.at(2) == *pattern.o) take(key, QuadOrder::Spog);
  }
  const IndexPattern wanted = layOut(pattern, QuadOrder::Ospg);
  std::erase_if(found, [&](Key128 key) {
    return key < wanted.range.first || key > wanted.range.last || (key & wanted.mask) != wanted.value;
  });
  std::sort(found.begin(), found.end());
  std::vector<QuadKey> keys(found.size());
  std::transform(found.begin(), found.end(), keys.begin(), toKey);
  return keys;
}

std::uint64_t LiteralEntries::count(TermId literal) const {
  const PageDirectory& posg = snapshotOf(transaction_.impl()).directory(Table::Posg, transaction_.impl());
  std::uint64_t count = 0;
  forEachPredicate(transaction_, posg, literal, [&](Position at, Key128 last) {
    count += posg.distance(at, last == ~Key128{0} ? posg.end() : posg.lowerBound(last + 1, at));
  });
  return count;
}

}  // namespace cluxel::rdf
