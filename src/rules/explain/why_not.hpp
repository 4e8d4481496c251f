// SPDX-License-Identifier: Apache-2.0
// Why a thing is not of a certain class: the rule of that class that comes nearest, and what is missing.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rules/explain/explain.hpp"
#include "rules/propose/consideration.hpp"

namespace cluxel::rules {

/// How a rule of the class fared. Better ones have smaller values.
enum class Nearness : std::uint8_t {
  Accepted,    ///< its tree accepts: other classes were stronger, or came first
  Changeable,  ///< the measured values of one branch would have to change
  Rejected,    ///< a branch rejects, and no change of a measured value would reverse it
  NoSeed,      ///< the tests of a seed fail
  OtherLabel,  ///< the rule begins with primitives of another label
};
std::string_view nameOf(Nearness nearness);

struct RuleVerdict {
  Nearness nearness = Nearness::OtherLabel;
  std::string class_iri;
  Decision decision;
  std::optional<Counterfactual> counterfactual;  ///< what would make it accept, or make the primitive a seed
  std::optional<RivalNote> winner;               ///< of Accepted: who took the thing
  double behind = 0;                             ///< log-odds that it lost by; below 0 when it only came later

  /// Whether the thing is of the class already, by this rule.
  bool madeThing() const { return winner && winner->rule_id == decision.rule_id; }
};

struct WhyNot {
  std::string class_iri;
  std::vector<RuleVerdict> rules;  ///< the one that made the thing, then the nearest first
};

/// Ranks what the rules of the class say of a thing (considerFor()). `owner` is the thing when it is an object, else
/// what owns it, and null when nothing does; `made` is the run that made it.
WhyNot whyNot(std::vector<Consideration> said, const RuleSet& rules, const ReasoningResult& made,
              const SemanticObject* owner, const std::string& class_iri);

std::string textOf(const WhyNot& why, const RuleSet& rules);
std::string jsonOf(const WhyNot& why, const RuleSet& rules);

}  // namespace cluxel::rules
