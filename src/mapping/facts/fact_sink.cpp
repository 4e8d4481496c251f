// SPDX-License-Identifier: Apache-2.0
// Facts are ids; the graph is updated by the difference of two sorted lists.
#include "mapping/facts/fact_sink.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <span>
#include <stdexcept>

#include "perception/segments/scene.hpp"
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

namespace {

std::vector<rdf::TermId> subjectsOf(std::span<const rdf::QuadIds> facts) {
  std::vector<rdf::TermId> subjects;
  for (const rdf::QuadIds& fact : facts)
    if (subjects.empty() || subjects.back() != fact.s) subjects.push_back(fact.s);
  std::sort(subjects.begin(), subjects.end());
  subjects.erase(std::unique(subjects.begin(), subjects.end()), subjects.end());
  return subjects;
}

rdf::QuadReader readerOf(const rdf::WriteTransaction& transaction) {
  return rdf::QuadReader(static_cast<const rdf::ReadTransaction&>(transaction));
}

unsigned bitOf(Facet facet) {
  return 1U << static_cast<unsigned>(facet);
}

/// The facets of which a unit has facts, one bit each.
unsigned facetsOf(const FactUnitKey& key) {
  return key == FactUnitKey{} ? bitOf(Facet::Self) | bitOf(Facet::Relations) : bitOf(key.facet);
}

/// The relations that the store has terms for.
std::vector<rdf::TermId> relationTerms(const rdf::QuadReader& quads) {
  std::vector<rdf::TermId> terms;
  for (const perception::RelationInfo& info : perception::relationInfos())
    if (const auto term = quads.idOf(Term::iri(rdf::vocabulary::clx(info.property)))) terms.push_back(*term);
  return terms;
}

}  // namespace

FactSink::FactSink(rdf::WriteTransaction& transaction, std::string_view graph, FactsOf facts_of)
    : transaction_(transaction),
      writer_(transaction),
      graph_(writer_.intern(Term::iri(graph))),
      is_collecting_(facts_of == FactsOf::Collected),
      is_whole_(facts_of == FactsOf::TheGraph),
      has_units_(facts_of != FactsOf::Collected && haveFactUnits(transaction, readerOf(transaction), graph_)),
      replaces_others_(is_whole_) {
  if (facts_of == FactsOf::SomeUnits && !has_units_)
    throw std::logic_error("the graph has no units of which some could be replaced");
}

bool FactSink::beginUnit(const FactUnitKey& key, const ContentHash& cause) {
  asked_.insert(key);
  const ContentHash believed = added_to_.contains(key.id) ? ContentHash{} : cause;
  if (has_units_)
    if (auto stored = storedFactUnit(transaction_, key)) {
      if (!believed.isZero() && stored->cause == believed) return false;
      replaced_.push_back(*std::move(stored));
    }
  units_.push_back({key, believed, {}});
  unit_begin_ = of_units_.size();
  return in_unit_ = true;
}

void FactSink::endUnit() {
  units_.back().subjects = subjectsOf(std::span(of_units_).subspan(unit_begin_));
  in_unit_ = false;
}

void FactSink::removeUnit(const FactUnitKey& key) {
  if (is_collecting_) return;
  asked_.insert(key);
  auto stored = storedFactUnit(transaction_, key);
  if (!stored) return;
  replaced_.push_back(*std::move(stored));
  removed_.push_back(key);
}

rdf::TermId FactSink::property(std::string_view name) {
  if (const auto known = properties_.find(name); known != properties_.end()) return known->second;
  const bool is_full = name.find(':') != std::string_view::npos;
  const rdf::TermId id = iri(is_full ? std::string(name) : rdf::vocabulary::clx(name));
  properties_.emplace(name, id);
  return id;
}

void FactSink::link(rdf::TermId subject, std::string_view property_name, rdf::TermId object) {
  (in_unit_ ? of_units_ : others_).push_back({subject, property(property_name), object, graph_});
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
  decimal_.text = decimalText(value, 3);
  link(subject, property_name, writer_.intern(decimal_));
}

