// SPDX-License-Identifier: Apache-2.0
// Finds the keys of a rule of which solutions may differ after a change.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "mapping/inference/key_steps.hpp"
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
               const RuleShape& shape, const ReadTest& reads, const rdf::InferenceCheck& check);

  /// A superset of the keys of which solutions differ when these facts have come to be or ceased to be; sorted. The
  /// store must hold the facts as they are now. `gone`: facts, among others perhaps, that solutions before the change
  /// may have had and that have ceased to be. None: it may be any key. To be called once.
  std::optional<std::vector<rdf::TermId>> of(std::span<const SeenChange> changed, std::span<const SeenChange> gone);

 private:
  using Link = std::array<rdf::TermId, 3>;  ///< property and both ends
  void noteGone(std::span<const SeenChange> changed);
  std::optional<bool> goesBySubject(std::size_t read) const;
  bool mayBind(ast::VariableIndex variable, rdf::TermId value);
  bool hasConstants(ast::VariableIndex variable, rdf::TermId value) const;
  bool mayMatch(std::size_t read, const rdf::Triple& fact);
  bool reachEnds(std::span<const SeenChange> changed);
  void addConnected(const rdf::Triple& fact, std::size_t read, std::set<rdf::TermId>& connected) const;
  void reach(ast::VariableIndex variable, rdf::TermId value);
  void follow();
  void take(const KeyStep& step, rdf::TermId value);
  void addKeysOfOthers();
  std::vector<rdf::QuadIds> goneOfSolutions();

  rdf::WriteTransaction& transaction_;
  const rdf::StagedFacts& facts_;
  rdf::TermId inferred_;
  const RuleShape& shape_;
  const ReadTest& reads_;
  const rdf::InferenceCheck& check_;
  rdf::QuadReader reader_;
  std::map<ast::VariableIndex, std::vector<KeyStep>> steps_;
  std::vector<rdf::Triple> gone_;                     ///< what has ceased to be; sorted
  std::vector<Link> gone_objects_;                    ///< of the properties of steps, by their subjects; sorted
  std::vector<Link> gone_subjects_;                   ///< the same by their objects
  std::unordered_map<std::uint64_t, bool> may_bind_;  ///< of variable and value
  std::map<ast::VariableIndex, std::set<rdf::TermId>> reached_;
  std::vector<std::pair<ast::VariableIndex, rdf::TermId>> open_;  ///< reached, and not followed yet
};

}  // namespace cluxel::mapping
