// SPDX-License-Identifier: Apache-2.0
// Reads facts from the store below those that have changed.
#include "rdf/ontology/staged_facts.hpp"

#include <algorithm>

namespace cluxel::rdf {

StagedFacts::StagedFacts(const QuadReader& reader, const SchemaWords& words, std::vector<TermId> sources,
                         TermId inferred, std::vector<LateFact> late)
    : reader_(reader), words_(words), sources_(std::move(sources)), inferred_(inferred), late_(std::move(late)) {
  for (const LateFact& fact : late_) late_of_[fact.fact.p].push_back(fact);
}

bool StagedFacts::isSource(TermId graph) const {
  return std::find(sources_.begin(), sources_.end(), graph) != sources_.end();
}

/// The state of a fact that graph `inferred` holds.
FactState StagedFacts::inferredState(const Triple& fact) const {
  const auto at = std::lower_bound(late_.begin(), late_.end(), fact,
                                   [](const LateFact& entry, const Triple& value) { return entry.fact < value; });
  const bool is_late = at != late_.end() && at->fact == fact;
  FactState state;
  state.before = state.now = is_late ? at->stage : 0;
  state.base = is_late && at->is_base ? at->stage : kNever;
  state.is_written = true;
  return state;
}

FactState StagedFacts::storedState(const Triple& fact) const {
  FactState state;
  QuadCursor cursor = reader_.scan({.s = fact.s, .p = fact.p, .o = fact.o, .g = {}}, QuadOrder::Spog);
  bool is_stated = false;
  for (QuadIds quad; cursor.next(quad);) {
    if (quad.g == inferred_) state = inferredState(fact);
    is_stated = is_stated || isSource(quad.g);
  }
  if (is_stated) state.before = state.now = state.base = 0;
  state.is_stated = is_stated;
  return state;
}

FactState StagedFacts::stateOf(const Triple& fact) const {
  const auto found = changed_.find(fact);
  return found != changed_.end() ? found->second : storedState(fact);
}

FactState& StagedFacts::insert(const Triple& fact, const FactState& state) {
  changed_of_[fact.p].push_back(fact);
  objects_[key(fact.p, fact.s)].push_back(fact.o);
  subjects_[key(fact.p, fact.o)].push_back(fact.s);
  touches_schema_ = touches_schema_ || words_.isAxiom(fact.p, fact.o);
  return changed_.emplace(fact, state).first->second;
}

FactState& StagedFacts::change(const Triple& fact) {
  const auto found = changed_.find(fact);
  FactState& state = found != changed_.end() ? found->second : insert(fact, storedState(fact));
  if (!state.is_waiting) waiting_.push_back(fact);
  state.is_waiting = true;
  return state;
}

void StagedFacts::restate(const Triple& fact, bool was_stated) {
  FactState& state = change(fact);
  if (was_stated) {
    state.before = state.now = state.base = 0;
    return;
  }
  const FactState now = state;
  state = now.is_written ? inferredState(fact) : FactState{};
  state.is_stated = now.is_stated;
  state.is_waiting = true;
}

void StagedFacts::forEachObject(TermId subject, TermId property, const Visit& visit) const {
  QuadCursor cursor = reader_.scan({.s = subject, .p = property, .o = {}, .g = {}}, QuadOrder::Spog);
  TermId last = kNoTerm;
  for (QuadIds quad; cursor.next(quad); last = quad.o) {
    const Triple fact{subject, property, quad.o};
    if (quad.o != last && !changed_.contains(fact)) visit(quad.o, storedState(fact));
  }
  const auto found = objects_.find(key(property, subject));
  if (found == objects_.end()) return;
  for (std::size_t i = 0; i < found->second.size(); ++i) {
    const TermId object = found->second[i];
    visit(object, changed_.at({subject, property, object}));
  }
}

void StagedFacts::forEachSubject(TermId property, TermId object, const Visit& visit) const {
  QuadCursor cursor = reader_.scan({.s = {}, .p = property, .o = object, .g = {}}, QuadOrder::Posg);
  TermId last = kNoTerm;
  for (QuadIds quad; cursor.next(quad); last = quad.s) {
    const Triple fact{quad.s, property, object};
    if (quad.s != last && !changed_.contains(fact)) visit(quad.s, storedState(fact));
  }
  const auto found = subjects_.find(key(property, object));
  if (found == subjects_.end()) return;
  for (std::size_t i = 0; i < found->second.size(); ++i) {
    const TermId subject = found->second[i];
    visit(subject, changed_.at({subject, property, object}));
  }
}

void StagedFacts::write(QuadWriter& writer) {
  for (const Triple& fact : waiting_) {
    FactState& state = changed_.at(fact);
    state.is_waiting = false;
    const bool is_wanted = state.now != kNever && !state.is_stated;
    if (is_wanted == state.is_written) continue;
    const QuadIds quad{fact.s, fact.p, fact.o, inferred_};
    is_wanted ? writer.add(quad) : writer.remove(quad);
    state.is_written = is_wanted;
  }
  waiting_.clear();
  writer.flush();
}

std::vector<LateFact> StagedFacts::lateNow() const {
  std::vector<LateFact> late;
  for (const LateFact& entry : late_)
    if (!changed_.contains(entry.fact)) late.push_back(entry);
  for (const auto& [fact, state] : changed_)
    if (state.now != kNever && state.now > 0) late.push_back({fact, state.now, state.base == state.now});
  std::sort(late.begin(), late.end());
  return late;
}

}  // namespace cluxel::rdf
