// SPDX-License-Identifier: Apache-2.0
// What the facts of primitives and objects followed from when they were written: a change computes them anew only where
// that differs.
#pragma once

#include <optional>
#include <vector>

#include "base/content_hash.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::mapping {

/// The facts about some resources that are computed together: those of a primitive, of an object with its parts and
/// observations, or all others.
struct FactUnit {
  ContentHash id;                     ///< of the primitive or object; zero: all others
  ContentHash cause;                  ///< hash of all that the facts follow from; zero: they are always compared
  std::vector<rdf::TermId> subjects;  ///< ascending
};

/// The units of a graph, ascending by id. Absent when they were not stored for the quads that the graph holds.
std::optional<std::vector<FactUnit>> storedFactUnits(const rdf::ReadTransaction& transaction,
                                                     const rdf::QuadReader& quads, rdf::TermId graph);
/// Stores the units of the graph; its quads must be flushed.
void storeFactUnits(rdf::WriteTransaction& transaction, const std::vector<FactUnit>& units,
                    const rdf::QuadReader& quads, rdf::TermId graph);

}  // namespace cluxel::mapping
