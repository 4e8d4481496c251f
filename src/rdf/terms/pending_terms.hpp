// SPDX-License-Identifier: Apache-2.0
// Terms of a writer before the flush: their records, and a hash table from record to id.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "rdf/store/quad_store.hpp"
#include "rdf/terms/term_record.hpp"

namespace cluxel::rdf {

/// Open-addressing hash table from term records to ids, for existing and new terms; the records lie in one arena.
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
  std::vector<std::uint32_t> slots_;  ///< index of the entry + 1, or 0 for a free slot; the size is a power of two
};

}  // namespace cluxel::rdf
