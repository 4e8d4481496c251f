// SPDX-License-Identifier: Apache-2.0
// What a write transaction has changed: the quads that it really added and removed, in order.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "rdf/file/check/store_sums.hpp"
#include "rdf/file/environment.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::rdf {

/// Keeps the changes of a write transaction. A transaction that changes much of the store, such as a build, is not
/// followed to its end.
class QuadJournal {
 public:
  struct Entry {
    QuadIds quad;
    bool is_added = false;
  };

  /// `quads`: how many the store holds.
  void begin(std::uint64_t quads) {
    entries_.clear();
    limit_ = kLeastLimit + quads / 2;
    is_complete_ = true;
  }
  bool isComplete() const { return is_complete_; }
  void note(const QuadIds& quad, bool is_added) {
    if (!is_complete_) return;
    entries_.push_back({quad, is_added});
    if (entries_.size() <= limit_) return;
    entries_ = {};
    is_complete_ = false;
  }
  const std::deque<Entry>& entries() const { return entries_; }

 private:
  static constexpr std::uint64_t kLeastLimit = 100'000;
  std::deque<Entry> entries_;  ///< a vector takes up to three times as much while it grows
  std::uint64_t limit_ = 0;
  bool is_complete_ = false;
};

/// What the transaction has changed since it began, or since restartJournal(). Absent when that was too much to follow.
std::optional<QuadDifference> changesOf(const WriteTransaction& transaction);
void restartJournal(const WriteTransaction& transaction);

/// The id of no graph.
inline constexpr TermId kNoGraph = ~TermId{0};
/// The number and a hash of all quads outside of a graph. Two states with the same sum hold the same quads there, as
/// far as a hash can tell. Cost: that of the quads in the graph. Expects that nothing is waiting for a flush.
EntrySum sumWithout(const WriteTransaction& transaction, TermId graph);
/// The same of the state before a change of the quads outside of the graph.
EntrySum sumBefore(EntrySum sum, const QuadDifference& change, TermId graph);

}  // namespace cluxel::rdf
