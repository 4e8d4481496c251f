// SPDX-License-Identifier: Apache-2.0
// Reads facts from the store below those that have changed.
#include "rdf/ontology/staged_facts.hpp"

#include <algorithm>
#include <span>

namespace cluxel::rdf {

namespace {

std::span<const TermId> endsOf(const std::unordered_map<TermId, std::vector<TermId>>& ends, TermId end) {
  const auto found = ends.find(end);
  return found != ends.end() ? std::span<const TermId>(found->second) : std::span<const TermId>();
}

}  // namespace

StagedFacts::StagedFacts(const QuadReader& reader, const SchemaWords& words, std::vector<TermId> sources,
                         TermId inferred, std::vector<LateFact> late)
    : reader_(reader), words_(words), sources_(std::move(sources)), inferred_(inferred), late_(std::move(late)) {
  for (const LateFact& fact : late_) late_of_[fact.fact.p].push_back(fact);
}

bool StagedFacts::isSource(TermId graph) const {
  return std::find(sources_.begin(), sources_.end(), graph) != sources_.end();
}

/// Its place among the facts of later stages before the change.
std::optional<std::size_t> StagedFacts::lateAt(const Triple& fact) const {
  const auto at = std::lower_bound(late_.begin(), late_.end(), fact,
                                   [](const LateFact& entry, const Triple& value) { return entry.fact < value; });
  if (at == late_.end() || at->fact != fact) return std::nullopt;
  return static_cast<std::size_t>(at - late_.begin());
}

/// The state of a fact that graph `inferred` holds.
FactState StagedFacts::inferredState(const Triple& fact) const {
  const auto place = lateAt(fact);
  FactState state;
  state.before = state.now = place ? late_[*place].stage : 0;
  state.base = place && late_[*place].is_base ? late_[*place].stage : kNever;
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
  touches_schema_ = touches_schema_ || words_.isAxiom(fact.p, fact.o);
  return changed_.emplace(fact, state).first->second;
}

const StagedFacts::Links& StagedFacts::linksOf(TermId property) const {
  Links& links = links_[property];
  const std::vector<Triple>& facts = changedOf(property);
  for (; links.known < facts.size(); ++links.known) {
    const Triple& fact = facts[links.known];
    links.objects[fact.s].push_back(fact.o);
    links.subjects[fact.o].push_back(fact.s);
  }
  return links;
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
  const auto ends = [&]() -> std::span<const TermId> { return endsOf(linksOf(property).objects, subject); };
  for (std::size_t i = 0; i < ends().size(); ++i) {  // a visit may add some
    const TermId object = ends()[i];
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
  const auto ends = [&]() -> std::span<const TermId> { return endsOf(linksOf(property).subjects, object); };
  for (std::size_t i = 0; i < ends().size(); ++i) {  // a visit may add some
    const TermId subject = ends()[i];
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
  std::vector<char> is_changed(late_.size(), 0);
  for (const auto& [property, facts] : changed_of_) {
    if (!late_of_.contains(property)) continue;
    for (const Triple& fact : facts)
      if (const auto place = lateAt(fact)) is_changed[*place] = 1;
  }
  std::vector<LateFact> made;
  for (const auto& [fact, state] : changed_)
    if (state.now != kNever && state.now > 0) made.push_back({fact, state.now, state.base == state.now});
  std::sort(made.begin(), made.end());
  std::vector<LateFact> late;
  late.reserve(late_.size() + made.size());
  auto next = made.begin();
  for (std::size_t i = 0; i < late_.size(); ++i) {
    if (is_changed[i] != 0) continue;
    for (; next != made.end() && *next < late_[i]; ++next) late.push_back(*next);
    late.push_back(late_[i]);
  }
  late.insert(late.end(), next, made.end());
  return late;
}

}  // namespace cluxel::rdf
