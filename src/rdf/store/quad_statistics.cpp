// SPDX-License-Identifier: Apache-2.0
// Cardinalities: exact counts over few pages, estimates by page counts and samples over many.
#include <algorithm>
#include <cmath>

#include "rdf/store/literal_entries.hpp"
#include "rdf/store/quad_cursor.hpp"
#include "rdf/store/quad_reader_impl.hpp"

namespace cluxel::rdf {

namespace {

using Position = PageDirectory::Position;

constexpr std::size_t kExactPages = 32;  // some 8000 quads
constexpr std::size_t kSampledPages = 8;
constexpr std::size_t kSampledQuads = 256;

struct Stretch {
  Position from, to;
};

/// Pages without comparison may be out of order in a damaged file: then the end may come before the start.
Stretch stretchOf(const PageDirectory& directory, const KeyRange& range) {
  const Position from = directory.lowerBound(range.first);
  const Position to = range.last == ~Key128{0} ? directory.end() : directory.lowerBound(range.last + 1);
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

/// The number of distinct second ids among keys with the same first id.
std::uint64_t distinctSecond(const PageDirectory& directory, Position from, Position to) {
  std::uint64_t distinct = 0;
  TermId last = kNoTerm;
  for (Position at = from; at.page < to.page || (at.page == to.page && at.index < to.index);) {
    for (const QuadKey& key : part(directory, at.page, at, to)) {
      distinct += key.at(1) != last ? 1 : 0;
      last = key.at(1);
    }
    at = {at.page + 1, 0};
  }
  return distinct;
}

/// All quads of a predicate, or an evenly spaced sample.
std::vector<QuadIds> sampleOf(const PageDirectory& directory, Position from, Position to, bool whole) {
  std::vector<QuadIds> sample;
  const std::size_t pages = to.page - from.page + 1;
  const std::size_t step = whole ? 1 : std::max<std::size_t>(1, pages / kSampledQuads);
  for (std::size_t page = from.page; page < directory.pageCount() && page <= to.page; page += step) {
    const auto keys = part(directory, page, from, to);
    if (whole)
      for (const QuadKey& key : keys) sample.push_back(toQuad(key, QuadOrder::Posg));
    else if (!keys.empty())
      sample.push_back(toQuad(keys[(page * 97) % keys.size()], QuadOrder::Posg));
  }
  return sample;
}

std::uint64_t countIn(const PageDirectory& directory, const IndexPattern& pattern) {
  const auto [from, to] = stretchOf(directory, pattern.range);
  return pattern.filtered ? countFiltered(directory, pattern, from, to) : directory.distance(from, to);
}

/// The share of one of the matching quads in all of them.
double shareOf(const PageDirectory& directory, const QuadPattern& pattern, QuadOrder order) {
  return 1.0 / static_cast<double>(std::max<std::uint64_t>(1, countIn(directory, layOut(pattern, order))));
}

/// Exact where index ospg lacks what matches; it has an object.
std::optional<std::uint64_t> countWithLiterals(const ReadTransaction& transaction, const QuadPattern& pattern) {
  const LiteralEntries literals(transaction);
  if (!literals.mayMatch(pattern.o)) return std::nullopt;
  const bool is_object_only = pattern.s.value_or(kNoTerm) == kNoTerm && !pattern.g;
  return is_object_only ? literals.count(*pattern.o) : literals.of(pattern).size();
}

}  // namespace

std::uint64_t QuadReader::count(const QuadPattern& pattern) const {
  const QuadOrder order = bestOrder(pattern);
  if (order == QuadOrder::Ospg) {
    if (const auto known = countWithLiterals(impl_->transaction, pattern)) return *known;
  }
  const IndexPattern laid_out = layOut(pattern, order);
  if (laid_out.prefix_length == 0 && !laid_out.filtered) return size();
  return countIn(impl_->directory(order), laid_out);
}

std::uint64_t QuadReader::estimate(const QuadPattern& pattern) const {
  const QuadOrder order = bestOrder(pattern);
  if (order == QuadOrder::Ospg) {
    if (const auto known = countWithLiterals(impl_->transaction, pattern)) return *known;
  }
  const IndexPattern laid_out = layOut(pattern, order);
  if (laid_out.prefix_length == 0 && !laid_out.filtered) return size();
  const PageDirectory& directory = impl_->pagesForEstimates(order);
  const auto [from, to] = stretchOf(directory, laid_out.range);
  if (to.page - from.page > kExactPages) return estimateOver(directory, laid_out, from, to);
  return laid_out.filtered ? countFiltered(directory, laid_out, from, to) : directory.distance(from, to);
}

QuadReader::PredicateStatistics QuadReader::statistics(TermId predicate) const {
  // In a write transaction a guarded index is estimated as of the commit before, through all its changes.
  const bool is_guarded = impl_->directory(QuadOrder::Posg).guard() && impl_->directory(QuadOrder::Spog).guard();
  StoreSnapshot& keeper = is_guarded ? impl_->snapshot().keeperOfEstimates() : impl_->snapshot();
  if (const auto known = keeper.knownStatistics(predicate)) return *known;
  const PageDirectory& directory = impl_->pagesForEstimates(QuadOrder::Posg);
  const PageDirectory& by_subject = impl_->pagesForEstimates(QuadOrder::Spog);
  const auto [from, to] = stretchOf(directory, rangeOf(std::array{predicate}));
  PredicateStatistics statistics;
  statistics.quads = directory.distance(from, to);
  if (to.page - from.page <= kExactPages) {
    statistics.objects = distinctSecond(directory, from, to);
    std::vector<TermId> subjects;
    for (const QuadIds& quad : sampleOf(directory, from, to, true)) subjects.push_back(quad.s);
    std::sort(subjects.begin(), subjects.end());
    statistics.subjects = static_cast<std::uint64_t>(std::unique(subjects.begin(), subjects.end()) - subjects.begin());
  } else {
    // A sampled quad counts as 1/n of its subject, where n is the subject's number of quads with this predicate.
    double subjects = 0;
    double objects = 0;
    const std::vector<QuadIds> sample = sampleOf(directory, from, to, false);
    for (const QuadIds& quad : sample) {
      subjects += shareOf(by_subject, {.s = quad.s, .p = predicate, .o = {}, .g = {}}, QuadOrder::Spog);
      objects += shareOf(directory, {.s = {}, .p = predicate, .o = quad.o, .g = {}}, QuadOrder::Posg);
    }
    const double scale = static_cast<double>(statistics.quads) / static_cast<double>(sample.size());
    statistics.subjects = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::llround(subjects * scale)));
    statistics.objects = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::llround(objects * scale)));
  }
  keeper.keepStatistics(predicate, statistics);
  return statistics;
}

namespace {

/// The distinct first ids of an index by a skip scan.
std::vector<TermId> distinctFirst(const PageDirectory& directory) {
  std::vector<TermId> ids;
  Position at = directory.begin();
  while (at.page < directory.pageCount()) {
    const TermId id = directory.page(at.page)[at.index].at(0);
    ids.push_back(id);
    if (id == ~TermId{0}) break;
    at = directory.lowerBound(Key128{id + 1} << 96U, at);
  }
  return ids;
}

}  // namespace

std::vector<TermId> QuadReader::graphs() const {
  return distinctFirst(impl_->directory(QuadOrder::Gspo));
}

std::vector<TermId> QuadReader::predicates() const {
  return distinctFirst(impl_->directory(QuadOrder::Posg));
}

}  // namespace cluxel::rdf
