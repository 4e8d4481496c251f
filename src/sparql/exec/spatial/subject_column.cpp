// SPDX-License-Identifier: Apache-2.0
// Builds subject columns from the index of the predicate by a counting sort, and searches them.
#include "sparql/exec/spatial/subject_column.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <cstdlib>
#include <new>
#include <utility>

namespace cluxel::sparql {
namespace {

constexpr std::size_t kHugePage = std::size_t{2} << 20U;
/// A column is built after one index lookup per this many quads: a lookup costs about 250 ns, building 25 ns per quad.
constexpr std::uint64_t kQuadsPerLookup = 10;
/// The minimum number of lookups before a column is built, whatever the plan expects: many queries end early.
constexpr std::uint64_t kMinLookups = 1024;
constexpr std::uint64_t kMaxQuads = 0xFFFFFFFF;
/// Larger buckets use binary search.
constexpr std::ptrdiff_t kFewRows = 16;

rdf::QuadPattern quadsOf(const ColumnPattern& pattern) {
  rdf::QuadPattern quads;
  quads.p = pattern.predicate;
  if (pattern.object != rdf::kNoTerm) quads.o = pattern.object;
  return quads;
}

/// Calls `take(subject, object)` for each distinct triple of the pattern, in the order of the index.
template <typename Take>
void forEachTriple(const rdf::QuadReader& reader, const ColumnPattern& pattern, const GraphFilter& graphs, Guard& guard,
                   const Take& take) {
  const rdf::QuadPattern quads = quadsOf(pattern);
  const rdf::QuadOrder order = reader.scanOrder(quads);
  const std::size_t at_subject = order == rdf::QuadOrder::Psog ? 1 : 2, at_object = 3 - at_subject;
  rdf::QuadCursor cursor = reader.scan(quads, order);
  rdf::TermId last_subject = rdf::kNoTerm, last_object = rdf::kNoTerm;
  std::size_t seen = 0;
  for (auto block = cursor.nextBlock(); !block.empty(); block = cursor.nextBlock()) {
    for (const rdf::QuadKey& key : block) {
      const rdf::TermId object = key.at(at_object), subject = key.at(at_subject);
      if (subject == last_subject && object == last_object) continue;  // duplicate in another graph
      if (!graphs.admits(key.at(3))) continue;
      last_subject = subject;
      last_object = object;
      take(subject, object);
    }
    if ((seen += block.size()) < 65536) continue;
    seen = 0;
    guard.checkTime();
  }
}

/// Insertion sort: most buckets have two or three rows.
void sortRows(SubjectColumn::Row* first, SubjectColumn::Row* last) {
  if (last - first > kFewRows) return std::sort(first, last);
  const auto keyOf = [](const SubjectColumn::Row& row) { return std::uint64_t{row.subject} << 32U | row.object; };
  for (auto* row = first + 1; row < last; ++row) {
    const SubjectColumn::Row moved = *row;
    auto* place = row;
    for (; place != first && keyOf(place[-1]) > keyOf(moved); --place) *place = place[-1];
    *place = moved;
  }
}

}  // namespace

/// Requests huge pages for large arrays, which reduces TLB misses of random reads.
template <typename T>
SubjectColumn::Array<T> SubjectColumn::allocate(std::size_t count) {
  const std::size_t bytes = std::max<std::size_t>(count, 1) * sizeof(T);
  const bool large = bytes >= kHugePage;
  const std::size_t alignment = large ? kHugePage : 64;
  void* const memory = std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
  if (memory == nullptr) throw std::bad_alloc();
  // The tail keeps small pages to save memory. The hint has no effect on systems without huge pages.
  if (large) ::madvise(memory, bytes / kHugePage * kHugePage, MADV_HUGEPAGE);
  return Array<T>(static_cast<T*>(memory));
}

void SubjectColumn::layOut(rdf::TermId first, rdf::TermId last, std::size_t rows) {
  first_ = first;
  last_ = last;
  row_count_ = rows;
  const std::uint64_t ids = std::uint64_t{last} - first + 1;
  while ((ids >> shift_) > std::max<std::size_t>(rows / 2, 1)) ++shift_;  // about two rows per bucket
  start_count_ = static_cast<std::size_t>((ids - 1) >> shift_) + 2;
  rows_ = allocate<Row>(rows);
  starts_ = allocate<std::uint32_t>(start_count_);
  std::fill_n(starts_.get(), start_count_, 0);
}

SubjectColumn::SubjectColumn(const rdf::QuadReader& reader, const ColumnPattern& pattern, const GraphFilter& graphs,
                             Guard& guard) {
  rdf::TermId first = ~rdf::TermId{0}, last = 0;
  std::size_t rows = 0;
  forEachTriple(reader, pattern, graphs, guard, [&](rdf::TermId subject, rdf::TermId) {
    first = std::min(first, subject);
    last = std::max(last, subject);
    ++rows;
  });
  if (rows == 0) return;
  layOut(first, last, rows);
  // Counting sort: count, prefix sums, scatter. The scatter advances starts_[b] to the start of bucket b + 1.
  forEachTriple(reader, pattern, graphs, guard,
                [&](rdf::TermId subject, rdf::TermId) { ++starts_[bucketOf(subject)]; });
  std::uint32_t before = 0;
  for (std::size_t i = 0; i < start_count_; ++i) before += std::exchange(starts_[i], before);
  forEachTriple(reader, pattern, graphs, guard, [&](rdf::TermId subject, rdf::TermId object) {
    rows_[starts_[bucketOf(subject)]++] = {subject, object};
  });
  std::move_backward(starts_.get(), starts_.get() + start_count_ - 1, starts_.get() + start_count_);
  starts_[0] = 0;
  sortBuckets(guard);
}

void SubjectColumn::sortBuckets(Guard& guard) {
  for (std::size_t bucket = 0; bucket + 1 < start_count_; ++bucket) {
    if (starts_[bucket + 1] - starts_[bucket] > 1)
      sortRows(rows_.get() + starts_[bucket], rows_.get() + starts_[bucket + 1]);
    if (bucket % 65536 == 0) guard.checkTime();
  }
}

std::span<const SubjectColumn::Row> SubjectColumn::find(rdf::TermId subject) const {
  if (!isWithin(subject)) return {};
  const std::size_t bucket = bucketOf(subject);
  const Row* at = rows_.get() + starts_[bucket];
  const Row* const end = rows_.get() + starts_[bucket + 1];
  if (end - at > kFewRows) at = std::partition_point(at, end, [&](const Row& row) { return row.subject < subject; });
  while (at != end && at->subject < subject) ++at;
  const Row* stop = at;
  while (stop != end && stop->subject == subject) ++stop;
  return {at, stop};
}

std::span<const SubjectColumn::Row> SubjectColumn::find(rdf::TermId subject, rdf::TermId object) const {
  const auto all = find(subject);
  const auto at = std::partition_point(all.begin(), all.end(), [&](const Row& row) { return row.object < object; });
  return all.subspan(static_cast<std::size_t>(at - all.begin()), at != all.end() && at->object == object ? 1 : 0);
}

void SubjectColumn::expect(std::span<const rdf::TermId> subjects) const {
  for (const rdf::TermId subject : subjects) {
    if (isWithin(subject)) __builtin_prefetch(&starts_[bucketOf(subject)]);
  }
  for (const rdf::TermId subject : subjects) {
    if (!isWithin(subject)) continue;
    const std::uint32_t* const start = &starts_[bucketOf(subject)];
    __builtin_prefetch(rows_.get() + start[0]);
    __builtin_prefetch(rows_.get() + start[1]);  // often the next cache line
  }
}

const SubjectColumn* KeptColumn::after(std::size_t lookups, bool is_needed, const rdf::QuadReader& reader,
                                       const GraphFilter& graphs, Guard& guard) const {
  if (const SubjectColumn* column = column_.load(std::memory_order_acquire)) return column;
  const std::uint64_t made = lookups_.fetch_add(lookups, std::memory_order_relaxed) + lookups;
  const std::uint64_t worth = quads_ / kQuadsPerLookup;
  if (made < kMinLookups || quads_ >= kMaxQuads || (!is_needed && made < worth)) return nullptr;
  const std::unique_lock lock(making_, std::try_to_lock);
  if (!lock.owns_lock()) return nullptr;  // another reader is building it
  if (!made_) {
    made_ = std::make_unique<const SubjectColumn>(reader, pattern_, graphs, guard);
    column_.store(made_.get(), std::memory_order_release);
  }
  return made_.get();
}

std::shared_ptr<const KeptColumn> keptColumn(const rdf::QuadReader& reader, const ColumnPattern& pattern,
                                             const GraphFilter& graphs) {
  const bool without = graphs.kind == GraphFilter::Kind::AllBut;
  const std::string name = "column of " + std::to_string(pattern.predicate) + " " + std::to_string(pattern.object) +
                           (without ? " without " + std::to_string(graphs.graph) : "");
  auto column = std::static_pointer_cast<const KeptColumn>(reader.kept(name));
  if (column) return column;
  column = std::make_shared<const KeptColumn>(pattern, reader.estimate(quadsOf(pattern)));
  reader.keep(name, column);
  return column;
}

}  // namespace cluxel::sparql
