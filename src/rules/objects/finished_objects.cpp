// SPDX-License-Identifier: Apache-2.0
// Turns objects under construction into results: parts with primitives and cluxels, and ids.
#include "rules/objects/finished_objects.hpp"

#include <algorithm>
#include <type_traits>

#include "base/parallel.hpp"
#include "base/radix_order.hpp"

namespace cluxel::rules {

namespace {

std::vector<ObjectPart> finishedParts(const ReasoningState& state, const ObjectInMaking& object) {
  std::vector<ObjectPart> parts;
  for (const PartInMaking& making : object.parts) {
    if (making.fragments.empty()) continue;
    auto part = std::find_if(parts.begin(), parts.end(),
                             [&](const ObjectPart& known) { return known.part_class == making.part_class; });
    if (part == parts.end()) part = parts.insert(parts.end(), ObjectPart{making.part_class, {}, {}});
    for (FragmentIndex fragment : making.fragments) {
      part->primitives.push_back(state.fragments[fragment].primitive);
      const auto& cluxels = state.fragments[fragment].cluxels;
      part->cluxels.insert(part->cluxels.end(), cluxels.begin(), cluxels.end());
    }
  }
  for (ObjectPart& part : parts) {
    std::sort(part.primitives.begin(), part.primitives.end());
    part.primitives.erase(std::unique(part.primitives.begin(), part.primitives.end()), part.primitives.end());
    sortNumbers(part.cluxels);
  }
  std::sort(parts.begin(), parts.end(),
            [](const ObjectPart& a, const ObjectPart& b) { return a.part_class < b.part_class; });
  return parts;
}

/// A class-wide object is told by the surest leaf of its class: which candidate came first depends on what lies far
/// away.
void tellByText(const RuleSet& rules, SemanticObject& object) {
  double surest = -1;
  for (const Rule& rule : rules.rules) {
    if (rule.class_iri != object.class_iri) continue;
    for (const TreeNode& node : rule.nodes) {
      const auto* accept = std::get_if<AcceptLeaf>(&node.what);
      if (accept == nullptr || accept->merge_into != MergeInto::Class || accept->confidence.high <= surest) continue;
      surest = object.confidence = accept->confidence.high;
      object.rule_id = rule.id;
    }
  }
}

/// Whether the leaf that made the object merges all that it accepts.
bool isClassWide(const ReasoningState& state, const ObjectInMaking& object) {
  const auto* accept = std::get_if<AcceptLeaf>(&object.rule->nodes[state.decisions[object.decision].leaf].what);
  return accept != nullptr && accept->merge_into == MergeInto::Class;
}

}  // namespace

ContentHash idOfClassWide(const std::string& class_iri) {
  return ContentHasher().addText(class_iri).addText("class-wide").finish();
}

ContentHash idOf(const perception::Scene& scene, const SemanticObject& object) {
  if (object.is_class_wide) return idOfClassWide(object.class_iri);
  std::vector<std::uint64_t> members;  // scan and point, which sort as pairs do
  for (const ObjectPart& part : object.parts)
    for (const std::uint32_t cluxel : part.cluxels)
      members.push_back(std::uint64_t{scene.cluxels.seed[cluxel].scan} << 32U | scene.cluxels.seed[cluxel].point);
  std::sort(members.begin(), members.end());
  struct Member {
    ContentHash scan;
    std::uint32_t point;
  };
  static_assert(std::has_unique_object_representations_v<Member>);
  std::vector<Member> named;  // the hasher is called once: a call for each costs as much as the hashing
  named.reserve(members.size());
  for (const std::uint64_t member : members)
    named.push_back({scene.cluxels.scans[member >> 32U], static_cast<std::uint32_t>(member)});
  return ContentHasher().addText(object.class_iri).addBytes(named.data(), named.size() * sizeof(Member)).finish();
}

namespace {

SemanticObject finishedObject(const ReasoningState& state, const ObjectInMaking& making) {
  SemanticObject object;
  object.class_iri = making.rule->class_iri;
  object.confidence = making.confidence;
  object.rule_id = making.rule->id;
  object.decision = making.decision;
  object.is_class_wide = isClassWide(state, making);
  if (object.is_class_wide) tellByText(state.rules, object);
  object.parts = finishedParts(state, making);
  if (!object.parts.empty()) object.id = idOf(state.scene, object);
  return object;
}

}  // namespace

std::vector<SemanticObject> finishedObjects(const ReasoningState& state) {
  std::vector<SemanticObject> objects(state.objects.size());
  parallelFor(objects.size(), state.threads(),
              [&](std::size_t i) { objects[i] = finishedObject(state, state.objects[i]); });
  std::erase_if(objects, [](const SemanticObject& object) { return object.parts.empty(); });
  std::sort(objects.begin(), objects.end(),
            [](const SemanticObject& a, const SemanticObject& b) { return a.id < b.id; });
  return objects;
}

}  // namespace cluxel::rules
