// SPDX-License-Identifier: Apache-2.0
// The conceptual layer: loads ontologies, computes their closure, and gives a view of the classes for rules and user
// interfaces.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cluxel/error.hpp"
#include "rdf/io/rdf_io.hpp"
#include "rdf/ontology/class_labels.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::rdf {

enum class Mobility { Unknown, Static, Movable };

/// A usual place of a class: near objects of another class.
struct UsualPlace {
  std::string near_class;  ///< IRI
  double within_m = 0;
  double probability = 0;  ///< in [0, 1]
  auto operator<=>(const UsualPlace&) const = default;
};

/// One class of the ontology. All names are IRIs; lists are sorted and have no duplicates.
struct OntologyClass {
  std::string iri;
  std::vector<ClassLabel> labels;         ///< all of them name the class
  std::string comment;                    ///< English
  std::string color;                      ///< "#rrggbb", inherited from the nearest superclass, or ""
  Mobility mobility = Mobility::Unknown;  ///< inherited as the colour is
  std::vector<std::string> superclasses;  ///< direct ones
  std::vector<std::string> ancestors;     ///< all superclasses, without the class itself
  std::vector<std::string> parts;         ///< classes of its parts, including those inherited from ancestors
  std::vector<UsualPlace> places;         ///< not inherited; most probable first

  /// The label that is shown in a language, else in English, else without a language, else the local name of the IRI,
  /// else the IRI ("http://e/tree/"). Of several the preferred one, then the first by the bytes of its text.
  std::string label(std::string_view language = "en") const;
};

/// A property and the unit of its values.
struct OntologyProperty {
  std::string iri, label, comment, unit;  ///< texts are English; unit is "" when there is none
};

/// The classes and properties of an ontology as values.
struct OntologyView {
  std::vector<OntologyClass> classes;        ///< sorted by IRI
  std::vector<OntologyProperty> properties;  ///< sorted by IRI

  const OntologyClass* find(std::string_view iri) const;
  /// True when `iri` is `ancestor` or a subclass of it.
  bool isA(std::string_view iri, std::string_view ancestor) const;
  std::vector<std::string> classNames() const;  ///< the IRIs, for "did you mean"
};

/// The IRIs of the classes that a graph declares, by default the ontology graph; sorted.
std::vector<std::string> classIrisOf(const QuadReader& reader, std::string_view graph = "");

/// Reads the classes from a graph of the store, by default the ontology graph.
OntologyView ontologyViewOf(const QuadReader& reader, std::string_view graph = "");
/// Reads the classes from texts, without a store. Throws InputError as loadOntology() does.
OntologyView ontologyViewOf(std::span<const RdfSource> sources);

/// Loads ontologies into the ontology graph, whatever graph the sources name. Throws one InputError with all faults:
/// syntax, subclass cycles, malformed colours, mobilities and probabilities, places and parts of unknown classes. After
/// an error the transaction must be dropped. Does not flush.
/// A map holds the texts of its ontology, so that what an earlier version took is taken here as well.
void loadOntology(std::span<const RdfSource> sources, QuadWriter& writer);

/// Throws one InputError with all faults for which an ontology is refused when it is read from files: those of
/// loadOntology(), superclasses that are defined nowhere, unknown properties of the vocabulary, two values where one is
/// meant, and usual places that lack a distance or a probability or are too probable together.
void checkOntology(std::span<const RdfSource> sources);

/// The limits of an inference by whoever asked for it; none when it is empty.
struct InferenceCheck {
  /// Called every few thousand steps with the memory that the inference holds. What it throws ends the inference.
  std::function<void(std::size_t bytes)> held = {};
  std::uint64_t max_memory_bytes = 0;  ///< of the queries of rules; 0: unlimited

  explicit operator bool() const { return static_cast<bool>(held); }
  void operator()(std::size_t bytes) const { held(bytes); }
};

/// How far a closure may go. A transitive property can make as many facts as there are pairs of things.
struct ClosureLimits {
  std::uint64_t max_facts = 0;  ///< derived
  std::uint64_t max_steps = 0;  ///< facts and edges looked at
  InferenceCheck check = {};
  /// Five million facts and four for each quad of the store; 200 million steps and 100 for each quad.
  static ClosureLimits of(const QuadReader& reader);
};

struct EntailedQuads {
  std::vector<QuadIds> quads;        ///< sorted
  std::vector<std::string> ignored;  ///< axioms about reserved properties, as N-Triples without the full stop; sorted
};

/// The quads entailed by the source graphs and not contained in them, with graph `target`. Rules, to a
/// fixpoint: rdfs:subClassOf and rdfs:subPropertyOf with their transitivity, rdf:type of superclasses, owl:inverseOf,
/// owl:SymmetricProperty, owl:TransitiveProperty. rdfs:domain and rdfs:range are left out, so that a misused property
/// remains visible as a fault instead of becoming a type. Axioms that name rdf:type, rdfs:subClassOf,
/// rdfs:subPropertyOf or owl:inverseOf as subject or object are ignored: they would turn facts into schema. Cost:
/// linear in the quads of rdf:type and of properties with implications. Throws Error (BudgetExceeded) beyond the
/// limits.
///
/// `fresh`, when not empty: quads of the source graphs without which these were closed. Unless one of them is an axiom,
/// only what follows from them is looked for, and the cost is that of the axioms, of `fresh` and what follows, and of
/// the transitive properties among them.
EntailedQuads closureOf(const QuadReader& reader, TermId target, std::span<const TermId> sources,
                        const ClosureLimits& limits, std::span<const QuadIds> fresh = {});

struct ClosureChange {
  std::uint64_t added = 0, removed = 0;   ///< quads
  std::vector<std::string> ignored = {};  ///< as in EntailedQuads
  std::vector<QuadIds> extension = {};    ///< of extendClosure(): the added quads
};
/// Replaces the graph `inferred` by the closure of ontology, observed and operator. Writes only the differences, and
/// flushes.
ClosureChange inferClosure(WriteTransaction& transaction, const InferenceCheck& check = {});
/// Adds to the graph `inferred` the closure of ontology, observed, operator and inferred itself, and keeps the facts
/// that rules have written there. `fresh`: what was added since these graphs were closed; empty: not known. Flushes.
ClosureChange extendClosure(WriteTransaction& transaction, std::span<const QuadIds> fresh = {},
                            const InferenceCheck& check = {});

}  // namespace cluxel::rdf
