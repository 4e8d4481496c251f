// SPDX-License-Identifier: Apache-2.0
// Quads with literals in the order of index ospg, which lacks them. Their values are spread over the whole index, so
// that each of them would cost a page of its own whenever a part of the map changes.
#pragma once

#include <optional>
#include <vector>

#include "rdf/file/page_directory.hpp"
#include "rdf/store/number_entries.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::rdf {

/// Collects entries from the indexes posg, psog and spog.
class LiteralEntries {
 public:
  explicit LiteralEntries(const ReadTransaction& transaction) : transaction_(transaction), numbers_(transaction) {}

  bool isLiteral(TermId id) const { return numbers_.kindOf(id) != ObjectKind::Link; }  ///< false for unknown terms
  /// Whether index ospg lacks quads with this object; any object may be a literal.
  bool mayMatch(const std::optional<TermId>& object) const;
  /// All quads that the bound positions admit, also those without literals, as ascending keys of ospg. Cost: of a
  /// literal without a subject, a search for each predicate of the map, and for the first number in a commit all quads
  /// with numbers are ordered; of a subject, all of its quads; without both, all quads of the map.
  std::vector<QuadKey> of(const QuadPattern& pattern) const;
  /// The number of quads with this literal in index posg, at the cost of a search for each predicate.
  std::uint64_t count(TermId literal) const;

 private:
  ReadTransaction transaction_;
  NumberEntries numbers_;
};

}  // namespace cluxel::rdf
