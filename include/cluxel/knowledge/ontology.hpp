// SPDX-License-Identifier: Apache-2.0
// The conceptual layer: loading ontologies, what follows from them, and a view of the classes for rules and
// displays.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cluxel/base/diagnostic.hpp"
#include "cluxel/knowledge/quad_store.hpp"
#include "cluxel/knowledge/rdf_io.hpp"

namespace cluxel {

enum class Mobility { Unknown, Static, Movable };

/// Where things of a class are usually found: near things of another class.
struct UsualPlace {
  std::string near_class;  ///< IRI
  double within_m = 0;
  double probability = 0;  ///< in [0, 1]
  auto operator<=>(const UsualPlace&) const = default;
};

/// One class of the ontology. All names are IRIs; lists are sorted and without repetition.
struct OntologyClass {
  std::string iri;
  std::map<std::string, std::string> labels;  ///< by language tag; "" for none
  std::string comment;                        ///< English
  std::string color;                          ///< "#rrggbb"; a class without one has its nearest superclass's, or ""
  Mobility mobility = Mobility::Unknown;      ///< inherited like the colour
  std::vector<std::string> superclasses;      ///< direct ones
  std::vector<std::string> ancestors;         ///< all classes above it, itself not among them
  std::vector<std::string> parts;             ///< classes its parts may have, its own and its ancestors'
  std::vector<UsualPlace> places;             ///< its own; most probable first

  /// The label in a language, else the English one, else the IRI's last part.
  std::string label(std::string_view language = "en") const;
};

/// A property with the unit of its numbers.
struct OntologyProperty {
  std::string iri, label, comment, unit;  ///< English; unit "" when it has none
};

/// The classes and properties of an ontology as values.
struct OntologyView {
  std::vector<OntologyClass> classes;        ///< sorted by IRI
  std::vector<OntologyProperty> properties;  ///< sorted by IRI

  const OntologyClass* find(std::string_view iri) const;
  /// True when `iri` is `ancestor` or below it.
  bool isA(std::string_view iri, std::string_view ancestor) const;
  std::vector<std::string> classNames() const;  ///< the IRIs, for "did you mean"
};

/// Reads the classes from a graph of the store, by default the ontology graph.
OntologyView ontologyViewOf(const QuadReader& reader, std::string_view graph = "");
/// The same from texts, without a store. InputError as loadOntology.
OntologyView ontologyViewOf(std::span<const RdfSource> sources);

/// Loads ontologies into the ontology graph, whatever graph the sources name. InputError with all faults:
/// syntax, cycles of subclasses, colours, mobilities, probabilities, places and parts of unknown classes.
/// After an error drop the transaction. Does not flush.
void loadOntology(std::span<const RdfSource> sources, QuadWriter& writer);

/// What follows from the quads of the source graphs and does not stand in them, sorted: rdfs:subClassOf and
/// rdfs:subPropertyOf with their transitivity, owl:inverseOf, owl:SymmetricProperty, owl:TransitiveProperty, and types
/// of superclasses; to the fixpoint. Not from rdfs:domain and rdfs:range: a wrong use shall stay a visible fault and
/// not become a type. The graph of the quads is `target`. Cost: in the quads of rdf:type and of properties that imply
/// something.
std::vector<QuadIds> closureOf(const QuadReader& reader, TermId target, std::span<const TermId> sources);

struct ClosureChange {
  std::uint64_t added = 0, removed = 0;  ///< quads
};
/// Makes graph inferred the closure of ontology, observed and operator: what stood there and does not follow goes.
/// Writes the differences only, and flushes.
ClosureChange inferClosure(WriteTransaction& transaction);
/// Adds to graph inferred what follows from ontology, observed, operator and inferred itself, which keeps the facts
/// that rules have put there. Flushes.
ClosureChange extendClosure(WriteTransaction& transaction);

}  // namespace cluxel
