// SPDX-License-Identifier: Apache-2.0
// Candidates that rules propose in maps with known truth: what evidence says of them, and whether they are right.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mapping/map_reader.hpp"
#include "rules/language/rule_set.hpp"
#include "tasks/evaluation/truth_source.hpp"

namespace cluxel::tasks {

/// What is measured of a candidate besides its evidence: for tables.
struct NamedValue {
  std::string name;
  double value = 0;
};

struct CandidateExample {
  std::string rule_id;
  std::size_t leaf = 0;     ///< its number in Rule::nodes
  std::string place;        ///< the scan that its first cluxel was seeded in
  std::string class_iri;    ///< the rule's class
  bool is_named = false;    ///< the truth names the class, or one below it; else it counts as another one
  bool is_right = false;    ///< most of its points are of the rule's class, or of what it counts as
  std::string truth_class;  ///< of most of its points with truth
  double points = 0;        ///< with truth
  double confidence = 0;    ///< the leaf's, as log-odds
  double log_odds = 0;      ///< with all evidence
  /// One for each line of the rule's and then of the leaf's evidence: what it measures, 1 or 0 for a test, absent where
  /// it could not be measured.
  std::vector<std::optional<double>> values;
  std::vector<NamedValue> attributes;  ///< only when asked for
};

/// Runs the rules on the map's scene. Candidates are left out when less than half of their points have truth, when and
/// when the truth has no class that the rule's class counts as.
std::vector<CandidateExample> candidateExamples(const mapping::MapReader& map, const rules::RuleSet& rules,
                                                const TruthSource& truth, bool with_attributes);

}  // namespace cluxel::tasks
