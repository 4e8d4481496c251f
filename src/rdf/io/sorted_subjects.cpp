// SPDX-License-Identifier: Apache-2.0
// A record is a key and, behind it, the id of the subject.
#include "rdf/io/sorted_subjects.hpp"

#include <cstring>

#include "base/sorting/sorted_records.hpp"

namespace cluxel::rdf {

SortedSubjects::SortedSubjects(const QuadReader& reader, std::optional<TermId> graph)
    : reader_(reader),
      graph_(graph),
      order_(graph ? QuadOrder::Gspo : QuadOrder::Spog),
      quads_(reader.lookup(order_)) {}

void SortedSubjects::forEach(const AppendKey& append_key, const Visit& visit, std::size_t sort_bytes) const {
  SortedRecords records(sort_bytes);
  std::string record;
  QuadPattern pattern;
  pattern.g = graph_;
  QuadCursor cursor = reader_.scan(pattern, order_);
  TermId last = kNoTerm;
  for (auto keys = cursor.nextBlock(); !keys.empty(); keys = cursor.nextBlock())
    for (const QuadKey& key : keys) {
      const TermId subject = key.at(graph_ ? 1 : 0);
      if (subject == last) continue;
      last = subject;
      record.clear();
      append_key(record, subject);
      record.append(reinterpret_cast<const char*>(&subject), sizeof subject);
      records.add(record);
    }
  records.drain([&](std::string_view sorted) {
    TermId subject = kNoTerm;
    const std::string_view key = sorted.substr(0, sorted.size() - sizeof subject);
    std::memcpy(&subject, sorted.data() + key.size(), sizeof subject);
    visit(key, subject);
  });
}

}  // namespace cluxel::rdf
