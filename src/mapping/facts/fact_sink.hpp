// SPDX-License-Identifier: Apache-2.0
// Collects the facts of one graph as ids, then writes only the difference from the stored graph. Facts that follow from
// what they followed from before are neither computed nor compared.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "mapping/facts/fact_units.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::mapping {

/// A number as xsd:decimal text ("2.35"), rounded to `digits` decimal places.
std::string decimalText(double value, int digits);

class FactSink {
 public:
  /// `known`: the units of the stored graph. Without them all facts are computed and compared.
  FactSink(rdf::QuadWriter& writer, rdf::TermId graph, std::optional<std::vector<FactUnit>> known = std::nullopt);

  /// Facts outside of a unit are about subjects of the unit, too.
  void addToUnit(const ContentHash& unit) { added_to_.insert(unit); }
  /// Begins the facts of a unit; `cause` is a hash of all that they follow from. False when the stored graph has them:
  /// then none must be given. Only facts of the unit may be about its subjects, but for addToUnit().
  bool beginUnit(const ContentHash& unit, const ContentHash& cause);
  void endUnit();

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

  /// Makes the stored graph equal to the collected facts and those that it keeps. `stored` reads the state before.
  /// Returns the units, ascending by id. The collection is spent afterwards.
  std::vector<FactUnit> writeTo(const rdf::QuadReader& stored);

 private:
  std::vector<rdf::QuadIds> storedToCompare(const rdf::QuadReader& stored) const;

  rdf::QuadWriter& writer_;
  rdf::TermId graph_;
  std::unordered_map<std::string, rdf::TermId> properties_;
  std::vector<rdf::QuadIds> of_units_, others_;
  std::size_t unit_begin_ = 0;  ///< in of_units_
  bool in_unit_ = false;
  std::optional<std::vector<FactUnit>> known_;
  std::vector<bool> is_kept_;  ///< by number in known_
  std::vector<FactUnit> units_;
  std::set<ContentHash> added_to_;
};

}  // namespace cluxel::mapping
