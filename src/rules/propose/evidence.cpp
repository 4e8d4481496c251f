// SPDX-License-Identifier: Apache-2.0
// Measures each line of evidence and looks up its log-odds.
#include "rules/propose/evidence.hpp"

#include <algorithm>
#include <cmath>

#include "rules/decide/threshold_margins.hpp"
#include "rules/explain/changed_values.hpp"
#include "rules/propose/condition_eval.hpp"

namespace cluxel::rules {

namespace {

double confidenceOf(const Confidence& confidence, const Bindings& bindings) {
  if (confidence.ramps.empty()) return confidence.high;
  double sum = 0;
  for (const ConfidenceRamp& ramp : confidence.ramps) {
    const Candidate& candidate = bindings.at(ramp.of);
    double value = candidate.shape[ramp.attribute];
    if (bindings.changed != nullptr)
      value = bindings.changed->of(candidate, std::nullopt, ramp.attribute).value_or(value);
    sum += std::clamp((value - ramp.at_low) / (ramp.at_high - ramp.at_low), 0.0, 1.0);
  }
  const double share = sum / static_cast<double>(confidence.ramps.size());
  return confidence.low + (confidence.high - confidence.low) * share;
}

/// The first knot that is not below the value; one after the last when there is none.
std::size_t knotAbove(const std::vector<EvidenceLine::Knot>& knots, double value) {
  std::size_t i = 0;
  while (i < knots.size() && value > knots[i].at) ++i;
  return i;
}

double onCurve(const std::vector<EvidenceLine::Knot>& knots, double value) {
  const std::size_t i = knotAbove(knots, value);
  if (i == 0) return knots.front().log_odds;
  if (i == knots.size()) return knots.back().log_odds;
  const double share = (value - knots[i - 1].at) / (knots[i].at - knots[i - 1].at);
  return knots[i - 1].log_odds + share * (knots[i].log_odds - knots[i - 1].log_odds);
}

class Weighing {
 public:
  Weighing(const ReasoningState& state, const Rule& rule, const Bindings& bindings)
      : state_(state), rule_(rule), bindings_(bindings), evaluator_(state, rule, bindings) {}

  EvidenceStep of(const EvidenceLine& line) {
    EvidenceStep step;
    if (state_.context.keeps_paths) {
      step.text = state_.texts->of(line);
      step.file = line.at.file;
    }
    step.line = line.at.line;
    if (line.asks_rivals && state_.first_winners == nullptr) return step;
    step.log_odds = line.missing;
    if (isBound(line.measure))
      measure(line, step);
    else
      noteUse(line.constant);
    return step;
  }

  /// Of the constant of this number.
  void noteUse(std::uint32_t constant) const {
    if (state_.context.margins == nullptr) return;
    const FragmentIndex seed = bindings_.at(rule_.seed.name).fragments.front();
    state_.context.margins->noteUse(state_.fragments[seed].primitive, constant);
  }

 private:
  bool isBound(const Condition& condition) const {
    const bool target = condition.target && condition.target->kind == Target::Kind::Name;
    return bindings_.has(condition.of) && (condition.ratio_of.empty() || bindings_.has(condition.ratio_of)) &&
           (!target || bindings_.has(condition.target->name)) &&
           std::all_of(condition.operands.begin(), condition.operands.end(),
                       [this](const Condition& operand) { return isBound(operand); });
  }

  void measure(const EvidenceLine& line, EvidenceStep& step) {
    if (line.kind == EvidenceLine::Kind::Test) {
      step.holds = evaluator_.holds(line.measure);
      step.log_odds = *step.holds ? line.weight : 0;
      if (*step.holds) noteUse(line.constant + 1);
      return;
    }
    const auto value = evaluator_.measure(line.measure, reachOf(line));
    if (!value) return noteUse(line.constant);
    noteUses(line, *value);
    step.measured = *value;
    step.unit = evaluator_.unitOf(line.measure);
    step.log_odds = logOddsOf(line, *value);
  }

  /// Of the knots on both sides: as long as these stay, the value lies between them.
  void noteUses(const EvidenceLine& line, double value) const {
    const auto count = static_cast<std::uint32_t>(line.knots.size());
    if (line.kind != EvidenceLine::Kind::Curve) return noteUse(line.constant + 1);
    const auto above = static_cast<std::uint32_t>(knotAbove(line.knots, value));
    if (above > 0) noteUse(line.constant + above);
    if (above < count) noteUse(line.constant + above + 1);
  }

  const ReasoningState& state_;
  const Rule& rule_;
  const Bindings& bindings_;
  ConditionEvaluator evaluator_;
};

bool mentionsWhole(const Condition& condition) {
  return condition.of == kWholeCandidate ||
         std::any_of(condition.operands.begin(), condition.operands.end(),
                     [](const Condition& operand) { return mentionsWhole(operand); });
}

bool mentionsWhole(const Rule& rule, const AcceptLeaf& accept) {
  const auto mentions = [](const EvidenceLine& line) { return mentionsWhole(line.measure); };
  return std::any_of(rule.evidence.begin(), rule.evidence.end(), mentions) ||
         std::any_of(accept.evidence.begin(), accept.evidence.end(), mentions);
}

/// The bindings and, under one more name, all parts of the candidate.
Bindings withWhole(const ReasoningState& state, const AcceptLeaf& accept, const Bindings& bindings) {
  std::vector<FragmentIndex> all;
  for (const auto& [name, part_class] : accept.parts) {
    const auto& fragments = bindings.at(name).fragments;
    all.insert(all.end(), fragments.begin(), fragments.end());
  }
  Bindings more = bindings;
  more.candidates.emplace_back(kWholeCandidate, state.fragments.candidateOf(std::move(all)));
  return more;
}

}  // namespace

double reachOf(const EvidenceLine& line) {
  return line.kind == EvidenceLine::Kind::Curve ? line.knots.back().at : line.about + 4 * line.spread;
}

double logOdds(double probability) {
  const double p = std::clamp(probability, 0.0001, 0.9999);
  return std::log(p / (1 - p));
}

double probabilityOf(double log_odds) {
  return 1 / (1 + std::exp(-log_odds));
}

double logOddsOf(const EvidenceLine& line, double value) {
  if (line.kind == EvidenceLine::Kind::Curve) return onCurve(line.knots, value);
  const double distance = (value - line.about) / line.spread;
  return line.weight * std::exp(-distance * distance / 2);
}

void weigh(const ReasoningState& state, const Rule& rule, const AcceptLeaf& accept, const Bindings& bindings,
           Decision& decision) {
  const double confidence = std::clamp(confidenceOf(accept.confidence, bindings), 0.0, 1.0);
  EvidenceStep prior;
  prior.measured = confidence;
  if (state.context.keeps_paths) {
    prior.text = "the rule's confidence";
    prior.file = accept.confidence.high_at.file;
  }
  prior.line = accept.confidence.high_at.line;
  prior.log_odds = decision.log_odds = logOdds(confidence);
  decision.evidence = {std::move(prior)};
  const Bindings with_whole = mentionsWhole(rule, accept) ? withWhole(state, accept, bindings) : bindings;
  Weighing weighing(state, rule, with_whole);
  weighing.noteUse(accept.constant);
  for (const std::vector<EvidenceLine>* lines : {&rule.evidence, &accept.evidence})
    for (const EvidenceLine& line : *lines) {
      decision.evidence.push_back(weighing.of(line));
      decision.log_odds += decision.evidence.back().log_odds;
    }
  decision.probability = decision.evidence.size() == 1 ? confidence : probabilityOf(decision.log_odds);
}

}  // namespace cluxel::rules
