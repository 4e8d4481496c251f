// SPDX-License-Identifier: Apache-2.0
// The first entry of a quad tells whether it was there before, the last one whether it is there now.
#include "rdf/store/quad_journal.hpp"

#include <algorithm>
#include <vector>

#include "rdf/file/lmdb_environment.hpp"
#include "rdf/store/quad_reader_impl.hpp"

namespace cluxel::rdf {

std::optional<QuadDifference> changesOf(const WriteTransaction& transaction) {
  const QuadJournal& journal = transaction.impl().journal;
  if (!journal.isComplete()) return std::nullopt;
  std::vector<QuadJournal::Entry> entries(journal.entries().begin(), journal.entries().end());
  std::stable_sort(entries.begin(), entries.end(), [](const auto& a, const auto& b) { return a.quad < b.quad; });
  QuadDifference difference;
  for (std::size_t first = 0; first < entries.size();) {
    std::size_t last = first;
    while (last + 1 < entries.size() && entries[last + 1].quad == entries[first].quad) ++last;
    if (entries[first].is_added == entries[last].is_added)
      (entries[first].is_added ? difference.added : difference.removed).push_back(entries[first].quad);
    first = last + 1;
  }
  return difference;
}

void restartJournal(const WriteTransaction& transaction) {
  transaction.impl().journal.begin(transaction.impl().sums.quads.count);
}

EntrySum sumWithout(const WriteTransaction& transaction, TermId graph) {
  EntrySum sum = transaction.impl().sums.quads;
  const QuadReader reader(static_cast<const ReadTransaction&>(transaction));
  QuadCursor cursor = reader.scan({.s = {}, .p = {}, .o = {}, .g = graph}, QuadOrder::Gspo);
  for (QuadIds quad; cursor.next(quad);) sum.remove(toNumber(quad, QuadOrder::Spog));
  return sum;
}

EntrySum sumBefore(EntrySum sum, const QuadDifference& change, TermId graph) {
  for (const QuadIds& quad : change.added)
    if (quad.g != graph) sum.remove(toNumber(quad, QuadOrder::Spog));
  for (const QuadIds& quad : change.removed)
    if (quad.g != graph) sum.add(toNumber(quad, QuadOrder::Spog));
  return sum;
}

}  // namespace cluxel::rdf
