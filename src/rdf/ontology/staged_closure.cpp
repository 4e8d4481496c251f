// SPDX-License-Identifier: Apache-2.0
// Delete and rederive, by stages.
#include "rdf/ontology/staged_closure.hpp"

#include <algorithm>
#include <unordered_set>

namespace cluxel::rdf {

StagedClosure::StagedClosure(const QuadReader& reader, const SchemaWords& words, const Schema& schema,
                             StagedFacts& facts, ClosureBounds& bounds)
    : reader_(reader), words_(words), schema_(schema), facts_(facts), bounds_(bounds) {
  for (const auto& [property, implied] : schema.implications)
    for (const Implied& next : implied) implying_[next.property].push_back({property, next.inverted, next.via_inverse});
}

/// Calls visit(fact, stage) for all that follows from a fact of `stage` in one step; the stage is that of this step.
template <typename Visit>
void StagedClosure::forEachConsequence(const Triple& fact, Stage stage, const Visit& visit) const {
  bounds_.addStep(fact.p);
  if (const auto implied = schema_.implications.find(fact.p); implied != schema_.implications.end()) {
    const bool may_invert = isResource(fact.o);
    for (const Implied& next : implied->second) {
      if (next.via_inverse && !may_invert) continue;
      visit(next.inverted ? Triple{fact.o, next.property, fact.s} : Triple{fact.s, next.property, fact.o}, stage);
    }
  }
  if (fact.p == words_.type)
    if (const auto above = schema_.ancestors.find(fact.o); above != schema_.ancestors.end())
      for (const TermId ancestor : above->second) visit(Triple{fact.s, fact.p, ancestor}, stage);
  if (!schema_.transitive.contains(fact.p)) return;
  std::vector<Reached> joined;  // visit() may change the facts
  facts_.forEachObject(fact.o, fact.p, [&](TermId end, const FactState& state) {
    if (state.now != kNever) joined.push_back({{fact.s, fact.p, end}, std::max(stage, state.now)});
  });
  facts_.forEachSubject(fact.p, fact.s, [&](TermId start, const FactState& state) {
    if (state.now != kNever) joined.push_back({{start, fact.p, fact.o}, std::max(stage, state.now)});
  });
  for (const Reached& next : joined) {
    bounds_.addStep(fact.p);
    visit(next.fact, next.stage);
  }
}

/// The least stage at which a fact follows from others in one step.
Stage StagedClosure::bestDerivation(const Triple& fact) const {
  bounds_.addStep(fact.p);
  Stage best = kNever;
  if (const auto implying = implying_.find(fact.p); implying != implying_.end())
    for (const Implied& from : implying->second) {
      if (from.via_inverse && !from.inverted && !isResource(fact.o)) continue;
      best = std::min(best, facts_.stageOf(from.inverted ? Triple{fact.o, from.property, fact.s}
                                                         : Triple{fact.s, from.property, fact.o}));
    }
  if (fact.p == words_.type)
    facts_.forEachObject(fact.s, fact.p, [&](TermId kind, const FactState& state) {
      const auto above = schema_.ancestors.find(kind);
      if (above != schema_.ancestors.end() && above->second.contains(fact.o)) best = std::min(best, state.now);
    });
  if (schema_.transitive.contains(fact.p))
    facts_.forEachObject(fact.s, fact.p, [&](TermId middle, const FactState& state) {
      bounds_.addStep(fact.p);
      if (state.now < best) best = std::min(best, std::max(state.now, facts_.stageOf({middle, fact.p, fact.o})));
    });
  return best;
}

/// The facts whose stage may rise, when it does for those in `open`. States are left as they are.
std::vector<Triple> StagedClosure::takeAway(std::vector<Triple> open) {
  std::unordered_set<Triple, TripleHash> taken(open.begin(), open.end());
  weakened_.insert(weakened_.end(), open.begin(), open.end());
  for (std::size_t i = 0; i < open.size(); ++i) {
    const Triple fact = open[i];
    forEachConsequence(fact, facts_.stageOf(fact), [&](const Triple& next, Stage stage) {
      const FactState state = facts_.stateOf(next);
      if (state.now != stage) return;  // it is known earlier
      if (state.base > stage && !taken.insert(next).second) return;
      weakened_.push_back(next);
      if (state.base > stage) open.push_back(next);  // else it needs no closure
    });
  }
  return open;
}

void StagedClosure::lower(const Triple& fact, Stage stage) {
  if (stage >= facts_.stageOf(fact)) return;
  bounds_.addFact(fact.p);
  facts_.change(fact).now = stage;
  open_.push_back({fact, stage});
  std::push_heap(open_.begin(), open_.end(), [](const Reached& a, const Reached& b) { return a.stage > b.stage; });
}

void StagedClosure::settle() {
  while (!open_.empty()) {
    std::pop_heap(open_.begin(), open_.end(), [](const Reached& a, const Reached& b) { return a.stage > b.stage; });
    const Reached next = open_.back();
    open_.pop_back();
    if (facts_.stageOf(next.fact) != next.stage) continue;  // it was reached earlier meanwhile
    forEachConsequence(next.fact, next.stage, [this](const Triple& fact, Stage stage) { lower(fact, stage); });
  }
}

void StagedClosure::update(std::span<const BaseChange> changes) {
  std::vector<Triple> weaker;
  for (const BaseChange& change : changes) {
    FactState& state = facts_.change(change.fact);
    if (state.base == state.now && change.base > state.base) weaker.push_back(change.fact);
    state.base = change.base;
  }
  const std::vector<Triple> taken = takeAway(std::move(weaker));
  for (const Triple& fact : taken) {
    FactState& state = facts_.change(fact);
    state.now = kNever;
  }
  for (const Triple& fact : taken) lower(fact, std::min(facts_.stateOf(fact).base, bestDerivation(fact)));
  for (const BaseChange& change : changes) lower(change.fact, change.base);
  settle();
}

Schema readStoredSchema(const QuadReader& reader, const SchemaWords& words, std::span<const TermId> graphs,
                        ClosureBounds& bounds) {
  const auto scan = [&](TermId property, TermId object, const PairVisit& visit) {
    if (property == kNoTerm) return;
    QuadCursor cursor = reader.scan({.s = {}, .p = property, .o = object, .g = {}}, QuadOrder::Posg);
    for (QuadIds quad; cursor.next(quad);) {
      bounds.addStep(property);
      if (std::find(graphs.begin(), graphs.end(), quad.g) != graphs.end()) visit(quad.s, quad.o);
    }
  };
  return readSchema(reader, words, scan, bounds);
}

}  // namespace cluxel::rdf
