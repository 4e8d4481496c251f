// SPDX-License-Identifier: Apache-2.0
// The hash table of a writer's terms.
#include "rdf/terms/pending_terms.hpp"

namespace cluxel::rdf {

std::optional<TermId> PendingTerms::find(const TermHash& hash, std::string_view bytes) const {
  if (slots_.empty()) return std::nullopt;
  for (std::size_t i = hash.high & (slots_.size() - 1); slots_[i] != 0; i = (i + 1) & (slots_.size() - 1)) {
    const Entry& entry = entries_[slots_[i] - 1];
    if (entry.hash == hash && record(entry) == bytes) return entry.id;
  }
  return std::nullopt;
}

void PendingTerms::insert(const TermHash& hash, std::string_view record, TermId id, bool is_new) {
  if ((entries_.size() + 1) * 2 > slots_.size()) grow();
  const std::size_t offset = arena_.size();
  arena_.insert(arena_.end(), record.begin(), record.end());
  entries_.push_back({hash, id, offset, record.size(), is_new});
  std::size_t i = hash.high & (slots_.size() - 1);
  while (slots_[i] != 0) i = (i + 1) & (slots_.size() - 1);
  slots_[i] = static_cast<std::uint32_t>(entries_.size());
}

void PendingTerms::clear() {
  arena_.clear();
  entries_.clear();
  slots_.clear();
}

void PendingTerms::grow() {
  const std::size_t size = slots_.empty() ? 256 : slots_.size() * 2;
  slots_.assign(size, 0);
  for (std::size_t number = 0; number < entries_.size(); ++number) {
    std::size_t i = entries_[number].hash.high & (size - 1);
    while (slots_[i] != 0) i = (i + 1) & (size - 1);
    slots_[i] = static_cast<std::uint32_t>(number + 1);
  }
}

}  // namespace cluxel::rdf
