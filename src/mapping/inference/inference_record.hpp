// SPDX-License-Identifier: Apache-2.0
// What an inference stores beside its facts, so that the next one can follow a change of the map.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mapping/inference/rule_evaluation.hpp"
#include "mapping/inference/whole_rules.hpp"
#include "rdf/store/quad_journal.hpp"

namespace cluxel::mapping {

/// A rule that reads what it derives is evaluated at most so many times: one that makes new things of its own things
/// would never end.
inline constexpr std::uint32_t kMaxRounds = 1000;

struct InferenceRecord {
  std::vector<Outputs> outputs;  ///< of each rule, sorted
  /// Of each rule: an inference from scratch evaluates it at most so many times more, because it reads what it derives.
  std::vector<std::uint32_t> rounds;
  std::vector<rdf::LateFact> late;  ///< sorted
  /// What rules may derive and statements rule out (excludedTypes()); sorted. `outputs` has it all the same.
  std::vector<rdf::Triple> excluded;
  std::string reason;  ///< why a change cannot be followed: a rule and what is wrong with it; empty when it can
  std::vector<WholeRule> whole;  ///< of this inference; it is not stored
};

/// Stores the record with a sum of all quads outside of the history as they are now.
void storeInferenceRecord(rdf::WriteTransaction& transaction, const InferenceRecord& record,
                          const std::vector<NamedText>& rules);
/// The record that belongs to these rules and this sum of the quads, else none.
std::optional<InferenceRecord> storedInferenceRecord(const rdf::ReadTransaction& transaction,
                                                     const std::vector<NamedText>& rules, const rdf::EntrySum& sum);

}  // namespace cluxel::mapping
