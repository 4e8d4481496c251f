// SPDX-License-Identifier: Apache-2.0
// The reasoning stage (paper, section 3.1.2): strata of classes are processed in order, from the ground upwards. In a
// stratum of several classes rules propose and evidence decides; in a stratum of one class a primitive goes to the
// first rule that accepts it. Shared crowns are then split and misfits absorbed.
#include "rules/decide/reason.hpp"

#include <algorithm>

#include "rules/decide/competition.hpp"
#include "rules/decide/reasoning_strata.hpp"
#include "rules/decide/rule_run.hpp"
#include "rules/objects/absorbing.hpp"
#include "rules/objects/crown_gathering.hpp"
#include "rules/objects/finished_objects.hpp"
#include "rules/objects/shared_splitting.hpp"

namespace cluxel::rules {

namespace {

bool shares(const Rule& rule) {
  return std::any_of(rule.nodes.begin(), rule.nodes.end(), [](const TreeNode& node) {
    const auto* accept = std::get_if<AcceptLeaf>(&node.what);
    return accept != nullptr && accept->splitting.has_value();
  });
}

/// Splits the primitives shared by objects, then gathers the free fragments beside those of a class.
void splitAll(ReasoningState& state, const std::string& class_iri) {
  splitShared(state);
  gatherFragments(state, class_iri);
}

/// The rules of a class one after the other, in the order written.
void runInTurn(ReasoningState& state, const std::string& class_iri, bool leftovers_only) {
  for (const Rule& rule : state.rules.rules) {
    if (rule.class_iri != class_iri || (leftovers_only && !rule.leftovers)) continue;
    // The rest of shared primitives becomes free for rules that do not share.
    if (!shares(rule)) splitAll(state, class_iri);
    runRule(state, rule);
  }
  splitAll(state, class_iri);
}

bool asksRivals(const Rule& rule) {
  const auto among = [](const std::vector<EvidenceLine>& lines) {
    return std::any_of(lines.begin(), lines.end(), [](const EvidenceLine& line) { return line.asks_rivals; });
  };
  return among(rule.evidence) || std::any_of(rule.nodes.begin(), rule.nodes.end(), [&](const TreeNode& node) {
           const auto* accept = std::get_if<AcceptLeaf>(&node.what);
           return accept != nullptr && among(accept->evidence);
         });
}

/// The stratum is decided twice. Evidence that asks for rivals counts in the second round only, and reads who won the
/// first; so no decision waits for another.
std::shared_ptr<const FirstWinners> winnersOfFirstRound(ReasoningState& state,
                                                        const std::vector<const Rule*>& proposing) {
  ReasoningState round = state;
  round.is_first_of_two_rounds = true;
  compete(round, proposing);
  state.trace = std::move(round.trace);  // what it came to is read by the second round
  return std::make_shared<const FirstWinners>(round, state.objects.size());
}

void decideTogether(ReasoningState& state, const std::vector<std::string>& stratum) {
  std::vector<const Rule*> proposing;
  for (const std::string& class_iri : stratum)
    for (const Rule& rule : state.rules.rules)
      if (rule.class_iri == class_iri && !rule.leftovers) proposing.push_back(&rule);
  const std::size_t first = state.objects.size();
  if (std::any_of(proposing.begin(), proposing.end(), [](const Rule* rule) { return asksRivals(*rule); }))
    state.first_winners = winnersOfFirstRound(state, proposing);
  compete(state, proposing);
  state.first_winners.reset();
  for (const std::string& class_iri : stratum) splitAll(state, class_iri);
  absorbMisfits(state, first, false);
  for (const std::string& class_iri : stratum) runInTurn(state, class_iri, true);
}

}  // namespace

void decideStratum(ReasoningState& state, const std::vector<std::string>& stratum) {
  const std::size_t first = state.objects.size();
  if (stratum.size() == 1)
    runInTurn(state, stratum.front(), false);
  else
    decideTogether(state, stratum);
  absorbMisfits(state, first, false);
  if (state.context.oracle != nullptr && state.rules.asks_map)
    state.context.oracle->objectsSoFar(finishedObjects(state));
}

namespace {

/// The trace of a primitive tells of the objects that own some of it.
void noteObjects(ReasoningState& state, const std::vector<SemanticObject>& objects) {
  state.trace.enter(mixed(StepKind::Finished, std::uint64_t{0}));
  std::map<std::size_t, const ObjectInMaking*> made;  // by decision
  for (const ObjectInMaking& object : state.objects) made.emplace(object.decision, &object);
  std::vector<std::uint64_t> sums(state.scene.primitives.size(), 0);  // no order of objects enters
  for (const SemanticObject& object : objects) {
    const ObjectInMaking& making = *made.at(object.decision);
    std::uint64_t trace = mixed(hashOf(object.class_iri), making.trace);
    if (!making.isOfWholeClass())
      trace =
          mixed(mixed(mixed(trace, std::hash<ContentHash>()(object.id)), hashOf(object.rule_id)), object.confidence);
    for (const ObjectPart& part : object.parts)
      for (const perception::PrimitiveIndex primitive : part.primitives)
        sums[primitive] += mixed(trace, hashOf(part.part_class));
  }
  for (perception::PrimitiveIndex i = 0; i < sums.size(); ++i) state.trace.note(i, sums[i]);
}

}  // namespace

ReasoningResult finishedRun(ReasoningState& state) {
  absorbMisfits(state, 0, true);
  ReasoningResult result;
  result.objects = finishedObjects(state);
  noteObjects(state, result.objects);
  result.decisions = std::move(state.decisions);
  result.traces = state.trace.takeTraces();
  return result;
}

ReasoningResult reason(const perception::Scene& scene, const RuleSet& rules, const ReasoningContext& context) {
  ReasoningState state(scene, rules, context);
  for (const std::vector<std::string>& stratum : rules.strata) decideStratum(state, stratum);
  return finishedRun(state);
}

}  // namespace cluxel::rules
