// SPDX-License-Identifier: Apache-2.0
// An in-memory column of (subject, object) pairs of one predicate, sorted by subject: the part of an index "psog".
#pragma once

#include <atomic>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <span>

#include "sparql/exec/runtime.hpp"

namespace cluxel::sparql {

/// The contents of a column: the triples of a predicate, or those with one object, such as the instances of a class.
struct ColumnPattern {
  rdf::TermId predicate = rdf::kNoTerm;
  rdf::TermId object = rdf::kNoTerm;  ///< kNoTerm is a wildcard
};

/// A column at one commit. A lookup reads two or three cache lines shared with neighbouring subjects, whereas a page of
/// the index "spog" holds all triples of only about ten subjects.
class SubjectColumn {
 public:
  struct Row {
    rdf::TermId subject, object;
    auto operator<=>(const Row&) const = default;
  };

  /// Built from the quads in `graphs` without duplicates. Cost: about 25 ns per quad. Throws when the deadline of
  /// `guard` has passed.
  SubjectColumn(const rdf::QuadReader& reader, const ColumnPattern& pattern, const GraphFilter& graphs, Guard& guard);

  /// The rows of a subject, by ascending object; empty for an unknown id.
  std::span<const Row> find(rdf::TermId subject) const;
  /// The row with this subject and object; at most one.
  std::span<const Row> find(rdf::TermId subject, rdf::TermId object) const;
  /// Prefetches for find() of these subjects.
  void expect(std::span<const rdf::TermId> subjects) const;
  std::size_t rows() const { return row_count_; }
  std::size_t bytes() const { return row_count_ * sizeof(Row) + start_count_ * sizeof(std::uint32_t); }

 private:
  struct Release {
    void operator()(void* memory) const { std::free(memory); }
  };
  template <typename T>
  using Array = std::unique_ptr<T[], Release>;
  template <typename T>
  static Array<T> allocate(std::size_t count);

  /// The bucket of a subject within first_ to last_.
  std::size_t bucketOf(rdf::TermId subject) const { return static_cast<std::size_t>(subject - first_) >> shift_; }
  bool isWithin(rdf::TermId subject) const { return subject >= first_ && subject <= last_; }
  void layOut(rdf::TermId first, rdf::TermId last, std::size_t rows);
  void sortBuckets(Guard& guard);

  rdf::TermId first_ = 1, last_ = 0;  ///< the range of subjects
  unsigned shift_ = 0;                ///< a bucket covers 2^shift_ ids
  std::size_t row_count_ = 0, start_count_ = 0;
  Array<Row> rows_;              ///< sorted
  Array<std::uint32_t> starts_;  ///< start of each bucket in rows_, and the end
};

/// Builds a column once index lookups have cost about as much as building it, so that the total is at most about twice
/// the optimum. Shared by the readers of a commit; thread-safe.
class KeptColumn {
 public:
  KeptColumn(const ColumnPattern& pattern, std::uint64_t quads) : pattern_(pattern), quads_(quads) {}

  /// The column if it exists or if building it is justified after `lookups` more lookups; else null. `is_needed`: the
  /// plan expects it.
  const SubjectColumn* after(std::size_t lookups, bool is_needed, const rdf::QuadReader& reader,
                             const GraphFilter& graphs, Guard& guard) const;
  bool isMade() const { return column_.load(std::memory_order_acquire) != nullptr; }
  /// The approximate size in bytes, built or not.
  std::size_t bytes() const { return quads_ * (sizeof(SubjectColumn::Row) + sizeof(std::uint32_t) / 2); }

 private:
  ColumnPattern pattern_;
  std::uint64_t quads_;
  mutable std::mutex making_;
  mutable std::unique_ptr<const SubjectColumn> made_;
  mutable std::atomic<const SubjectColumn*> column_{nullptr};
  mutable std::atomic<std::uint64_t> lookups_{0};
};

/// True when columns can represent the dataset's default graph: all graphs, or all but one.
inline bool hasColumns(const GraphFilter& graphs) {
  return graphs.kind == GraphFilter::Kind::Any || graphs.kind == GraphFilter::Kind::AllBut;
}

/// The shared column state of a pattern at this commit. `graphs`: see hasColumns().
std::shared_ptr<const KeptColumn> keptColumn(const rdf::QuadReader& reader, const ColumnPattern& pattern,
                                             const GraphFilter& graphs);

}  // namespace cluxel::sparql
