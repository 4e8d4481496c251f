// SPDX-License-Identifier: Apache-2.0
// Collects the facts of one graph as ids, then writes only the difference from the stored graph.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "rdf/store/quad_store.hpp"

namespace cluxel::mapping {

/// A number as xsd:decimal text ("2.35"), rounded to `digits` decimal places.
std::string decimalText(double value, int digits);

class FactSink {
 public:
  FactSink(rdf::QuadWriter& writer, std::string_view graph);

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

  /// Makes the stored graph equal to the collected facts. `stored` reads the state before.
  void writeTo(const rdf::QuadReader& stored);
  std::size_t size() const { return facts_.size(); }

 private:
  rdf::QuadWriter& writer_;
  rdf::TermId graph_;
  std::unordered_map<std::string, rdf::TermId> properties_;
  std::vector<rdf::QuadIds> facts_;
};

}  // namespace cluxel::mapping
