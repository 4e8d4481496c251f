// SPDX-License-Identifier: Apache-2.0
// One change of a map on its way through the closure and through the rules.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "mapping/inference/affected_keys.hpp"
#include "mapping/inference/inference_graphs.hpp"
#include "mapping/inference/inference_properties.hpp"
#include "mapping/inference/inference_record.hpp"
#include "mapping/inference/read_test.hpp"
#include "mapping/inference/rule_evaluation.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rdf/ontology/staged_closure.hpp"

namespace cluxel::mapping {

struct ChangedQuad {
  rdf::QuadIds quad;
  bool is_added = false;
};

class ChangeInference {
 public:
  ChangeInference(rdf::WriteTransaction& transaction, const InferenceGraphs& graphs, InferenceRecord& record,
                  const rdf::InferenceCheck& check);

  /// Each of these returns false when the change cannot be followed.
  bool followStated(const rdf::QuadDifference& change, const std::vector<RuleShape>& rules);
  /// `rounds`: see InferenceRecord.
  bool followRule(rdf::Stage stage, const RuleShape& shape, Outputs& outputs, std::uint32_t& rounds);
  void finish();

  std::vector<WholeRule> takeWhole() { return std::move(whole_); }  ///< rules that were evaluated for the whole map
  std::vector<std::string> ignored() const;

 private:
  using Facts = std::unordered_set<rdf::Triple, rdf::TripleHash>;
  /// What may rest on something that is gone.
  struct Suspects {
    Facts taken;  ///< the rule does not derive them any more, until they are found again
    Facts gone;   ///< facts that the rule read and does not see any more
    std::set<rdf::TermId> keys;
  };

  rdf::ClosureLimits limits() const;
  std::vector<rdf::TermId> allGraphs() const;
  void write();
  std::vector<ChangedQuad> statedOrWithdrawn(const rdf::QuadDifference& change,
                                             const InferenceProperties& properties) const;
  bool isStatedBeside(std::span<const ChangedQuad> of_fact, rdf::PrefixLookup& stored) const;
  bool touchesDerivations(const rdf::QuadDifference& change) const;

  // A rule sees the facts of stages before `end`: its own stage, or the next one when it reads what it derives.
  bool replaceAffected(rdf::Stage stage, const RuleShape& shape, Outputs& outputs, Facts& gone);
  bool takeAwaySuspects(rdf::Stage stage, const RuleShape& shape, Outputs& outputs, Suspects& suspects);
  bool deriveOn(rdf::Stage stage, const RuleShape& shape, Outputs& outputs, Suspects suspects, std::uint32_t& rounds);
  std::optional<Outputs> solutions(rdf::Stage end, const RuleShape& shape, const ReadTest& reads,
                                   const std::optional<std::vector<rdf::TermId>>& keys);
  std::vector<rdf::QuadIds> unseen(rdf::Stage end, const ReadTest& reads) const;
  std::vector<SeenChange> seenChanges(rdf::Stage end, const ReadTest& reads) const;
  bool isSeen(rdf::Stage end, const SeenChange& change) const;
  bool isOtherBefore(rdf::Stage end, const rdf::Triple& fact) const;
  void addOtherBases(rdf::Stage stage, const Outputs& outputs, std::vector<rdf::Triple>& touched) const;
  void setBases(rdf::Stage stage, const RuleShape& shape, std::vector<rdf::Triple> touched, const Outputs& outputs);
  bool isExcluded(const rdf::Triple& fact) const;
  bool feedsItself(rdf::Stage stage, const ReadTest& reads) const;
  bool hasFedItself(rdf::Stage stage, const ReadTest& reads) const;

  rdf::WriteTransaction& transaction_;
  const InferenceGraphs& graphs_;
  InferenceRecord& record_;
  const rdf::InferenceCheck& check_;
  rdf::QuadReader reader_;
  rdf::SchemaWords words_;
  rdf::ClosureBounds bounds_;
  rdf::Schema schema_;
  rdf::StagedFacts facts_;
  std::unordered_map<rdf::TermId, std::vector<SeenChange>> plain_;  ///< changes of properties that are only read
  rdf::StagedClosure closure_;
  /// Facts that statements ruled out before the change and not any more, or the other way round; sorted.
  std::vector<rdf::Triple> reconsidered_;
  std::vector<WholeRule> whole_;
};

}  // namespace cluxel::mapping
