// SPDX-License-Identifier: Apache-2.0
// The reasoning stage: primitives and rules in, objects with reasons out.
#pragma once

#include <functional>
#include <vector>

#include "perception/segments/scene.hpp"
#include "rules/ask_oracle.hpp"
#include "rules/language/rule_set.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::rules {

class KnownSplits;
class ThresholdMargins;
struct ReasoningState;
struct Rule;
struct Verdict;

/// Called for every candidate that a rule proposes, when it proposes it first.
using CandidateObserver = std::function<void(const ReasoningState&, const Rule&, const Verdict&)>;

struct ReasoningContext {
  /// Answers `ask:` tests. May be null for rule sets without them; else such a test throws Error.
  AskOracle* oracle = nullptr;
  /// Ascending. Decisions about these primitives also report what would have changed them (Decision::flips).
  std::vector<perception::PrimitiveIndex> probes = {};
  CandidateObserver onCandidate = {};
  unsigned threads = 1;                 ///< the result is the same for every number
  KnownSplits* splits = nullptr;        ///< saves work; the result is the same without
  ThresholdMargins* margins = nullptr;  ///< gets all tests of the run
  /// False when nobody reads how decisions were taken: then Decision has no path, evidence, reason or hint. All else is
  /// the same, also the traces.
  bool keeps_paths = true;
};

/// Groups the primitives of a scene into objects, class by class in the order of the rule set. The objects' cluxels are
/// disjoint. The result depends on the primitives' ids and measures and not on their order. Cost roughly linear in
/// cluxels and edges. Throws InputError for a faulty query of an `ask:`.
ReasoningResult reason(const perception::Scene& scene, const RuleSet& rules, const ReasoningContext& context = {});

}  // namespace cluxel::rules
