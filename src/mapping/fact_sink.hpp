// SPDX-License-Identifier: Apache-2.0
// Collects the facts of one graph as ids and then writes only what differs from the stored graph.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "cluxel/knowledge/quad_store.hpp"

namespace cluxel {

/// "2.35": a number as xsd:decimal text, rounded to `digits` behind the point.
std::string decimalText(double value, int digits);

class FactSink {
 public:
  FactSink(QuadWriter& writer, std::string_view graph);

  TermId iri(std::string_view value) { return writer_.intern(Term::iri(value)); }
  /// The property `local` of the ontology, or a full IRI when it holds a ':'.
  TermId property(std::string_view name);

  void link(TermId subject, std::string_view property_name, TermId object);
  void type(TermId subject, std::string_view class_iri);
  void text(TermId subject, std::string_view property_name, std::string_view value);
  void literal(TermId subject, std::string_view property_name, std::string_view value, std::string_view datatype);
  /// A length, area or ratio, rounded to a thousandth.
  void number(TermId subject, std::string_view property_name, double value);
  void count(TermId subject, std::string_view property_name, std::uint64_t value);

  /// Makes the stored graph hold exactly the collected facts. `stored` reads the state before.
  void writeTo(const QuadReader& stored);
  std::size_t size() const { return facts_.size(); }

 private:
  QuadWriter& writer_;
  TermId graph_;
  std::unordered_map<std::string, TermId> properties_;
  std::vector<QuadIds> facts_;
};

}  // namespace cluxel
