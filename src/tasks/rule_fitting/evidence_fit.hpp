// SPDX-License-Identifier: Apache-2.0
// Learns the numbers of evidence from candidates with known truth: one logistic regression for each rule.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tasks/rule_fitting/candidate_examples.hpp"

namespace cluxel::tasks {

struct EvidenceFitParams {
  std::size_t min_examples = 10;  ///< right ones, and as many wrong ones
  double ridge = 4;               ///< pulls log-odds to 0: as much as this many examples
  int resamples = 40;             ///< of the bootstrap over places
  double interval = 0.8;          ///< a number is changed when this interval of its resamples excludes the old one
  std::uint64_t seed = 1;
};

/// A number of a rule file with what the data says of it.
struct FittedNumber {
  SourceLocation at;
  std::string what;  ///< in words: "roughness of pole at 0.05 m"
  double before = 0, after = 0;
  double low = 0, high = 0;  ///< the interval
  bool is_share = false;     ///< a confidence, written as 0.85; else log-odds
};

struct FittedRule {
  std::string rule_id;
  std::size_t right = 0, wrong = 0;
  std::string refusal;     ///< why nothing was learned; else empty
  bool is_fitted = false;  ///< some numbers were estimated
  std::size_t kept = 0;    ///< numbers left as they are, because definitions share them with other rules
  double loss_before = 0, loss_after = 0;  ///< mean log loss on places left out of the fit, in turn; 0 if not tested
  std::vector<FittedNumber> changes;
};

/// When the truth of some map names a class, maps whose truth does not are left out for that class: what they call a
/// small object may be a person. A rule stays as it is when it has fewer than `min_examples` candidates, or its class
/// has fewer right ones, or when the new numbers have a greater loss on places left out, or when there is only one
/// place. When the rule has fewer right or wrong candidates, only its confidence is fitted. Leaves of a rule that use
/// one definition are fitted together. A number of a definition that several rules use is kept as it is, because the
/// best value for one rule may be wrong for another. One entry for each rule that proposed a candidate, in the order of
/// the rule set. Deterministic for a seed.
std::vector<FittedRule> fitEvidence(const rules::RuleSet& rules, const std::vector<CandidateExample>& examples,
                                    const EvidenceFitParams& params);

}  // namespace cluxel::tasks
