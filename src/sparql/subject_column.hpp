// SPDX-License-Identifier: Apache-2.0
// One predicate's objects by subject, side by side in memory: what an index "psog" would hold.
#pragma once

#include <atomic>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <span>

#include "sparql/runtime.hpp"

namespace cluxel::sparql {

/// What a column holds: the triples of a predicate, or those of them that have one object, such as the things of a
/// class.
struct ColumnPattern {
  TermId predicate = kNoTerm;
  TermId object = kNoTerm;  ///< kNoTerm: any
};

/// Such triples at one commit. A lookup reads two or three cache lines that it shares with its
/// neighbours, where the index "spog" has a page for some ten subjects with all that is said of them.
class SubjectColumn {
 public:
  struct Row {
    TermId subject, object;
    auto operator<=>(const Row&) const = default;
  };

  /// Of the quads in `graphs`, each triple once. Cost: some 25 ns a quad. Throws when the deadline of `guard` is over.
  SubjectColumn(const QuadReader& reader, const ColumnPattern& pattern, const GraphFilter& graphs, Guard& guard);

  /// The rows of a subject, by ascending object; none for an id that the store does not have.
  std::span<const Row> find(TermId subject) const;
  /// At most one.
  std::span<const Row> find(TermId subject, TermId object) const;
  /// Subjects that find() will be asked for soon: asks the memory for all of them together.
  void expect(std::span<const TermId> subjects) const;
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

  /// The bucket of a subject that is not outside first_ to last_.
  std::size_t bucketOf(TermId subject) const { return static_cast<std::size_t>(subject - first_) >> shift_; }
  bool isWithin(TermId subject) const { return subject >= first_ && subject <= last_; }
  void layOut(TermId first, TermId last, std::size_t rows);
  void sortBuckets(Guard& guard);

  TermId first_ = 1, last_ = 0;  ///< the least and the greatest subject
  unsigned shift_ = 0;           ///< a bucket holds the rows of 2^shift_ ids
  std::size_t row_count_ = 0, start_count_ = 0;
  Array<Row> rows_;              ///< ascending
  Array<std::uint32_t> starts_;  ///< where each bucket begins in rows_, and the end
};

/// A column that is made once lookups have cost about as much as making it does: never more than about twice the cost
/// of the better choice. Shared by the readers of a commit; thread-safe.
class KeptColumn {
 public:
  KeptColumn(const ColumnPattern& pattern, std::uint64_t quads) : pattern_(pattern), quads_(quads) {}

  /// The column if it is there or worth making now, after `lookups` more; else null. `wanted`: the plan counts on it.
  const SubjectColumn* after(std::size_t lookups, bool wanted, const QuadReader& reader, const GraphFilter& graphs,
                             Guard& guard) const;
  bool isMade() const { return column_.load(std::memory_order_acquire) != nullptr; }
  /// About the bytes that it takes, there or not.
  std::size_t bytes() const { return quads_ * (sizeof(SubjectColumn::Row) + sizeof(std::uint32_t) / 2); }

 private:
  ColumnPattern pattern_;
  std::uint64_t quads_;
  mutable std::mutex making_;
  mutable std::unique_ptr<const SubjectColumn> made_;
  mutable std::atomic<const SubjectColumn*> column_{nullptr};
  mutable std::atomic<std::uint64_t> lookups_{0};
};

/// True where columns hold what the default graph has of a predicate: of all graphs but one at most.
inline bool hasColumns(const GraphFilter& graphs) {
  return graphs.kind == GraphFilter::Kind::Any || graphs.kind == GraphFilter::Kind::AllBut;
}

/// The column, made or not, of a pattern; the same for all readers of the commit. `graphs`: see hasColumns().
std::shared_ptr<const KeptColumn> keptColumn(const QuadReader& reader, const ColumnPattern& pattern,
                                             const GraphFilter& graphs);

}  // namespace cluxel::sparql
