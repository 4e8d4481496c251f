// SPDX-License-Identifier: Apache-2.0
// Cardinalities: exact counts over few pages, estimates by page counts and samples over many.
#include <algorithm>
#include <cmath>
#include <utility>

#include "rdf/store/literal_entries.hpp"
#include "rdf/store/number_entries.hpp"
#include "rdf/store/quad_cursor.hpp"
#include "rdf/store/quad_reader_impl.hpp"

namespace cluxel::rdf {

namespace {

using Position = PageDirectory::Position;

constexpr std::size_t kExactPages = 32;  // some 8000 quads
/// The quads with one number are spread over those of its predicate.
constexpr std::size_t kExactPagesOfNumbers = 512;
constexpr std::size_t kSampledPages = 8;
constexpr std::size_t kSampledPagesOfPredicate = 64;

struct Stretch {
  Position from, to;
};

/// Pages without comparison may be out of order in a damaged file: then the end may come before the start.
Stretch stretchOf(const PageDirectory& directory, const KeyRange& range) {
  const Position from = directory.lowerBound(range.first);
  const Position to = range.last == ~Key128{0} ? directory.end() : directory.lowerBound(range.last + 1, from);
  const bool is_ahead = to.page > from.page || (to.page == from.page && to.index >= from.index);
  return {from, is_ahead ? to : from};
}

std::uint64_t matching(std::span<const QuadKey> keys, const IndexPattern& pattern) {
  return static_cast<std::uint64_t>(std::count_if(
      keys.begin(), keys.end(), [&](const QuadKey& key) { return (toNumber(key) & pattern.mask) == pattern.value; }));
}

std::span<const QuadKey> part(const PageDirectory& directory, std::size_t page, Position from, Position to) {
  const std::span<const QuadKey> keys = directory.page(page);
  const std::size_t first = page == from.page ? from.index : 0;
  const std::size_t last = page == to.page ? to.index : keys.size();
  return keys.subspan(first, last - first);
}

std::uint64_t countFiltered(const PageDirectory& directory, const IndexPattern& pattern, Position from, Position to) {
  std::uint64_t count = 0;
  for (std::size_t page = from.page; page < directory.pageCount() && page <= to.page; ++page)
    if (page < to.page || to.index > 0) count += matching(part(directory, page, from, to), pattern);
  return count;
}

/// A sample of pages: the first, the last and evenly spaced ones between.
std::uint64_t estimateOver(const PageDirectory& directory, const IndexPattern& pattern, Position from, Position to) {
  std::uint64_t seen = 0;
  std::uint64_t matched = 0;
  const std::size_t pages = to.page - from.page;
  for (std::size_t i = 0; i < kSampledPages; ++i) {
    const auto keys = part(directory, from.page + i * pages / kSampledPages, from, to);
    seen += keys.size();
    matched += matching(keys, pattern);
  }
  const double per_page = static_cast<double>(seen) / kSampledPages;
  const double all = per_page * static_cast<double>(pages);
  const double share = seen == 0 ? 1.0 : std::max(0.5, static_cast<double>(matched)) / static_cast<double>(seen);
  return static_cast<std::uint64_t>(std::max(1.0, pattern.filtered ? all * share : all));
}

std::uint64_t countIn(const PageDirectory& directory, const IndexPattern& pattern) {
  const auto [from, to] = stretchOf(directory, pattern.range);
  return pattern.filtered ? countFiltered(directory, pattern, from, to) : directory.distance(from, to);
}

/// The share of one of the matching quads in all of them.
double shareOf(const PageDirectory& directory, const QuadPattern& pattern, QuadOrder order) {
  return 1.0 / static_cast<double>(std::max<std::uint64_t>(1, countIn(directory, layOut(pattern, order))));
}

std::uint64_t distinct(const std::vector<QuadIds>& quads, TermId QuadIds::*place) {
  std::vector<TermId> ids(quads.size());
  std::transform(quads.begin(), quads.end(), ids.begin(), [place](const QuadIds& quad) { return quad.*place; });
  std::sort(ids.begin(), ids.end());
  return static_cast<std::uint64_t>(std::unique(ids.begin(), ids.end()) - ids.begin());
}

/// The quads of a predicate in index posg or psog.
class PredicatePart {
 public:
  PredicatePart(const PageDirectory& directory, QuadOrder order, const Stretch& stretch)
      : directory_(directory), order_(order), stretch_(stretch) {}

  /// Exact if this is small.
  std::uint64_t quads() const {
    if (isSmall()) return directory_.distance(stretch_.from, stretch_.to);
    return estimateOver(directory_, IndexPattern(), stretch_.from, stretch_.to);
  }
  bool isSmall() const { return stretch_.to.page - stretch_.from.page <= kExactPages; }

