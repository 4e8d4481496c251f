// SPDX-License-Identifier: Apache-2.0
// The reasoning stage (paper, section 3.1.2): classes are processed in order, from the ground upwards, and a primitive
// goes to the first rule that accepts it. Shared crowns are then split and misfits absorbed.
#include "rules/decide/reason.hpp"

#include <algorithm>

#include "rules/decide/absorbing.hpp"
#include "rules/decide/crown_gathering.hpp"
#include "rules/decide/seed_groups.hpp"
#include "rules/decide/shared_splitting.hpp"
#include "rules/decide/tree_walk.hpp"

namespace cluxel::rules {

namespace {

double confidenceOf(const Confidence& confidence, const Bindings& bindings) {
  if (confidence.ramps.empty()) return confidence.high;
  double sum = 0;
  for (const ConfidenceRamp& ramp : confidence.ramps) {
    const double value = bindings.at(ramp.of).shape[ramp.attribute];
    sum += std::clamp((value - ramp.at_low) / (ramp.at_high - ramp.at_low), 0.0, 1.0);
  }
  const double share = sum / static_cast<double>(confidence.ramps.size());
  return confidence.low + (confidence.high - confidence.low) * share;
}

/// Applies one rule to all of its seeds.
class RuleRun {
 public:
  RuleRun(ReasoningState& state, const Rule& rule) : state_(state), rule_(rule) {}

  void run() {
    SliceScope scope(state_, rule_);
    auto open = seedGroups(state_, rule_, scope.slices());
    // An object that grows may come near a seed that was rejected before: retry rejected seeds until no object grows.
    for (bool grown = true; grown && !open.empty();) {
      grown = false;
      std::vector<std::vector<FragmentIndex>> rejected;
      std::vector<Decision> rejections;
      for (auto& group : open) {
        std::erase_if(group, [this](FragmentIndex fragment) { return !isFree(fragment); });
        if (group.empty()) continue;
        auto rejection = decide(group, grown);
        if (!rejection) continue;
        rejections.push_back(std::move(*rejection));
        rejected.push_back(std::move(group));
      }
      if (!grown) std::move(rejections.begin(), rejections.end(), std::back_inserter(state_.decisions));
      open = grown ? std::move(rejected) : std::vector<std::vector<FragmentIndex>>{};
    }
    scope.putBack();
  }

 private:
  bool isFree(FragmentIndex fragment) const {
    return state_.fragments[fragment].alive && state_.fragments[fragment].owner == kFree;
  }

  /// Decides about one group. Records an acceptance or a final rejection and returns nothing; returns a rejection that
  /// may be retried. Sets `grown` when the group joined an existing object.
  std::optional<Decision> decide(const std::vector<FragmentIndex>& group, bool& grown) {
    const Candidate seed = state_.fragments.candidateOf(group);
    WalkResult walk = walkTree(state_, rule_, seed);
    Decision decision = describeSeed(seed);
    if (isProbed(decision)) decision.flips = flipsOf(seed, walk);
    decision.path = std::move(walk.path);
    decision.leaf = walk.leaf;
    const TreeNode& leaf = rule_.nodes[walk.leaf];
    if (const auto* reject = std::get_if<RejectLeaf>(&leaf.what)) {
      decision.reason = reject->reason;
      decision.hint = reject->hint;
      if (!reject->leave_unknown) return decision;
      for (FragmentIndex fragment : group) state_.fragments.setOwner(fragment, kUnknown);
      state_.decisions.push_back(std::move(decision));
      return std::nullopt;
    }
    const auto& accept = std::get<AcceptLeaf>(leaf.what);
    decision.accepted = true;
    decision.reason = describeAccept(accept);
    state_.decisions.push_back(std::move(decision));
    if (accept.merge_into_related && walk.related)
      grown = joinRelated(*walk.related, accept.parts.front(), group) || grown;
    else
      makeObject(accept, std::move(walk.bindings));
    return std::nullopt;
  }

  Decision describeSeed(const Candidate& seed) const {
    Decision decision;
    decision.rule_id = rule_.id;
    std::optional<FragmentIndex> largest;
    for (FragmentIndex fragment : seed.fragments) {
      decision.seeds.push_back(state_.fragments[fragment].primitive);
      const double points = state_.fragments.shapeOf(fragment).points;
      const bool larger =
          !largest || points > state_.fragments.shapeOf(*largest).points ||
          (points == state_.fragments.shapeOf(*largest).points && state_.fragments.before(fragment, *largest));
      if (larger) largest = fragment;
    }
    decision.seed = state_.fragments[*largest].primitive;
    std::sort(decision.seeds.begin(), decision.seeds.end());
    decision.seeds.erase(std::unique(decision.seeds.begin(), decision.seeds.end()), decision.seeds.end());
    return decision;
  }

  bool isProbed(const Decision& decision) const {
    const std::vector<perception::PrimitiveIndex>& probes = state_.context.probes;
    return std::any_of(decision.seeds.begin(), decision.seeds.end(), [&probes](perception::PrimitiveIndex seed) {
      return std::binary_search(probes.begin(), probes.end(), seed);
    });
  }

  std::string describeAccept(const AcceptLeaf& accept) const {
    std::string text = state_.rules.shorten(rule_.class_iri);
    for (const auto& [name, part] : accept.parts)
      if (part != rule_.class_iri)
        text += (&accept.parts.front().second == &part ? ": " : ", ") + name + " is " + state_.rules.shorten(part);
    return text;
  }

