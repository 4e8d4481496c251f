// SPDX-License-Identifier: Apache-2.0
// Iterates over a key range of an index, page by page.
#include "rdf/store/quad_cursor.hpp"

#include <algorithm>
#include <stdexcept>

#include "rdf/store/literal_entries.hpp"
#include "rdf/store/number_entries.hpp"

namespace cluxel::rdf {

namespace {

/// Galloping lower bound; the last key must not be less than `key`.
const QuadKey* gallop(const QuadKey* first, const QuadKey* last, Key128 key) {
  std::ptrdiff_t step = 1;
  while (step < last - first && toNumber(first[step]) < key) step *= 2;
  const QuadKey* const bound = step < last - first ? first + step + 1 : last;
  return std::partition_point(first + step / 2, bound, [&](const QuadKey& entry) { return toNumber(entry) < key; });
}

}  // namespace

QuadCursor::Impl::Impl(const PageDirectory& from, const IndexPattern& laid_out, QuadOrder sorted_by)
    : directory(from), pattern(laid_out), order(sorted_by), position(from.lowerBound(laid_out.range.first)) {
  loadPage();
}

QuadCursor::Impl::Impl(std::shared_ptr<const std::vector<QuadKey>> keys, const IndexPattern& laid_out,
                       QuadOrder sorted_by)
    : collected(std::move(keys)), directory(none), pattern(laid_out), order(sorted_by) {
  at = collected->data();
  stop = at + collected->size();
}

bool QuadCursor::Impl::loadPage() {
  at = stop = nullptr;
  if (position.page >= directory.pageCount()) return false;
  const std::span<const QuadKey> keys = directory.page(position.page);
  const QuadKey* first = keys.data() + std::min(position.index, keys.size());
  const QuadKey* last = keys.data() + keys.size();
  if (first == last || toNumber(*first) > pattern.range.last) return false;
  if (toNumber(last[-1]) > pattern.range.last) {
    const auto beyond = [&](const QuadKey& key) { return toNumber(key) <= pattern.range.last; };
    last = std::partition_point(first, last, beyond);
  }
  at = first;
  stop = last;
  position = {position.page + 1, 0};
  return true;
}

void QuadCursor::Impl::moveTo(Key128 key) {
  if (key <= pattern.range.first) return;
  if (at != stop && toNumber(stop[-1]) >= key) {
    at = gallop(at, stop, key);
    return;
  }
  if (directory.pageCount() == 0) {
    at = stop;
    return;
  }
  const PageDirectory::Position present{position.page == 0 ? 0 : position.page - 1, 0};
  const PageDirectory::Position found = directory.lowerBound(key, present);
  if (found.page >= position.page) position = found;  // never moves backwards
  loadPage();
}

template <QuadOrder kOrder>
std::size_t QuadCursor::Impl::copy(std::span<QuadIds> out) {
  std::size_t count = 0;
  while (count < out.size() && (at != stop || loadPage())) {
    const QuadKey* const until = at + std::min<std::size_t>(out.size() - count, static_cast<std::size_t>(stop - at));
    if (!pattern.filtered) {
      for (; at != until; ++at) out[count++] = toQuad(*at, kOrder);
      continue;
    }
    for (; at != until; ++at)
      if ((toNumber(*at) & pattern.mask) == pattern.value) out[count++] = toQuad(*at, kOrder);
  }
  return count;
}

QuadCursor::QuadCursor() = default;
QuadCursor::QuadCursor(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
QuadCursor::QuadCursor(QuadCursor&&) noexcept = default;
QuadCursor& QuadCursor::operator=(QuadCursor&&) noexcept = default;
QuadCursor::~QuadCursor() = default;

bool QuadCursor::next(QuadIds& quad) {
  if (!impl_) return false;
  Impl& state = *impl_;
  while (state.at != state.stop || state.loadPage()) {
    const QuadKey& key = *state.at++;
    if ((toNumber(key) & state.pattern.mask) != state.pattern.value) continue;
    quad = toQuad(key, state.order);
    return true;
  }
  return false;
}

std::size_t QuadCursor::next(std::span<QuadIds> out) {
  if (!impl_) return 0;
  switch (impl_->order) {
    case QuadOrder::Spog:
      return impl_->copy<QuadOrder::Spog>(out);
    case QuadOrder::Posg:
      return impl_->copy<QuadOrder::Posg>(out);
    case QuadOrder::Ospg:
      return impl_->copy<QuadOrder::Ospg>(out);
    case QuadOrder::Gspo:
      return impl_->copy<QuadOrder::Gspo>(out);
    case QuadOrder::Psog:
      return impl_->copy<QuadOrder::Psog>(out);
  }
  return 0;
}

void QuadCursor::seek(const QuadIds& quad) {
  if (impl_) impl_->moveTo(toNumber(quad, impl_->order));
}

std::span<const QuadKey> QuadCursor::nextBlock() {
  if (!impl_ || (impl_->at == impl_->stop && !impl_->loadPage())) return {};
  constexpr std::ptrdiff_t kMaxOfBlock = 255;  // what fits into a page
  const std::span<const QuadKey> block(impl_->at, std::min(impl_->stop, impl_->at + kMaxOfBlock));
  impl_->at += block.size();
  return block;
}

bool QuadCursor::filtered() const {
  return impl_ && impl_->pattern.filtered;
}

QuadOrder QuadCursor::order() const {
  return impl_ ? impl_->order : QuadOrder::Spog;
}

/// The last position, where ascending lookups start, and prefetched positions of announced lookups.
struct PrefixLookup::Impl {
  explicit Impl(const PageDirectory& from) : directory(from) {}

  const PageDirectory& directory;
  std::optional<LiteralEntries> literals;  ///< of index ospg
  std::vector<QuadKey> collected;          ///< those of the literal that was looked up last
  std::optional<NumberEntries> numbers;    ///< of index posg
  TermId predicate = kNoTerm;              ///< that was looked up last in posg
  bool has_numbers = false;                ///< that predicate
  NumberEntries::Keys of_predicate;        ///< its keys, made when they are wanted
  PageDirectory::Position position;
  KeyRange range;
  std::vector<Key128> expected;                 ///< the first keys of announced lookups
  std::vector<PageDirectory::Position> places;  ///< their lower bounds
  std::size_t next_expected = 0;
  bool is_collected = false;

  void seek() {
    if (next_expected < expected.size() && expected[next_expected] == range.first) {
      position = places[next_expected++];
    } else {
      position = directory.lowerBound(range.first, position);
    }
  }

  /// Whether the index lacks quads with the prefix.
  bool mustCollect(std::span<const TermId> prefix) {
    if (literals) return literals->isLiteral(prefix.front());
    if (!numbers) return false;
    if (predicate != prefix.front()) {
      predicate = prefix.front();
      has_numbers = numbers->has(predicate);
      of_predicate = nullptr;
    }
    return has_numbers && (prefix.size() == 1 || numbers->isNumber(prefix[1]));
  }

  /// Expects the range of the lookup.
  std::span<const QuadKey> collect(std::span<const TermId> prefix) {
    if (next_expected < expected.size() && expected[next_expected] == range.first) ++next_expected;
    if (numbers) {
      if (!of_predicate) of_predicate = numbers->of(predicate);
      return keysWithin(*of_predicate, range);
    }
    const auto id = [prefix](std::size_t place) {
      return place < prefix.size() ? std::optional(prefix[place]) : std::nullopt;
    };
    collected = literals->of({.s = id(1), .p = id(2), .o = id(0), .g = id(3)});
    return collected;
  }

  std::span<const QuadKey> take() {
    if (position.page >= directory.pageCount()) return {};
    const std::span<const QuadKey> keys = directory.page(position.page);
    std::size_t stop = position.index;
    while (stop < keys.size() && stop < position.index + kNearby && toNumber(keys[stop]) <= range.last) ++stop;
    if (stop == position.index + kNearby && stop < keys.size()) {
      const auto within = [&](const QuadKey& key) { return toNumber(key) <= range.last; };
      const auto rest = keys.subspan(stop);
      stop += static_cast<std::size_t>(std::partition_point(rest.begin(), rest.end(), within) - rest.begin());
    }
    const auto found = keys.subspan(position.index, stop - position.index);
    position = stop == keys.size() ? PageDirectory::Position{position.page + 1, 0}
                                   : PageDirectory::Position{position.page, stop};
    return found;
  }

  static constexpr std::size_t kNearby = 8;  // most lookups match a few entries
};

PrefixLookup::PrefixLookup() = default;
PrefixLookup::PrefixLookup(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PrefixLookup::PrefixLookup(PrefixLookup&&) noexcept = default;
PrefixLookup& PrefixLookup::operator=(PrefixLookup&&) noexcept = default;
PrefixLookup::~PrefixLookup() = default;

void PrefixLookup::expect(std::span<const TermId> prefixes, std::size_t length) {
  if (!impl_ || length == 0 || length > 4 || impl_->directory.pageCount() == 0) return;
  impl_->expected.clear();
  impl_->next_expected = 0;
  for (std::size_t at = 0; at + length <= prefixes.size(); at += length) {
    impl_->expected.push_back(rangeOf(prefixes.subspan(at, length)).first);
  }
  impl_->places.resize(impl_->expected.size());
  impl_->directory.lowerBounds(impl_->expected, impl_->places);
}

std::span<const QuadKey> PrefixLookup::find(std::span<const TermId> prefix) {
  if (!impl_) return {};
  impl_->range = rangeOf(prefix);
  impl_->is_collected = impl_->mustCollect(prefix);
  if (impl_->is_collected) return impl_->collect(prefix);
  impl_->seek();
  return impl_->take();
}

std::span<const QuadKey> PrefixLookup::more() {
  // The range continues only if it reached the end of the page.
  if (!impl_ || impl_->is_collected || impl_->position.index != 0) return {};
  return impl_->take();
}

PrefixLookup QuadReader::lookup(QuadOrder order) const {
  if (order == QuadOrder::Psog) throw std::logic_error("there are no lookups in the index of numbers");
  auto impl = std::make_unique<PrefixLookup::Impl>(impl_->directory(order));
  const LmdbEnvironment& environment = *impl_->state().environment;
  if (order == QuadOrder::Ospg && environment.omitsLiterals()) impl->literals.emplace(impl_->transaction);
  if (order == QuadOrder::Posg && environment.keepsNumbersApart()) impl->numbers.emplace(impl_->transaction);
  return PrefixLookup(std::move(impl));
}

}  // namespace cluxel::rdf
