// SPDX-License-Identifier: Apache-2.0
// A solution differs only when a fact that one of its patterns matches does. The pattern's variable is the key, or
// other patterns lead from it to the key, by facts of before and now. Where none do, a query over both together does.
#include "mapping/inference/affected_keys.hpp"

#include <algorithm>

#include "rdf/store/temporary_quads.hpp"

namespace cluxel::mapping {

AffectedKeys::AffectedKeys(rdf::WriteTransaction& transaction, const rdf::StagedFacts& facts, rdf::TermId inferred,
                           const RuleShape& shape, const ReadTest& reads, const rdf::InferenceCheck& check)
    : transaction_(transaction),
      facts_(facts),
      inferred_(inferred),
      shape_(shape),
      reads_(reads),
      check_(check),
      reader_(static_cast<const rdf::ReadTransaction&>(transaction)),
      steps_(stepsToKey(shape)) {}

void AffectedKeys::noteGone(std::span<const SeenChange> changed) {
  std::set<rdf::TermId> properties;
  for (const auto& [variable, steps] : steps_)
    for (const KeyStep& step : steps)
      if (const auto pattern = reads_.patternOf(step.read)) properties.insert(pattern->p);
  for (const auto& [fact, is_fact] : changed) {
    if (is_fact) continue;
    gone_.push_back(fact);
    if (!properties.contains(fact.p)) continue;
    gone_objects_.push_back({fact.p, fact.s, fact.o});
    gone_subjects_.push_back({fact.p, fact.o, fact.s});
  }
  std::sort(gone_.begin(), gone_.end());
  std::sort(gone_objects_.begin(), gone_objects_.end());
  std::sort(gone_subjects_.begin(), gone_subjects_.end());
}

/// Whether the pattern's subject leads to the key, rather than its object. None: it has no variable.
std::optional<bool> AffectedKeys::goesBySubject(std::size_t read) const {
  const ast::TriplePattern& triple = shape_.reads[read].triple;
  const auto is_key = [&](const ast::PatternTerm& end) { return end.isVariable() && end.variable() == shape_.key; };
  if (!triple.subject.isVariable() && !triple.object.isVariable()) return std::nullopt;
  return is_key(triple.subject) || (triple.subject.isVariable() && !is_key(triple.object));
}

/// Whether the value has the types, and other constant objects, that each solution needs of the variable: before the
/// change or now. False: no solution has or had this value.
bool AffectedKeys::hasConstants(ast::VariableIndex variable, rdf::TermId value) const {
  for (std::size_t read = 0; read < shape_.reads.size(); ++read) {
    const ReadPattern& pattern = shape_.reads[read];
    const bool is_about = !pattern.triple.isPath() && pattern.triple.subject.isVariable() &&
                          pattern.triple.subject.variable() == variable && !pattern.triple.object.isVariable();
    if (pattern.need != ReadPattern::Need::Always || !is_about) continue;
    const auto wanted = reads_.patternOf(read);
    if (!wanted) return false;
    const rdf::Triple fact{value, wanted->p, wanted->o};
    const rdf::FactState state = facts_.stateOf(fact);
    if (state.before == rdf::kNever && state.now == rdf::kNever &&
        !std::binary_search(gone_.begin(), gone_.end(), fact))
      return false;
  }
  return true;
}

bool AffectedKeys::mayBind(ast::VariableIndex variable, rdf::TermId value) {
  const auto [known, is_new] = may_bind_.try_emplace(std::uint64_t{variable} << 32U | value);
  if (is_new) known->second = hasConstants(variable, value);
  return known->second;
}

/// Whether a solution can have the fact for a pattern.
bool AffectedKeys::mayMatch(std::size_t read, const rdf::Triple& fact) {
  const ast::TriplePattern& triple = shape_.reads[read].triple;
  if (!reads_.matches(read, fact)) return false;
  if (triple.isPath()) return true;
  return (!triple.subject.isVariable() || mayBind(triple.subject.variable(), fact.s)) &&
         (!triple.object.isVariable() || mayBind(triple.object.variable(), fact.o));
}

void AffectedKeys::reach(ast::VariableIndex variable, rdf::TermId value) {
  if (mayBind(variable, value) && reached_[variable].insert(value).second) open_.emplace_back(variable, value);
}

/// Adds all ends of the path's steps that are connected with the fact by such steps, now or before.
void AffectedKeys::addConnected(const rdf::Triple& fact, std::size_t read, std::set<rdf::TermId>& connected) const {
  std::vector<rdf::TermId> open;
  const auto add = [&](rdf::TermId node) {
    if (connected.insert(node).second) open.push_back(node);
  };
  add(fact.s), add(fact.o);
  while (!open.empty()) {
    const rdf::TermId node = open.back();
    open.pop_back();
    for (const rdf::TermId link : reads_.linksOf(read)) {
      facts_.forEachObject(node, link, [&](rdf::TermId end, const rdf::FactState&) { add(end); });
      facts_.forEachSubject(link, node, [&](rdf::TermId end, const rdf::FactState&) { add(end); });
    }
  }
}

/// Reaches what the changed facts give the variables of patterns. False: a pattern without variables matches one.
bool AffectedKeys::reachEnds(std::span<const SeenChange> changed) {
  for (std::size_t read = 0; read < shape_.reads.size(); ++read) {
    const ast::TriplePattern& triple = shape_.reads[read].triple;
    const auto by_subject = goesBySubject(read);
    std::set<rdf::TermId> ends;
    for (const auto& [fact, is_fact] : changed) {
      if (!mayMatch(read, fact)) continue;
      if (!by_subject) return false;
      if (triple.isPath())
        addConnected(fact, read, ends);
      else
        ends.insert(*by_subject ? fact.s : fact.o);
    }
    for (const rdf::TermId end : ends) reach((*by_subject ? triple.subject : triple.object).variable(), end);
  }
  return true;
}

/// Reaches what the step leads to by a fact of before or now.
void AffectedKeys::take(const KeyStep& step, rdf::TermId value) {
  const auto pattern = reads_.patternOf(step.read);
  if (!pattern) return;
  rdf::QuadCursor cursor = step.to_subject
                               ? reader_.scan({.s = {}, .p = pattern->p, .o = value, .g = {}}, rdf::QuadOrder::Posg)
                               : reader_.scan({.s = value, .p = pattern->p, .o = {}, .g = {}}, rdf::QuadOrder::Spog);
  for (rdf::QuadIds quad; cursor.next(quad);) reach(step.to, step.to_subject ? quad.s : quad.o);
  const std::vector<Link>& gone = step.to_subject ? gone_subjects_ : gone_objects_;
  for (auto link = std::lower_bound(gone.begin(), gone.end(), Link{pattern->p, value, 0});
       link != gone.end() && (*link)[0] == pattern->p && (*link)[1] == value; ++link)
    reach(step.to, (*link)[2]);
}

void AffectedKeys::follow() {
  while (!open_.empty()) {
    const auto [variable, value] = open_.back();
    open_.pop_back();
    if (const auto steps = steps_.find(variable); steps != steps_.end())
      for (const KeyStep& step : steps->second) take(step, value);
  }
}

/// Of the facts that have ceased to be, those that solutions had.
std::vector<rdf::QuadIds> AffectedKeys::goneOfSolutions() {
  std::vector<rdf::QuadIds> gone;
  for (const rdf::Triple& fact : gone_)
    for (std::size_t read = 0; read < shape_.reads.size(); ++read)
      if (mayMatch(read, fact)) {
        gone.push_back({fact.s, fact.p, fact.o, inferred_});
        break;
      }
  return gone;
}

/// Asks for the keys of values from which no steps lead on.
void AffectedKeys::addKeysOfOthers() {
  std::vector<ValuesOf> others;
  for (const auto& [variable, values] : reached_) {
    if (variable == shape_.key || steps_.contains(variable)) continue;
    ValuesOf& some = others.emplace_back(ValuesOf{variable, {}});
    for (const rdf::TermId value : values) some.terms.push_back(reader_.termOf(value));
  }
  if (others.empty()) return;
  rdf::TemporaryQuads before(transaction_, goneOfSolutions(), {});
  std::set<rdf::TermId>& keys = reached_[shape_.key];
  for (const ValuesOf& some : others)
    for (const rdf::TermId key : affectedKeys(reader_, shape_, some, check_)) keys.insert(key);
  before.end();
}

std::optional<std::vector<rdf::TermId>> AffectedKeys::of(std::span<const SeenChange> changed,
                                                         std::span<const SeenChange> gone) {
  noteGone(gone);
  if (!reachEnds(changed)) return std::nullopt;
  follow();
  addKeysOfOthers();
  const std::set<rdf::TermId>& keys = reached_[shape_.key];
  return std::vector<rdf::TermId>(keys.begin(), keys.end());
}

}  // namespace cluxel::mapping