void FactSink::count(rdf::TermId subject, std::string_view property_name, std::uint64_t value) {
  link(subject, property_name, writer_.intern(Term::integer(static_cast<std::int64_t>(value))));
}

void FactSink::removeThoseNotAsked() {
  for (const FactUnitKey& key : storedFactUnitKeys(transaction_))
    if (!asked_.contains(key) && key != FactUnitKey{}) removeUnit(key);
}

void FactSink::takeOthers() {
  if (auto stored = storedFactUnit(transaction_, {})) replaced_.push_back(*std::move(stored));
  units_.push_back({{}, {}, subjectsOf(others_)});
}

/// The stored facts that may differ: all, or those of units that are not kept.
std::vector<rdf::QuadIds> FactSink::storedToCompare(const rdf::QuadReader& stored) const {
  std::vector<rdf::QuadIds> facts;
  rdf::QuadIds quad;
  if (!has_units_) {
    rdf::QuadCursor cursor = stored.scan({.s = {}, .p = {}, .o = {}, .g = graph_}, rdf::QuadOrder::Gspo);
    while (cursor.next(quad)) facts.push_back(quad);
    return facts;
  }
  std::map<rdf::TermId, unsigned> facets;  // of each subject
  for (const FactUnit& unit : replaced_)
    for (const rdf::TermId subject : unit.subjects) facets[subject] |= facetsOf(unit.key);
  const std::vector<rdf::TermId> relations = relationTerms(stored);
  for (const auto& [subject, bits] : facets) {
    rdf::QuadCursor cursor = stored.scan({.s = subject, .p = {}, .o = {}, .g = graph_}, rdf::QuadOrder::Gspo);
    while (cursor.next(quad)) {
      const bool is_relation = std::find(relations.begin(), relations.end(), quad.p) != relations.end();
      if ((bits & bitOf(is_relation ? Facet::Relations : Facet::Self)) != 0) facts.push_back(quad);
    }
  }
  return facts;  // ascending, as subjects are
}

std::vector<rdf::QuadIds> FactSink::take() {
  std::vector<rdf::QuadIds> facts = std::move(of_units_);
  facts.insert(facts.end(), others_.begin(), others_.end());
  return facts;
}

void FactSink::sortSoFar() {
  std::sort(of_units_.begin(), of_units_.end());
  sorted_ = of_units_.size();
}

std::vector<rdf::QuadIds> FactSink::takeSorted() {
  std::vector<rdf::QuadIds> facts = std::move(of_units_);
  facts.insert(facts.end(), others_.begin(), others_.end());
  const auto rest = facts.begin() + static_cast<std::ptrdiff_t>(sorted_);
  std::sort(rest, facts.end());
  std::inplace_merge(facts.begin(), rest, facts.end());
  facts.erase(std::unique(facts.begin(), facts.end()), facts.end());
  return facts;
}

FactChange FactSink::writeDifference() {
  std::vector<rdf::QuadIds> facts = takeSorted();
  const std::vector<rdf::QuadIds> old = storedToCompare(readerOf(transaction_));
  FactChange change;
  std::set_difference(old.begin(), old.end(), facts.begin(), facts.end(), std::back_inserter(change.removed));
  if (old.empty())
    change.added = std::move(facts);
  else
    std::set_difference(facts.begin(), facts.end(), old.begin(), old.end(), std::back_inserter(change.added));
  writer_.change(change);
  return change;
}

FactChange FactSink::finish() {
  if (!replaces_others_ && !others_.empty()) throw std::logic_error("facts outside of the units that are replaced");
  writer_.flush();
  if (is_whole_) removeThoseNotAsked();
  if (replaces_others_) takeOthers();
  FactChange change = writeDifference();
  for (const FactUnitKey& key : removed_) eraseFactUnit(transaction_, key);
  for (const FactUnit& unit : units_) storeFactUnit(transaction_, unit);
  stampFactUnits(transaction_, readerOf(transaction_), graph_);
  return change;
}

}  // namespace cluxel::mapping
