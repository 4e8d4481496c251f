// SPDX-License-Identifier: Apache-2.0
// Collects the facts of one graph as ids, then writes only the difference from the stored graph. Facts that follow from
// what they followed from before are neither computed nor compared.
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "mapping/facts/fact_units.hpp"
#include "rdf/store/quad_store.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

/// A number as xsd:decimal text ("2.35"), rounded to `digits` decimal places.
std::string decimalText(double value, int digits);

/// Which facts a sink is given.
enum class FactsOf : std::uint8_t {
  TheGraph,   ///< all: what is not given is removed
  SomeUnits,  ///< those of units that are begun; others stay as they are, and are not read
  Collected,  ///< those that the caller wants, and writes: all units are asked for
};

/// What a sink changed, ascending.
using FactChange = rdf::QuadDifference;

class FactSink {
 public:
  /// SomeUnits asks for a graph with units (haveFactUnits()); throws std::logic_error otherwise.
  FactSink(rdf::WriteTransaction& transaction, std::string_view graph, FactsOf facts_of = FactsOf::TheGraph);

  /// Facts outside of a unit are about subjects of the units of this id, too. When some units are given, those to which
  /// such facts were or are added must be begun or removed with replaceOthers(), and not without.
  void addToUnits(const ContentHash& id) { added_to_.insert(id); }
  /// Begins the facts of a unit; `cause` is a hash of all that they follow from. False when the stored graph has them:
  /// then none must be given. Only facts of the unit may be of its facet about its subjects, but for addToUnits().
  bool beginUnit(const FactUnitKey& key, const ContentHash& cause);
  void endUnit();
  /// The graph must not have the facts of this unit.
  void removeUnit(const FactUnitKey& key);
  /// Of some units: facts outside of units are given as well.
  void replaceOthers() { replaces_others_ = true; }

  rdf::TermId iri(std::string_view value) { return writer_.intern(Term::iri(value)); }
  /// The property `local` of the ontology, or a full IRI when it holds a ':'.
  rdf::TermId property(std::string_view name);

  void link(rdf::TermId subject, std::string_view property_name, rdf::TermId object);
  void type(rdf::TermId subject, std::string_view class_iri);
  void text(rdf::TermId subject, std::string_view property_name, std::string_view value);
  void literal(rdf::TermId subject, std::string_view property_name, std::string_view value, std::string_view datatype);
  void term(rdf::TermId subject, std::string_view property_name, const Term& value);
  /// A length [m], area [m2] or ratio, rounded to 0.001.
  void number(rdf::TermId subject, std::string_view property_name, double value);
  void count(rdf::TermId subject, std::string_view property_name, std::uint64_t value);

  /// Sorts the facts of units that were given so far, which is left out later. No unit may be begun.
  void sortSoFar();
  /// Makes the stored graph and its units equal to what was given and what is kept. The sink is spent afterwards.
  FactChange finish();
  /// The facts of a sink that only collects them. Their terms wait for a flush of the writer.
  std::vector<rdf::QuadIds> take();
  rdf::QuadWriter& writer() { return writer_; }

 private:
  void removeThoseNotAsked();
  void takeOthers();
  std::vector<rdf::QuadIds> storedToCompare(const rdf::QuadReader& stored) const;
  std::vector<rdf::QuadIds> takeSorted();
  FactChange writeDifference();

  rdf::WriteTransaction& transaction_;
  rdf::QuadWriter writer_;
  rdf::TermId graph_;
  bool is_collecting_, is_whole_, has_units_, replaces_others_;
  /// Finds a name without a copy of it.
  struct NameHash : std::hash<std::string_view> {
    using is_transparent = void;
  };
  std::unordered_map<std::string, rdf::TermId, NameHash, std::equal_to<>> properties_;
  Term decimal_ = Term::literal("", rdf::vocabulary::xsd("decimal"));  ///< the number at hand
  std::vector<rdf::QuadIds> of_units_, others_;
  std::size_t unit_begin_ = 0;  ///< in of_units_
  std::size_t sorted_ = 0;      ///< of of_units_, from its begin
  bool in_unit_ = false;
  std::set<FactUnitKey> asked_;
  std::vector<FactUnit> units_;       ///< to be stored
  std::vector<FactUnit> replaced_;    ///< stored units of which the facts are compared
  std::vector<FactUnitKey> removed_;  ///< stored units that are gone
  std::set<ContentHash> added_to_;
};

}  // namespace cluxel::mapping
