// SPDX-License-Identifier: Apache-2.0
// Finds the keys of a rule of which solutions may differ after a change.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <unordered_map>
#include <vector>

#include "mapping/inference/read_test.hpp"
#include "mapping/inference/rule_evaluation.hpp"

namespace cluxel::mapping {

/// A fact that a rule sees now and did not see before the change, or the other way round.
struct SeenChange {
  rdf::Triple fact;
  bool is_fact = false;  ///< now, of some stage
};

class AffectedKeys {
 public:
  AffectedKeys(rdf::WriteTransaction& transaction, const rdf::StagedFacts& facts, rdf::TermId inferred,
               const RuleShape& shape, const ReadTest& reads, const rdf::InferenceCheck& check)
      : transaction_(transaction), facts_(facts), inferred_(inferred), shape_(shape), reads_(reads), check_(check) {}

  /// A superset of the keys of which solutions differ when these facts have come to be or ceased to be; sorted. The
  /// store must hold the facts as they are now. None: it may be any key.
  std::optional<std::vector<rdf::TermId>> of(const std::vector<SeenChange>& changed);

 private:
  std::optional<bool> goesBySubject(std::size_t read) const;
  bool mayBind(ast::VariableIndex variable, rdf::TermId value);
  bool hasConstants(ast::VariableIndex variable, rdf::TermId value) const;
  bool mayMatch(std::size_t read, const rdf::Triple& fact);
  std::vector<rdf::QuadIds> goneAmong(const std::vector<SeenChange>& changed);
  void addConnected(const rdf::Triple& fact, std::size_t read, std::set<rdf::TermId>& reached) const;

  rdf::WriteTransaction& transaction_;
  const rdf::StagedFacts& facts_;
  rdf::TermId inferred_;
  const RuleShape& shape_;
  const ReadTest& reads_;
  const rdf::InferenceCheck& check_;
  std::unordered_map<std::uint64_t, bool> may_bind_;  ///< of variable and value
};

}  // namespace cluxel::mapping
