// SPDX-License-Identifier: Apache-2.0
// The axioms of an ontology in the form in which facts are derived from them.
#pragma once

#include <array>
#include <compare>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "rdf/ontology/closure_bounds.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::rdf {

/// The ids of the vocabulary terms used by the rules; 0 when the store does not contain the term.
struct SchemaWords {
  TermId type = 0, sub_class = 0, sub_property = 0, inverse = 0, symmetric = 0, transitive = 0;

  explicit SchemaWords(const QuadReader& reader);
  /// A property by which the rules themselves work. An axiom about it would turn every fact into schema.
  bool isReserved(TermId property) const;
  /// Whether a fact is an axiom.
  bool isAxiom(TermId property, TermId object) const;
};

/// A property implied by another one.
struct Implied {
  TermId property = 0;
  bool inverted = false;     ///< subject and object are swapped
  bool via_inverse = false;  ///< an intermediate step swapped them, so literals are excluded: they cannot be subjects
  auto operator<=>(const Implied&) const = default;
};

using Edges = std::map<TermId, std::set<TermId>>;

/// All nodes reachable from a node along a property.
std::set<TermId> reachableFrom(TermId node, const Edges& edges, TermId property, ClosureBounds& bounds);

struct Schema {
  std::map<TermId, std::set<Implied>> implications;  ///< the implied properties of each property
  std::set<TermId> transitive;
  Edges ancestors;                          ///< of each class
  std::set<std::array<TermId, 3>> ignored;  ///< axioms about reserved properties: subject, predicate, object
  bool operator==(const Schema&) const = default;
};

using PairVisit = std::function<void(TermId subject, TermId object)>;
/// Visits the facts of a property, or those of one object when that is not kNoTerm.
using FactScan = std::function<void(TermId property, TermId object, const PairVisit& visit)>;

Schema readSchema(const QuadReader& reader, const SchemaWords& words, const FactScan& scan, ClosureBounds& bounds);

/// The ignored axioms as N-Triples without the full stop; sorted.
std::vector<std::string> ignoredAxioms(const QuadReader& reader, const Schema& schema);

}  // namespace cluxel::rdf
