// SPDX-License-Identifier: Apache-2.0
// The subjects of a store in an order of their own, each with its quads: an index holds the quads of a subject
// together, so that only one subject's quads have to be sorted at a time.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "rdf/store/quad_store.hpp"

namespace cluxel::rdf {

/// Visits subjects in the bytewise order of keys. No key is the beginning of another subject's key.
class SortedSubjects {
 public:
  using AppendKey = std::function<void(std::string& key, TermId subject)>;
  using Visit = std::function<void(std::string_view key, TermId subject)>;

  /// Of all graphs, or of `graph` alone.
  SortedSubjects(const QuadReader& reader, std::optional<TermId> graph);

  /// Sorts with a SortedRecords of `sort_bytes`.
  void forEach(const AppendKey& append_key, const Visit& visit, std::size_t sort_bytes) const;

  /// The quads of a subject, in the order of their ids.
  template <typename Take>
  void forEachQuadOf(TermId subject, const Take& take) {
    const std::array<TermId, 2> in_graph{graph_.value_or(kNoTerm), subject};
    const std::span<const TermId> prefix(in_graph);
    for (auto keys = quads_.find(graph_ ? prefix : prefix.last(1)); !keys.empty(); keys = quads_.more())
      for (const QuadKey& key : keys) take(toQuad(key, order_));
  }

 private:
  const QuadReader& reader_;
  std::optional<TermId> graph_;
  QuadOrder order_;
  PrefixLookup quads_;
};

}  // namespace cluxel::rdf