  /// Adds all quads.
  void addTo(std::vector<QuadIds>& quads) const {
    forEachPage(1, [&](std::size_t, std::span<const QuadKey> keys) {
      for (const QuadKey& key : keys) quads.push_back(toQuad(key, order_));
    });
  }

  /// The number of subjects; if this is large, an estimate: a sampled quad counts as 1/n of its subject, where n is the
  /// subject's number of quads with the predicate.
  double subjects(const PageDirectory& by_subject) const {
    if (isSmall()) return static_cast<double>(distinct(all(), &QuadIds::s));
    return sumOverSample([&](const QuadIds& quad) {
      return shareOf(by_subject, {.s = quad.s, .p = quad.p, .o = {}, .g = {}}, QuadOrder::Spog);
    });
  }

  /// As above, of objects.
  double objects() const {
    if (isSmall()) return static_cast<double>(distinct(all(), &QuadIds::o));
    if (order_ == QuadOrder::Psog) return numbers();
    return sumOverSample([&](const QuadIds& quad) {
      return shareOf(directory_, {.s = {}, .p = quad.p, .o = quad.o, .g = {}}, QuadOrder::Posg);
    });
  }

 private:
  std::size_t pages() const { return stretch_.to.page - stretch_.from.page + 1; }

  /// Calls `work` with the number and the keys of every `step`-th page.
  template <typename Work>
  void forEachPage(std::size_t step, const Work& work) const {
    for (std::size_t page = stretch_.from.page; page < directory_.pageCount() && page <= stretch_.to.page; page += step)
      work(page, part(directory_, page, stretch_.from, stretch_.to));
  }

  std::vector<QuadIds> all() const {
    std::vector<QuadIds> quads;
    addTo(quads);
    return quads;
  }

  /// Of a sample of one quad a page.
  template <typename Share>
  double sumOverSample(const Share& share) const {
    double sum = 0, sampled = 0;
    forEachPage(std::max<std::size_t>(1, pages() / kSampledPagesOfPredicate),
                [&](std::size_t page, std::span<const QuadKey> keys) {
                  if (keys.empty()) return;
                  sum += share(toQuad(keys[(page * 97) % keys.size()], order_));
                  ++sampled;
                });
    return sum * static_cast<double>(quads()) / std::max(1.0, sampled);
  }

  /// Quads with a number are ordered by subject. By the estimator of Charikar, Chaudhuri, Motwani and Narasayya (PODS
  /// 2000), what a sample has once stands for sqrt(quads / sample) numbers.
  double numbers() const {
    constexpr std::size_t kPages = 16;
    std::vector<TermId> sample;
    for (std::size_t i = 0; i < kPages; ++i) {
      const std::size_t page = stretch_.from.page + i * pages() / kPages;
      if (page < directory_.pageCount())
        for (const QuadKey& key : part(directory_, page, stretch_.from, stretch_.to)) sample.push_back(key.at(2));
    }
    std::sort(sample.begin(), sample.end());
    double often = 0, once = 0;
    for (auto first = sample.begin(); first != sample.end();) {
      const auto next = std::upper_bound(first, sample.end(), *first);
      (next - first == 1 ? once : often) += 1;
      first = next;
    }
    const auto of_sample = static_cast<double>(std::max<std::size_t>(1, sample.size()));
    return often + once * std::sqrt(static_cast<double>(quads()) / of_sample);
  }

