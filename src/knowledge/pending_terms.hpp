// SPDX-License-Identifier: Apache-2.0
// New terms of a writer before they are flushed: their records, and a table from record to id.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "cluxel/knowledge/quad_store.hpp"
#include "knowledge/term_record.hpp"

namespace cluxel {

/// Records seen by a writer with their ids, old and new, in an open-addressed hash table over one arena of
/// bytes.
class PendingTerms {
 public:
  struct Entry {
    TermHash hash;
    TermId id = kNoTerm;
    std::size_t offset = 0, size = 0;  ///< of the record in the arena
    bool is_new = false;
  };

  std::optional<TermId> find(const TermHash& hash, std::string_view record) const;
  void insert(const TermHash& hash, std::string_view record, TermId id, bool is_new);
  std::string_view record(const Entry& entry) const { return {arena_.data() + entry.offset, entry.size}; }
  const std::vector<Entry>& entries() const { return entries_; }  ///< in the order of insertion
  std::size_t bytes() const { return arena_.size() + entries_.size() * sizeof(Entry); }
  void clear();

 private:
  void grow();
  std::vector<char> arena_;
  std::vector<Entry> entries_;
  std::vector<std::uint32_t> slots_;  ///< number of the entry + 1; 0: free. A power of two of them
};

}  // namespace cluxel