  std::vector<DecisionFlip> flipsOf(const Candidate& seed, const WalkResult& walk) const {
    std::vector<DecisionFlip> flips;
    for (const WalkedNode& walked : walk.walked) {
      const WalkResult other = walkTree(state_, rule_, seed, walked.node);
      DecisionFlip flip{walked.first_step, walked.step_count, walked.node, false, {}};
      const auto& leaf = rule_.nodes[other.leaf].what;
      if (const auto* reject = std::get_if<RejectLeaf>(&leaf)) flip.outcome = reject->reason;
      if (const auto* accept = std::get_if<AcceptLeaf>(&leaf)) {
        flip.accepted = true;
        flip.outcome = describeAccept(*accept);
      }
      flips.push_back(std::move(flip));
    }
    return flips;
  }

  /// Adds the group to the part of the object that has the leaf's class; creates that part when it is missing.
  bool joinRelated(OwnerIndex related, const std::pair<std::string, std::string>& as,
                   const std::vector<FragmentIndex>& group) {
    ObjectInMaking& object = state_.objects[related];
    auto part = std::find_if(object.parts.begin(), object.parts.end(),
                             [&as](const PartInMaking& known) { return known.part_class == as.second; });
    if (part == object.parts.end() && as.second == rule_.class_iri) part = object.parts.begin();
    if (part == object.parts.end()) part = object.parts.insert(part, PartInMaking{as.first, as.second, {}, false});
    for (FragmentIndex fragment : group) {
      state_.fragments.setOwner(fragment, related);
      part->fragments.push_back(fragment);
    }
    part->is_outdated = true;
    return true;
  }

  void makeObject(const AcceptLeaf& accept, Bindings bindings) {
    const auto number = static_cast<OwnerIndex>(state_.objects.size());
    ObjectInMaking object;
    object.rule = &rule_;
    object.leaf = &accept;
    object.confidence = std::clamp(confidenceOf(accept.confidence, bindings), 0.0, 1.0);
    object.decision = state_.decisions.size() - 1;
    for (const auto& [name, part_class] : accept.parts) {
      PartInMaking part{name, part_class, {}, false};
      const bool shared = accept.splitting && accept.splitting->part == name;
      for (FragmentIndex fragment : bindings.at(name).fragments) {
        const OwnerIndex owner = state_.fragments[fragment].owner;
        if (shared && (owner == kFree || owner == kShared)) {
          state_.fragments.setOwner(fragment, kShared);
          state_.claims[fragment].push_back(number);
        } else if (owner == kFree) {
          state_.fragments.setOwner(fragment, number);
          part.fragments.push_back(fragment);
        }
      }
      object.parts.push_back(std::move(part));
    }
    object.bindings = std::move(bindings);
    state_.objects.push_back(std::move(object));
  }

  ReasoningState& state_;
  const Rule& rule_;
};

bool shares(const Rule& rule) {
  return std::any_of(rule.nodes.begin(), rule.nodes.end(), [](const TreeNode& node) {
    const auto* accept = std::get_if<AcceptLeaf>(&node.what);
    return accept != nullptr && accept->splitting.has_value();
  });
}

/// Splits the primitives shared by objects of a class, then gathers the free fragments beside them.
void splitAll(ReasoningState& state, const std::string& class_iri) {
  if (state.claims.empty()) return;
  splitShared(state);
  gatherFragments(state, class_iri);
}

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
    std::sort(part.cluxels.begin(), part.cluxels.end());
  }
  std::sort(parts.begin(), parts.end(),
            [](const ObjectPart& a, const ObjectPart& b) { return a.part_class < b.part_class; });
  return parts;
}

/// Hash of the class and of the members' seed points: independent of everything else in the scene.
ContentHash idOf(const perception::Scene& scene, const SemanticObject& object) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> members;
  for (const ObjectPart& part : object.parts)
    for (const std::uint32_t cluxel : part.cluxels)
      members.emplace_back(scene.cluxels.seed[cluxel].scan, scene.cluxels.seed[cluxel].point);
  std::sort(members.begin(), members.end());
  ContentHasher hasher;
  hasher.addText(object.class_iri);
  for (const auto& [scan, point] : members) hasher.add(scene.cluxels.scans[scan]).add(point);
  return hasher.finish();
}

std::vector<SemanticObject> finishedObjects(const ReasoningState& state) {
  std::vector<SemanticObject> objects;
  for (const ObjectInMaking& making : state.objects) {
    SemanticObject object;
    object.class_iri = making.rule->class_iri;
    object.confidence = making.confidence;
    object.rule_id = making.rule->id;
    object.decision = making.decision;
    object.parts = finishedParts(state, making);
    if (object.parts.empty()) continue;
    object.id = idOf(state.scene, object);
    objects.push_back(std::move(object));
  }
  std::sort(objects.begin(), objects.end(),
            [](const SemanticObject& a, const SemanticObject& b) { return a.id < b.id; });
  return objects;
}

}  // namespace

ReasoningResult reason(const perception::Scene& scene, const RuleSet& rules, const ReasoningContext& context) {
  ReasoningState state(scene, rules, context);
  for (const std::string& class_iri : rules.order) {
    const std::size_t first = state.objects.size();
    for (const Rule& rule : rules.rules) {
      if (rule.class_iri != class_iri) continue;
      // The rest of shared primitives becomes free for rules that do not share.
      if (!shares(rule)) splitAll(state, class_iri);
      RuleRun(state, rule).run();
    }
    splitAll(state, class_iri);
    absorbMisfits(state, first, false);
    if (context.oracle != nullptr) context.oracle->objectsSoFar(finishedObjects(state));
  }
  absorbMisfits(state, 0, true);
  return {finishedObjects(state), std::move(state.decisions)};
}

}  // namespace cluxel::rules
