// SPDX-License-Identifier: Apache-2.0
// Mutation testing of rules: which small errors in a rule would the tests find?
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rules/testing/rule_test.hpp"

namespace cluxel::rules {

/// One small error put into a rule.
struct RuleMutant {
  std::string rule_id;
  SourceLocation at;
  std::string what;       ///< in words: "height of trunk >= 2 m: threshold doubled"
  std::string killed_by;  ///< the first test that fails with it; empty: it survived
};

struct RuleMutationReport {
  std::vector<RuleMutant> mutants;  ///< in the order of the rules
  std::vector<std::string> rules;   ///< ids of all rules of the files at hand
  std::size_t killed() const;
  /// Killed mutants over all; 1 without mutants.
  double score() const;
  /// Rules without a mutant that a test noticed. A mutant of a definition belongs to the first rule that uses it.
  std::vector<std::string> untouchedRules() const;
};

/// Mutants: a threshold halved or doubled, a comparison reversed, `all` and `any` exchanged, a line of evidence
/// without weight, yes and no (found and missing) of a node exchanged. An error in a definition is one mutant. Only
/// rules of the files that the test file names, not of those that they include. Each mutant runs against the tests that
/// reach its rule and pass without it, until one fails. Deterministic. Cost: some milliseconds for each mutant and
/// test.
RuleMutationReport mutateRules(const std::filesystem::path& file, const ClassCatalogue& catalogue,
                               const RuleTestOptions& options, unsigned threads);

/// The survivors by rule, the rules that no mutant touches, then the score.
std::string textOf(const RuleMutationReport& report);
std::string jsonOf(const RuleMutationReport& report);

}  // namespace cluxel::rules
