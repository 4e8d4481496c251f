// SPDX-License-Identifier: Apache-2.0
// State of one run of the reasoning stage: fragments, objects under construction, and indexes of the scene.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "rules/decide/reason.hpp"
#include "rules/decide/trace_recorder.hpp"
#include "rules/propose/cluxel_grid.hpp"
#include "rules/propose/first_winners.hpp"
#include "rules/propose/fragment_table.hpp"
#include "rules/propose/rule_texts.hpp"

namespace cluxel::rules {

class ChangedValues;

/// The candidates bound to names on a path through a tree, in binding order.
struct Bindings {
  std::vector<std::pair<std::string, Candidate>> candidates;
  const ChangedValues* changed = nullptr;  ///< values that count instead of the measured ones; null: none

  const Candidate& at(const std::string& name) const;
  Candidate* find(const std::string& name);
  bool holds(FragmentIndex fragment) const;
  bool has(const std::string& name) const;
};

struct PartInMaking {
  std::string name;        ///< the bound name
  std::string part_class;  ///< IRI
  std::vector<FragmentIndex> fragments;
  bool is_outdated = false;  ///< fragments changed since the bound candidate of this name was measured
};

struct ObjectInMaking {
  const Rule* rule = nullptr;
  std::size_t class_number = 0;  ///< in RuleSet::order
  const AcceptLeaf* leaf = nullptr;
  double confidence = 0;
  std::size_t decision = 0;
  std::vector<PartInMaking> parts;
  Bindings bindings;  ///< needed by absorbing, which measures candidates anew whose parts changed
  /// A hash of how it came about and grew. Of the one object of a class (`merge_into: class`) only the class's, and no
  /// members: it reaches through the whole map.
  std::uint64_t trace = 0;
  MemberSet members = kNobody;  ///< its primitives, when members of steps are kept
  bool may_gather = false;      ///< its share of a crown was split from that of others, and it gathered nothing since

  /// Whether it is the one object of its class.
  bool isOfWholeClass() const { return leaf->merge_into == MergeInto::Class; }
};

struct ReasoningState {
  ReasoningState(const perception::Scene& scene_, const RuleSet& rules_, const ReasoningContext& context_);
  ReasoningState(const perception::Scene&, const RuleSet&, ReasoningContext&&) = delete;  // the context is kept

  const perception::Scene& scene;
  const RuleSet& rules;
  const ReasoningContext& context;
  CluxelGrid grid;
  FragmentTable fragments;
  TraceRecorder trace;
  std::vector<ObjectInMaking> objects;
  std::map<FragmentIndex, std::vector<OwnerIndex>> claims;  ///< the objects that claim a shared fragment
  std::vector<Decision> decisions;
  /// For each primitive the relations that lead to it, as numbers in scene.relations.
  std::vector<std::vector<std::uint32_t>> relations_to;
  /// For each class the classes of the rule order that are it or below it, by their place there.
  std::map<std::string, std::vector<bool>, std::less<>> classes_below;
  /// What won the first round of the stratum; null in the first round, and where no evidence asks for it.
  std::shared_ptr<const FirstWinners> first_winners;
  std::shared_ptr<const RuleTexts> texts;  ///< shared by copies of the state
  bool is_first_of_two_rounds = false;     ///< its outcome is only read by the second round

  /// Threads for what only reads the state. Queries are asked from one thread.
  unsigned threads() const { return rules.asks_map ? 1 : context.threads; }
  bool belongsTo(FragmentIndex fragment, const std::string& class_iri) const;
  /// Null when no class of the rule order is `class_iri` or below it. Valid as long as the state.
  const std::vector<bool>* classesBelow(std::string_view class_iri) const;
  /// The same as belongsTo() with the classes looked up before; `classes` may be null.
  bool belongsToAny(FragmentIndex fragment, const std::vector<bool>* classes) const;
  /// Changes of fragments, which are noted in the trace of the primitive.
  void setOwner(FragmentIndex fragment, OwnerIndex owner);
  std::vector<FragmentIndex> cut(FragmentIndex fragment, std::vector<std::vector<std::uint32_t>> parts);
  void join(FragmentIndex fragment, const std::vector<FragmentIndex>& others);
  /// The primitives of the fragments; kNobody when members of steps are not kept.
  MemberSet membersOf(std::span<const FragmentIndex> some);
  /// Notes that a thing becomes part of an object, or was considered for it.
  void noteGrowth(ObjectInMaking& object, std::uint64_t what, MemberSet added);

  /// The fragments of an object, ascending.
  std::vector<FragmentIndex> fragmentsOf(const ObjectInMaking& object) const;
};

}  // namespace cluxel::rules