  const PageDirectory& directory_;
  QuadOrder order_;
  Stretch stretch_;
};

/// The indexes that hold the quads of a pattern, which goes best by `order`.
std::vector<QuadOrder> holdersOf(const ReadTransaction& transaction, const QuadPattern& pattern, QuadOrder order) {
  const NumberEntries numbers(transaction);
  const TermId object = pattern.o.value_or(kNoTerm);
  const bool has_subject = pattern.s.value_or(kNoTerm) != kNoTerm;
  const bool may_lack = order == QuadOrder::Posg || (order == QuadOrder::Ospg && object != kNoTerm && !has_subject);
  if (!numbers.areApart() || !may_lack) return {order};
  if (object != kNoTerm) return {numbers.isNumber(object) ? QuadOrder::Psog : order};
  return {QuadOrder::Posg, QuadOrder::Psog};
}

/// Exact where index ospg lacks what matches; it has an object.
std::optional<std::uint64_t> countWithLiterals(const ReadTransaction& transaction, const QuadPattern& pattern) {
  const LiteralEntries literals(transaction);
  if (!literals.mayMatch(pattern.o)) return std::nullopt;
  const bool is_object_only = pattern.s.value_or(kNoTerm) == kNoTerm && !pattern.g;
  return is_object_only ? literals.count(*pattern.o) : literals.of(pattern).size();
}

std::uint64_t estimateIn(const PageDirectory& directory, const IndexPattern& pattern, QuadOrder order) {
  const auto [from, to] = stretchOf(directory, pattern.range);
  const bool is_of_number = order == QuadOrder::Psog && pattern.filtered;
  if (to.page - from.page > (is_of_number ? kExactPagesOfNumbers : kExactPages))
    return estimateOver(directory, pattern, from, to);
  return pattern.filtered ? countFiltered(directory, pattern, from, to) : directory.distance(from, to);
}

/// Calls `count` with the pattern in the order of each index that holds quads of it, and adds up what it returns.
template <typename Count>
std::uint64_t countBy(const ReadTransaction& transaction, const QuadPattern& pattern, const Count& count) {
  const QuadOrder best = QuadReader::bestOrder(pattern);
  std::uint64_t sum = 0;
  for (const QuadOrder order : holdersOf(transaction, pattern, best)) {
    if (order == QuadOrder::Ospg)
      if (const auto known = countWithLiterals(transaction, pattern)) return *known;
    sum += count(layOut(pattern, order), order);
  }
  return sum;
}

}  // namespace

std::uint64_t QuadReader::count(const QuadPattern& pattern) const {
  return countBy(impl_->transaction, pattern, [this](const IndexPattern& laid_out, QuadOrder order) {
    const bool is_all = order == QuadOrder::Spog && laid_out.prefix_length == 0 && !laid_out.filtered;
    return is_all ? size() : countIn(impl_->directory(order), laid_out);
  });
}

std::uint64_t QuadReader::estimate(const QuadPattern& pattern) const {
  return countBy(impl_->transaction, pattern, [this](const IndexPattern& laid_out, QuadOrder order) {
    const bool is_all = order == QuadOrder::Spog && laid_out.prefix_length == 0 && !laid_out.filtered;
    return is_all ? size() : estimateIn(impl_->pagesForEstimates(order), laid_out, order);
  });
}

QuadReader::PredicateStatistics QuadReader::statistics(TermId predicate) const {
  // In a write transaction a guarded index is estimated as of the commit before, through all its changes.
  const bool is_guarded = impl_->directory(QuadOrder::Posg).guard() && impl_->directory(QuadOrder::Spog).guard();
  StoreSnapshot& keeper = is_guarded ? impl_->snapshot().keeperOfEstimates() : impl_->snapshot();
  if (const auto known = keeper.knownStatistics(predicate)) return *known;
  const QuadPattern all{.s = {}, .p = predicate, .o = {}, .g = {}};
  std::vector<PredicatePart> parts;
  for (const QuadOrder order : holdersOf(impl_->transaction, all, QuadOrder::Posg)) {
    const PageDirectory& directory = impl_->pagesForEstimates(order);
    parts.push_back({directory, order, stretchOf(directory, rangeOf(std::array{predicate}))});
  }
  PredicateStatistics statistics;
  for (const PredicatePart& of : parts) statistics.quads += of.quads();
  if (std::all_of(parts.begin(), parts.end(), [](const PredicatePart& of) { return of.isSmall(); })) {
    std::vector<QuadIds> quads;
    for (const PredicatePart& of : parts) of.addTo(quads);
    statistics.objects = distinct(quads, &QuadIds::o);
    statistics.subjects = distinct(quads, &QuadIds::s);
  } else {
    double subjects = 0, objects = 0;
    for (const PredicatePart& of : parts) {
      subjects += of.subjects(impl_->pagesForEstimates(QuadOrder::Spog));
      objects += of.objects();
    }
    statistics.subjects = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::llround(subjects)));
    statistics.objects = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::llround(objects)));
  }
  keeper.keepStatistics(predicate, statistics);
  return statistics;
}

std::vector<TermId> QuadReader::graphs() const {
  return distinctFirst(impl_->directory(QuadOrder::Gspo));
}

std::vector<TermId> QuadReader::predicates() const {
  std::vector<TermId> predicates = distinctFirst(impl_->directory(QuadOrder::Posg));
  const NumberEntries numbers(impl_->transaction);
  if (!numbers.areApart()) return predicates;
  const std::vector<TermId> others = std::exchange(predicates, {}), of_numbers = numbers.predicates();
  std::set_union(others.begin(), others.end(), of_numbers.begin(), of_numbers.end(), std::back_inserter(predicates));
  return predicates;
}

}  // namespace cluxel::rdf
