// SPDX-License-Identifier: Apache-2.0
// Follows a change through one rule: evaluates it for the keys that what it reads affects.
#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "mapping/inference/change_inference.hpp"
#include "rdf/store/temporary_quads.hpp"

namespace cluxel::mapping {

using rdf::FactState;
using rdf::kNever;
using rdf::LateFact;
using rdf::Stage;
using rdf::Triple;

namespace {

/// A rule that reads what it derives sees its own facts.
Stage endOf(Stage stage) {
  return stage + 1;
}

/// None: all keys. Below a few, evaluating by key is never worse by much.
std::optional<std::vector<rdf::TermId>> unlessMost(std::optional<std::vector<rdf::TermId>> keys,
                                                   const Outputs& outputs) {
  constexpr std::size_t kFewKeys = 1000;
  if (keys && keys->size() > kFewKeys && keys->size() > outputs.size() / 2) keys.reset();
  return keys;
}

}  // namespace

/// What the store holds of facts that a rule reads but may not see.
std::vector<rdf::QuadIds> ChangeInference::unseen(Stage end, const ReadTest& reads) const {
  std::vector<rdf::QuadIds> quads;
  const auto add = [&](const Triple& fact) { quads.push_back({fact.s, fact.p, fact.o, graphs_.inferred}); };
  for (const rdf::TermId property : reads.properties()) {
    for (const LateFact& late : facts_.lateOf(property))
      if (late.stage >= end && reads.matches(late.fact) && !facts_.changed().contains(late.fact)) add(late.fact);
    for (const Triple& fact : facts_.changedOf(property)) {
      if (!reads.matches(fact)) continue;
      const FactState& state = facts_.changed().at(fact);
      if (state.is_written && state.now >= end && state.now != kNever) add(fact);
    }
  }
  return quads;
}

/// The facts that a rule reads and that it saw before the change and does not see now, or the other way round.
std::vector<SeenChange> ChangeInference::seenChanges(Stage end, const ReadTest& reads) const {
  std::vector<SeenChange> changes;
  for (const rdf::TermId property : reads.properties()) {
    for (const Triple& fact : facts_.changedOf(property))
      if (reads.matches(fact) && isOtherBefore(end, fact))
        changes.push_back({fact, facts_.changed().at(fact).now != kNever});
    if (const auto plain = plain_.find(property); plain != plain_.end())
      for (const SeenChange& one : plain->second)
        if (reads.matches(one.fact)) changes.push_back(one);
  }
  return changes;
}

/// Whether a rule sees the fact now.
bool ChangeInference::isSeen(Stage end, const SeenChange& change) const {
  const auto state = facts_.changed().find(change.fact);
  return state == facts_.changed().end() ? change.is_fact : state->second.now < end;
}

/// Whether the fact has become known before a stage, or has ceased to be.
bool ChangeInference::isOtherBefore(Stage end, const Triple& fact) const {
  const auto changed = facts_.changed().find(fact);
  return changed != facts_.changed().end() && (changed->second.before < end) != (changed->second.now < end);
}

/// The solutions of the rule for some keys, or all, from the facts of stages before `end`.
std::optional<Outputs> ChangeInference::solutions(Stage end, const RuleShape& shape, const ReadTest& reads,
                                                  const std::optional<std::vector<rdf::TermId>>& keys) {
  std::optional<ValuesOf> values;
  if (keys) {
    if (keys->empty()) return Outputs{};
    values = ValuesOf{shape.key, {}};
    for (const rdf::TermId key : *keys) values->terms.push_back(reader_.termOf(key));
  }
  std::vector<rdf::QuadIds> hidden = unseen(end, reads);
  if (shape.is_plain && !hidden.empty()) {
    const IsSeen is_seen = [&](const Triple& fact) { return facts_.stageOf(fact) < end; };
    return evaluateRule(transaction_, shape, check_, values, is_seen);
  }
  rdf::TemporaryQuads without(transaction_, {}, std::move(hidden));
  Outputs outputs = evaluateRule(transaction_, shape, check_, values);
  without.end();
  return outputs;
}

bool ChangeInference::followRule(Stage stage, const RuleShape& shape, Outputs& outputs, std::uint32_t& rounds) {
  Suspects suspects;
  if (shape.is_monotone && hasFedItself(stage, ReadTest(reader_, shape)))
    return takeAwaySuspects(stage, shape, outputs, suspects) &&
           deriveOn(stage, shape, outputs, std::move(suspects), rounds);
  if (!replaceAffected(stage, shape, outputs, suspects.gone)) return false;
  if (!feedsItself(stage, ReadTest(reader_, shape))) return true;
  return shape.is_monotone && deriveOn(stage, shape, outputs, std::move(suspects), ++rounds);
}

/// Evaluates the rule once, from the facts of earlier stages. `gone`: what it saw before the change and not any more;
/// the rule itself may derive it now.
bool ChangeInference::replaceAffected(Stage stage, const RuleShape& shape, Outputs& outputs, Facts& gone) {
  const ReadTest reads(reader_, shape);
  const std::vector<SeenChange> relevant = seenChanges(stage, reads);
  std::vector<Triple> touched;
  for (const SeenChange& change : relevant)
    if (!isSeen(stage, change)) gone.insert(change.fact);
  if (!relevant.empty()) {
    write();
    std::optional<std::vector<rdf::TermId>> keys;
    if (shape.following == RuleShape::Following::ByKey) {
      AffectedKeys affected(transaction_, facts_, graphs_.inferred, shape, reads, check_);
      keys = unlessMost(affected.of(relevant, relevant), outputs);
    } else {
      whole_.push_back({ruleFileName(shape.rule), shape.reason});
    }
    touched = replaceOutputs(outputs, keys, *solutions(stage, shape, reads, keys));
  }
  addOtherBases(stage, outputs, touched);
  setBases(stage, shape, std::move(touched), outputs);
  return !facts_.touchesSchema();
}

/// Takes away what may rest on a fact that is gone or has lost a derivation, and in turn what rests on that. So no
/// facts are left that support each other in a cycle alone (delete and rederive).
bool ChangeInference::takeAwaySuspects(Stage stage, const RuleShape& shape, Outputs& outputs, Suspects& suspects) {
  const ReadTest reads(reader_, shape);
  Facts seen;
  std::vector<SeenChange> gone;
  std::vector<SeenChange> open;
  for (const SeenChange& change : seenChanges(endOf(stage), reads))
    if (!isSeen(endOf(stage), change) && seen.insert(change.fact).second) open.push_back(change);
  std::vector<Triple> taken;
  for (const RuleOutput& output : outputs)
    if (std::binary_search(reconsidered_.begin(), reconsidered_.end(), output.fact) && isExcluded(output.fact) &&
        facts_.stateOf(output.fact).base == stage && suspects.taken.insert(output.fact).second)
      taken.push_back(output.fact);
  for (std::size_t weakened = 0;; taken.clear()) {
    for (; weakened < closure_.weakened().size(); ++weakened) {
      const Triple& fact = closure_.weakened()[weakened];
      const FactState state = facts_.stateOf(fact);
      if (state.before > stage || state.now < stage || isDerivation(reader_.viewOf(fact.s))) continue;
      if (state.base == stage && suspects.taken.insert(fact).second) taken.push_back(fact);
      if (reads.matches(fact) && seen.insert(fact).second) open.push_back({fact, state.now != kNever});
    }
    if (!open.empty()) {
      write();
      std::copy_if(open.begin(), open.end(), std::back_inserter(gone),
                   [](const SeenChange& change) { return !change.is_fact; });
      AffectedKeys affected(transaction_, facts_, graphs_.inferred, shape, reads, check_);
      const auto keys = affected.of(std::exchange(open, {}), gone);
      if (!keys) return false;
      std::vector<rdf::TermId> more;
      std::copy_if(keys->begin(), keys->end(), std::back_inserter(more),
                   [&](rdf::TermId key) { return suspects.keys.insert(key).second; });
      for (const Triple& fact : replaceOutputs(outputs, more, {}))
        if (suspects.taken.insert(fact).second) taken.push_back(fact);
    }
    const std::size_t before = closure_.weakened().size();
    setBases(stage, shape, taken, {});
    if (closure_.weakened().size() == before) break;
  }
  for (const Triple& fact : seen)
    if (facts_.stageOf(fact) >= endOf(stage)) suspects.gone.insert(fact);
  return !facts_.touchesSchema();
}

/// Puts back what still follows without the suspects, and evaluates the rule for their keys, and for those that what
/// has come affects, until nothing new comes.
bool ChangeInference::deriveOn(Stage stage, const RuleShape& shape, Outputs& outputs, Suspects suspects,
                               std::uint32_t& rounds) {
  Facts known;
  std::set<rdf::TermId>& keys = suspects.keys;
  std::vector<Triple> touched(suspects.taken.begin(), suspects.taken.end());
  addOtherBases(stage, outputs, touched);
  setBases(stage, shape, std::move(touched), outputs);
  for (;;) {
    if (facts_.touchesSchema()) return false;
    const ReadTest reads(reader_, shape);  // a round may bring a term of the patterns into the store
    std::vector<SeenChange> come = seenChanges(endOf(stage), reads);
    for (const Triple& fact : suspects.gone) come.push_back({fact, facts_.stageOf(fact) != kNever});
    std::erase_if(come, [&](const SeenChange& change) {
      return !isSeen(endOf(stage), change) || !known.insert(change.fact).second;
    });
    write();
    if (!come.empty()) {
      AffectedKeys affected(transaction_, facts_, graphs_.inferred, shape, reads, check_);
      const auto more = affected.of(come, {});
      if (!more) return false;
      keys.insert(more->begin(), more->end());
    }
    if (keys.empty()) return true;
    if (++rounds >= kMaxRounds - 1) return false;
    const auto some = unlessMost(std::vector<rdf::TermId>(keys.begin(), keys.end()), outputs);
    setBases(stage, shape, replaceOutputs(outputs, some, *solutions(endOf(stage), shape, reads, some)), outputs);
    keys.clear();
  }
}

/// Adds the facts that the rule derives and that have become known without it, or are not any more, or that statements
/// rule out now, or do not any more.
void ChangeInference::addOtherBases(Stage stage, const Outputs& outputs, std::vector<Triple>& touched) const {
  for (const RuleOutput& output : outputs)
    if (isOtherBefore(stage, output.fact) ||
        std::binary_search(reconsidered_.begin(), reconsidered_.end(), output.fact))
      touched.push_back(output.fact);
}

/// Decides for each fact that the rule derives, or has derived, whether it holds by the rule.
void ChangeInference::setBases(Stage stage, const RuleShape& shape, std::vector<Triple> touched,
                               const Outputs& outputs) {
  if (touched.empty()) return;
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  std::unordered_set<Triple, rdf::TripleHash> derived;
  for (const RuleOutput& output : outputs)
    if (std::binary_search(touched.begin(), touched.end(), output.fact)) derived.insert(output.fact);
  std::vector<rdf::BaseChange> bases;
  rdf::QuadWriter writer(transaction_);
  const auto set = [&](const Triple& fact, bool is_base) {
    const Stage base = facts_.stateOf(fact).base;
    if (is_base && base > stage) bases.push_back({fact, stage});
    if (!is_base && base == stage) bases.push_back({fact, kNever});
  };
  for (const Triple& fact : touched) {
    const bool is_base = derived.contains(fact) && !isExcluded(fact) && facts_.stageOf(fact) >= stage;
    set(fact, is_base);
    for (const Triple& part : derivationOf(reader_, writer, fact, shape.rule)) set(part, is_base);
  }
  writer.flush();
  closure_.update(bases);
}

/// Whether a statement rules the fact out, whatever rule derives it.
bool ChangeInference::isExcluded(const Triple& fact) const {
  return std::binary_search(record_.excluded.begin(), record_.excluded.end(), fact);
}

/// Whether the rule reads what has come to be at its own stage: then it has to be run again.
bool ChangeInference::feedsItself(Stage stage, const ReadTest& reads) const {
  const auto feeds = [&](const Triple& fact) { return reads.matches(fact) && facts_.changed().at(fact).now == stage; };
  return std::any_of(reads.properties().begin(), reads.properties().end(), [&](rdf::TermId property) {
    const std::vector<Triple>& changed = facts_.changedOf(property);
    return std::any_of(changed.begin(), changed.end(), feeds);
  });
}

/// Whether it read what it derived before the change.
bool ChangeInference::hasFedItself(Stage stage, const ReadTest& reads) const {
  const auto fed = [&](const LateFact& late) { return late.stage == stage && reads.matches(late.fact); };
  return std::any_of(reads.properties().begin(), reads.properties().end(), [&](rdf::TermId property) {
    const std::vector<LateFact>& late = facts_.lateOf(property);
    return std::any_of(late.begin(), late.end(), fed);
  });
}

}  // namespace cluxel::mapping
