// SPDX-License-Identifier: Apache-2.0
// Facts are ids; the graph is updated by the difference of two sorted lists.
#include "mapping/facts/fact_sink.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

std::string decimalText(double value, int digits) {
  char buffer[512];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::fixed, digits).ptr;
  std::string text(buffer, end);
  if (text.find('.') == std::string::npos) text += ".0";
  while (text.back() == '0' && text[text.size() - 2] != '.') text.pop_back();
  return text == "-0.0" ? "0.0" : text;
}

FactSink::FactSink(rdf::QuadWriter& writer, std::string_view graph)
    : writer_(writer), graph_(writer.intern(Term::iri(graph))) {}

rdf::TermId FactSink::property(std::string_view name) {
  const auto [place, is_new] = properties_.try_emplace(std::string(name), rdf::kNoTerm);
  if (is_new) {
    const bool is_full = name.find(':') != std::string_view::npos;
    place->second = iri(is_full ? std::string(name) : rdf::vocabulary::clx(name));
  }
  return place->second;
}

void FactSink::link(rdf::TermId subject, std::string_view property_name, rdf::TermId object) {
  facts_.push_back({subject, property(property_name), object, graph_});
}

void FactSink::type(rdf::TermId subject, std::string_view class_iri) {
  link(subject, rdf::vocabulary::rdf("type"), iri(class_iri));
}

void FactSink::text(rdf::TermId subject, std::string_view property_name, std::string_view value) {
  link(subject, property_name, writer_.intern(Term::literal(value)));
}

void FactSink::literal(rdf::TermId subject, std::string_view property_name, std::string_view value,
                       std::string_view datatype) {
  link(subject, property_name, writer_.intern(Term::literal(value, datatype)));
}

void FactSink::term(rdf::TermId subject, std::string_view property_name, const Term& value) {
  link(subject, property_name, writer_.intern(value));
}

void FactSink::number(rdf::TermId subject, std::string_view property_name, double value) {
  literal(subject, property_name, decimalText(value, 3), rdf::vocabulary::xsd("decimal"));
}

void FactSink::count(rdf::TermId subject, std::string_view property_name, std::uint64_t value) {
  link(subject, property_name, writer_.intern(Term::integer(static_cast<std::int64_t>(value))));
}

void FactSink::writeTo(const rdf::QuadReader& stored) {
  std::sort(facts_.begin(), facts_.end());
  facts_.erase(std::unique(facts_.begin(), facts_.end()), facts_.end());
  std::vector<rdf::QuadIds> old, gone, fresh;
  rdf::QuadPattern pattern;
  pattern.g = graph_;
  rdf::QuadCursor cursor = stored.scan(pattern);
  for (rdf::QuadIds quad; cursor.next(quad);) old.push_back(quad);
  std::sort(old.begin(), old.end());
  std::set_difference(old.begin(), old.end(), facts_.begin(), facts_.end(), std::back_inserter(gone));
  std::set_difference(facts_.begin(), facts_.end(), old.begin(), old.end(), std::back_inserter(fresh));
  for (const rdf::QuadIds& quad : gone) writer_.remove(quad);
  for (const rdf::QuadIds& quad : fresh) writer_.add(quad);
}

}  // namespace cluxel::mapping
