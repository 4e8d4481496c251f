// SPDX-License-Identifier: Apache-2.0
// The quads of a map as few bytes, for a SPARQL engine in a page.
#pragma once

#include <cstdint>
#include <string>

#include "rdf/store/quad_store.hpp"

namespace cluxel::tasks {

struct PackedQuads {
  /// The distinct terms as N-Triples, sorted, one a line. A term's number is its line, from 0. A graph without a name
  /// is an empty line.
  std::string terms;
  /// Per graph: its term, the number of its quads, then the quads sorted by subject, predicate, object: how far the
  /// subject's number is above the one before, then the numbers of predicate and object. All numbers are LEB128.
  std::string quads;
  std::uint64_t quad_count = 0;
};

/// All graphs but history, which is no part of the default graph either. The same quads give the same bytes.
PackedQuads packedQuadsOf(const rdf::QuadReader& quads);

}  // namespace cluxel::tasks
