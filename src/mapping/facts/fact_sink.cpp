// SPDX-License-Identifier: Apache-2.0
// Facts are ids; the graph is updated by the difference of two sorted lists.
#include "mapping/facts/fact_sink.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <span>

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

bool isBefore(const FactUnit& a, const FactUnit& b) {
  return a.id < b.id;
}

}  // namespace

FactSink::FactSink(rdf::QuadWriter& writer, rdf::TermId graph, std::optional<std::vector<FactUnit>> known)
    : writer_(writer), graph_(graph), known_(std::move(known)), is_kept_(known_ ? known_->size() : 0) {}

bool FactSink::beginUnit(const ContentHash& unit, const ContentHash& cause) {
  const FactUnit asked{unit, added_to_.contains(unit) ? ContentHash{} : cause, {}};
  if (known_ && !asked.cause.isZero()) {
    const auto found = std::lower_bound(known_->begin(), known_->end(), asked, isBefore);
    if (found != known_->end() && found->id == unit && found->cause == cause) {
      is_kept_[static_cast<std::size_t>(found - known_->begin())] = true;
      units_.push_back(*found);
      return false;
    }
  }
  units_.push_back(asked);
  unit_begin_ = of_units_.size();
  return in_unit_ = true;
}

void FactSink::endUnit() {
  units_.back().subjects = subjectsOf(std::span(of_units_).subspan(unit_begin_));
  in_unit_ = false;
}

rdf::TermId FactSink::property(std::string_view name) {
  const auto [place, is_new] = properties_.try_emplace(std::string(name), rdf::kNoTerm);
  if (is_new) {
    const bool is_full = name.find(':') != std::string_view::npos;
    place->second = iri(is_full ? std::string(name) : rdf::vocabulary::clx(name));
  }
  return place->second;
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
  literal(subject, property_name, decimalText(value, 3), rdf::vocabulary::xsd("decimal"));
}

void FactSink::count(rdf::TermId subject, std::string_view property_name, std::uint64_t value) {
  link(subject, property_name, writer_.intern(Term::integer(static_cast<std::int64_t>(value))));
}

/// The stored facts that may differ: all, or those of units that are not kept.
std::vector<rdf::QuadIds> FactSink::storedToCompare(const rdf::QuadReader& stored) const {
  std::vector<rdf::QuadIds> facts;
  const auto add = [&](const rdf::QuadPattern& pattern) {
    rdf::QuadCursor cursor = stored.scan(pattern, rdf::QuadOrder::Gspo);
    for (rdf::QuadIds quad; cursor.next(quad);) facts.push_back(quad);
  };
  if (!known_) {
    add({.s = {}, .p = {}, .o = {}, .g = graph_});
  } else {
    std::vector<rdf::TermId> subjects;
    for (std::size_t i = 0; i < known_->size(); ++i)
      if (!is_kept_[i]) subjects.insert(subjects.end(), (*known_)[i].subjects.begin(), (*known_)[i].subjects.end());
    std::sort(subjects.begin(), subjects.end());
    subjects.erase(std::unique(subjects.begin(), subjects.end()), subjects.end());
    for (const rdf::TermId subject : subjects) add({.s = subject, .p = {}, .o = {}, .g = graph_});
  }
  std::sort(facts.begin(), facts.end());
  return facts;
}

std::vector<FactUnit> FactSink::writeTo(const rdf::QuadReader& stored) {
  units_.push_back({{}, {}, subjectsOf(others_)});
  std::sort(units_.begin(), units_.end(), isBefore);
  std::vector<rdf::QuadIds> facts = std::move(of_units_);
  facts.insert(facts.end(), others_.begin(), others_.end());
  std::sort(facts.begin(), facts.end());
  facts.erase(std::unique(facts.begin(), facts.end()), facts.end());
  std::vector<rdf::QuadIds> gone, fresh;
  const std::vector<rdf::QuadIds> old = storedToCompare(stored);
  std::set_difference(old.begin(), old.end(), facts.begin(), facts.end(), std::back_inserter(gone));
  std::set_difference(facts.begin(), facts.end(), old.begin(), old.end(), std::back_inserter(fresh));
  for (const rdf::QuadIds& quad : gone) writer_.remove(quad);
  for (const rdf::QuadIds& quad : fresh) writer_.add(quad);
  return std::move(units_);
}

}  // namespace cluxel::mapping
