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
  std::uint64_t left_out = 0;  ///< quads about primitives
};

/// All graphs but history, which is no part of the default graph either. A map with more than `max_quads` quads is held
/// without those about primitives, which are most of them: a page has little memory. The same quads give the same
/// bytes.
PackedQuads packedQuadsOf(const rdf::QuadReader& quads, std::uint64_t max_quads);

}  // namespace cluxel::tasks
