// SPDX-License-Identifier: Apache-2.0
// Look-ups shared by all steps of the reasoning stage.
#include "rules/decide/reasoning_state.hpp"

#include <algorithm>
#include <stdexcept>

namespace cluxel::rules {

const Candidate& Bindings::at(const std::string& name) const {
  for (const auto& [bound, candidate] : candidates)
    if (bound == name) return candidate;
  throw std::logic_error("a rule uses the unbound name " + name);
}

Candidate* Bindings::find(const std::string& name) {
  for (auto& [bound, candidate] : candidates)
    if (bound == name) return &candidate;
  return nullptr;
}

bool Bindings::holds(FragmentIndex fragment) const {
  return std::any_of(candidates.begin(), candidates.end(), [&](const auto& entry) {
    return std::binary_search(entry.second.fragments.begin(), entry.second.fragments.end(), fragment);
  });
}

bool Bindings::has(const std::string& name) const {
  return std::any_of(candidates.begin(), candidates.end(), [&](const auto& entry) { return entry.first == name; });
}

ReasoningState::ReasoningState(const perception::Scene& scene_, const RuleSet& rules_, const ReasoningContext& context_)
    : scene(scene_),
      rules(rules_),
      context(context_),
      grid(scene_.cluxels),
      fragments(scene_, context_.threads),
      trace(scene_.primitives.size()),
      texts(std::make_shared<const RuleTexts>(rules_)) {
  relations_to.resize(scene.primitives.size());
  for (std::uint32_t i = 0; i < scene.relations.size(); ++i) relations_to[scene.relations[i].to].push_back(i);
  std::vector<std::string> classes = rules.order;
  for (const ClassEntry& entry : rules.catalogue.classes) classes.push_back(entry.iri);
  for (std::size_t i = 0; i < rules.order.size(); ++i)
    for (const std::string& ancestor : classes) {
      if (!rules.catalogue.isA(rules.order[i], ancestor)) continue;
      std::vector<bool>& below = classes_below[ancestor];
      below.resize(rules.order.size(), false);
      below[i] = true;
    }
}

const std::vector<bool>* ReasoningState::classesBelow(std::string_view class_iri) const {
  const auto found = classes_below.find(class_iri);
  return found == classes_below.end() ? nullptr : &found->second;
}

bool ReasoningState::belongsToAny(FragmentIndex fragment, const std::vector<bool>* classes) const {
  if (classes == nullptr) return false;
  const OwnerIndex owner = fragments[fragment].owner;
  if (owner < objects.size()) return (*classes)[objects[owner].class_number];
  if (owner != kShared) return false;
  const auto claim = claims.find(fragment);
  return claim != claims.end() && (*classes)[objects[claim->second.front()].class_number];
}

bool ReasoningState::belongsTo(FragmentIndex fragment, const std::string& class_iri) const {
  return belongsToAny(fragment, classesBelow(class_iri));
}

void ReasoningState::setOwner(FragmentIndex fragment, OwnerIndex owner) {
  fragments.setOwner(fragment, owner);
  const std::uint64_t state = owner < kUnknown ? 0 : std::uint64_t{owner};  // the object's own trace tells whose it is
  trace.note(fragments[fragment].primitive, mixed(StepKind::Owned, mixed(state, fragments.hashOf(fragment))));
}

std::vector<FragmentIndex> ReasoningState::cut(FragmentIndex fragment, std::vector<std::vector<std::uint32_t>> parts) {
  const std::uint64_t before = fragments.hashOf(fragment);
  std::vector<FragmentIndex> made = fragments.cut(fragment, std::move(parts));
  trace.note(fragments[fragment].primitive, mixed(StepKind::Cut, mixed(before, fragments.hashOf(made))));
  return made;
}

void ReasoningState::join(FragmentIndex fragment, const std::vector<FragmentIndex>& others) {
  if (others.empty()) return;
  const std::uint64_t before = fragments.hashOf(fragment);
  fragments.join(fragment, others);
  trace.note(fragments[fragment].primitive, mixed(StepKind::Joined, mixed(before, fragments.hashOf(fragment))));
}

MemberSet ReasoningState::membersOf(std::span<const FragmentIndex> some) {
  if (!trace.keepsMembers()) return kNobody;
  std::vector<MemberSet> members;
  for (const FragmentIndex fragment : some) members.push_back(fragments[fragment].primitive);
  return trace.unionOf(std::move(members));
}

void ReasoningState::noteGrowth(ObjectInMaking& object, std::uint64_t what, MemberSet added) {
  if (object.isOfWholeClass()) return;
  object.trace = mixed(object.trace, what);
  object.members = trace.unionOf(object.members, added);
}

std::vector<FragmentIndex> ReasoningState::fragmentsOf(const ObjectInMaking& object) const {
  std::vector<FragmentIndex> all;
  for (const PartInMaking& part : object.parts) all.insert(all.end(), part.fragments.begin(), part.fragments.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

}  // namespace cluxel::rules
