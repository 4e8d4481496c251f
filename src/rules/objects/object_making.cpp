// SPDX-License-Identifier: Apache-2.0
// Gives accepted candidates their fragments.
#include "rules/objects/object_making.hpp"

#include <algorithm>

namespace cluxel::rules {

namespace {

/// Notes that `added` are now part of the object. All of it and the members of the verdict are members of this step.
void noteMembers(ReasoningState& state, ObjectInMaking& object, const Verdict& verdict, MemberSet added) {
  state.trace.keep(state.trace.unionOf(object.members, state.trace.setOf(verdict.members)));
  state.noteGrowth(object, verdict.trace, added);
  state.trace.noteStep(verdict.members, mixed(StepKind::Merged, mixed(object.trace, verdict.trace)));
}

}  // namespace

void joinRelated(ReasoningState& state, const Rule& rule, OwnerIndex related, const Verdict& verdict,
                 const std::vector<FragmentIndex>& group) {
  const std::pair<std::string, std::string>& as = verdict.accept->parts.front();
  ObjectInMaking& object = state.objects[related];
  auto part = std::find_if(object.parts.begin(), object.parts.end(),
                           [&as](const PartInMaking& known) { return known.part_class == as.second; });
  if (part == object.parts.end() && as.second == rule.class_iri) part = object.parts.begin();
  if (part == object.parts.end()) part = object.parts.insert(part, PartInMaking{as.first, as.second, {}, false});
  for (FragmentIndex fragment : group) {
    state.setOwner(fragment, related);
    part->fragments.push_back(fragment);
  }
  noteMembers(state, object, verdict, state.membersOf(group));
  part->is_outdated = true;
}

void makeObject(ReasoningState& state, const Rule& rule, Verdict verdict) {
  const AcceptLeaf& accept = *verdict.accept;
  Bindings& bindings = verdict.bindings;
  const auto number = static_cast<OwnerIndex>(state.objects.size());
  ObjectInMaking object;
  object.rule = &rule;
  const std::vector<std::string>& order = state.rules.order;
  object.class_number = static_cast<std::size_t>(std::find(order.begin(), order.end(), rule.class_iri) - order.begin());
  object.leaf = &accept;
  object.confidence = state.decisions.back().probability;
  object.decision = state.decisions.size() - 1;
  object.trace = hashOf(rule.class_iri);
  std::vector<FragmentIndex> taken;
  for (const auto& [name, part_class] : accept.parts) {
    PartInMaking part{name, part_class, {}, false};
    const bool shared = accept.splitting && accept.splitting->part == name;
    for (FragmentIndex fragment : bindings.at(name).fragments) {
      const OwnerIndex owner = state.fragments[fragment].owner;
      if (shared && (owner == kFree || owner == kShared)) {
        state.setOwner(fragment, kShared);
        state.claims[fragment].push_back(number);
      } else if (owner == kFree) {
        state.setOwner(fragment, number);
        part.fragments.push_back(fragment);
      }
    }
    taken.insert(taken.end(), part.fragments.begin(), part.fragments.end());
    object.parts.push_back(std::move(part));
  }
  noteMembers(state, object, verdict, state.membersOf(taken));
  object.bindings = std::move(bindings);
  state.objects.push_back(std::move(object));
}

}  // namespace cluxel::rules
