// SPDX-License-Identifier: Apache-2.0
// Quads with literals in the order of index ospg, which lacks them. Their values are spread over the whole index, so
// that each of them would cost a page of its own whenever a part of the map changes.
#pragma once

#include <optional>
#include <vector>

#include "rdf/file/page_directory.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::rdf {

/// Collects entries from the indexes posg and spog.
class LiteralEntries {
 public:
  explicit LiteralEntries(ReadTransaction transaction) : transaction_(std::move(transaction)) {}

  bool isLiteral(TermId id) const;  ///< false for unknown terms
  /// Whether index ospg lacks quads with this object; any object may be a literal.
  bool mayMatch(const std::optional<TermId>& object) const;
  /// All quads that the bound positions admit, also those without literals, as ascending keys of ospg. Cost: of a
  /// literal without a subject, a search for each predicate of the map; of a subject, all of its quads; without both,
  /// all quads of the map.
  std::vector<QuadKey> of(const QuadPattern& pattern) const;
  /// The number of quads with this literal, at the cost of a search for each predicate.
  std::uint64_t count(TermId literal) const;

 private:
  ReadTransaction transaction_;
};

}  // namespace cluxel::rdf
