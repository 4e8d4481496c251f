// SPDX-License-Identifier: Apache-2.0
// The reasoning stage as the paper tells it: class by class from the ground upwards, each primitive to the first that
// accepts it; then shared crowns are parted and misfits absorbed.
#include "cluxel/reasoning/reason.hpp"

#include <algorithm>

#include "cluxel/knowledge/vocabulary.hpp"
#include "reasoning/absorbing.hpp"
#include "reasoning/crown_gathering.hpp"
#include "reasoning/seed_groups.hpp"
#include "reasoning/shared_parting.hpp"
#include "reasoning/tree_walk.hpp"

namespace cluxel {

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

/// Runs one rule over all its seeds.
class RuleRun {
 public:
  RuleRun(ReasoningState& state, const Rule& rule) : state_(state), rule_(rule) {}

  void run() {
    SliceScope scope(state_, rule_);
    auto open = seedGroups(state_, rule_, scope.slices());
    // What joins an object may bring the next one near it: what was rejected is tried again while objects grow.
    for (bool grown = true; grown && !open.empty();) {
      grown = false;
      std::vector<std::vector<PieceIndex>> rejected;
      std::vector<Decision> rejections;
      for (auto& group : open) {
        std::erase_if(group, [this](PieceIndex piece) { return !isFree(piece); });
        if (group.empty()) continue;
        auto rejection = decide(group, grown);
        if (!rejection) continue;
        rejections.push_back(std::move(*rejection));
        rejected.push_back(std::move(group));
      }
      if (!grown) std::move(rejections.begin(), rejections.end(), std::back_inserter(state_.decisions));
      open = grown ? std::move(rejected) : std::vector<std::vector<PieceIndex>>{};
    }
    scope.putBack();
  }

 private:
  bool isFree(PieceIndex piece) const { return state_.pieces[piece].alive && state_.pieces[piece].owner == kFree; }

  /// Walks one group. A final decision is recorded at once, a rejection that may be tried again is handed back.
  /// `grown` is set when the group joined an object.
  std::optional<Decision> decide(const std::vector<PieceIndex>& group, bool& grown) {
    const Thing seed = state_.pieces.thingOf(group);
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
      for (PieceIndex piece : group) state_.pieces.setOwner(piece, kUnknown);
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

  Decision describeSeed(const Thing& seed) const {
    Decision decision;
    decision.rule_id = rule_.id;
    std::optional<PieceIndex> largest;
    for (PieceIndex piece : seed.pieces) {
      decision.seeds.push_back(state_.pieces[piece].primitive);
      const double points = state_.pieces.shapeOf(piece).points;
      const bool larger = !largest || points > state_.pieces.shapeOf(*largest).points ||
                          (points == state_.pieces.shapeOf(*largest).points && state_.pieces.before(piece, *largest));
      if (larger) largest = piece;
    }
    decision.seed = state_.pieces[*largest].primitive;
    std::sort(decision.seeds.begin(), decision.seeds.end());
    decision.seeds.erase(std::unique(decision.seeds.begin(), decision.seeds.end()), decision.seeds.end());
    return decision;
  }

  bool isProbed(const Decision& decision) const {
    return state_.context.probe &&
           std::binary_search(decision.seeds.begin(), decision.seeds.end(), *state_.context.probe);
  }

  std::string describeAccept(const AcceptLeaf& accept) const {
    std::string text = state_.rules.shorten(rule_.class_iri);
    for (const auto& [name, part] : accept.parts)
      if (part != rule_.class_iri)
        text += (&accept.parts.front().second == &part ? ": " : ", ") + name + " is " + state_.rules.shorten(part);
    return text;
  }

  std::vector<DecisionFlip> flipsOf(const Thing& seed, const WalkResult& walk) const {
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

  /// Into the object's part of the leaf's class; a part that it does not have yet is added.
  bool joinRelated(OwnerIndex related, const std::pair<std::string, std::string>& as,
                   const std::vector<PieceIndex>& group) {
    ObjectInMaking& object = state_.objects[related];
    auto part = std::find_if(object.parts.begin(), object.parts.end(),
                             [&as](const PartInMaking& known) { return known.part_class == as.second; });
    if (part == object.parts.end() && as.second == rule_.class_iri) part = object.parts.begin();
    if (part == object.parts.end()) part = object.parts.insert(part, PartInMaking{as.first, as.second, {}});
    for (PieceIndex piece : group) {
      state_.pieces.setOwner(piece, related);
      part->pieces.push_back(piece);
    }
    if (Thing* thing = object.bindings.find(part->name)) *thing = state_.pieces.thingOf(part->pieces);
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
      PartInMaking part{name, part_class, {}};
      const bool shared = accept.parting && accept.parting->part == name;
      for (PieceIndex piece : bindings.at(name).pieces) {
        const OwnerIndex owner = state_.pieces[piece].owner;
        if (shared && (owner == kFree || owner == kShared)) {
          state_.pieces.setOwner(piece, kShared);
          state_.claims[piece].push_back(number);
        } else if (owner == kFree) {
          state_.pieces.setOwner(piece, number);
          part.pieces.push_back(piece);
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
    return accept != nullptr && accept->parting.has_value();
  });
}

/// Parts what the objects of a class share, and then what hangs beside it.
void partAll(ReasoningState& state, const std::string& class_iri) {
  if (state.claims.empty()) return;
  partShared(state);
  gatherFragments(state, class_iri);
}

std::vector<ObjectPart> finishedParts(const ReasoningState& state, const ObjectInMaking& object) {
  std::vector<ObjectPart> parts;
  for (const PartInMaking& making : object.parts) {
    if (making.pieces.empty()) continue;
    auto part = std::find_if(parts.begin(), parts.end(),
                             [&](const ObjectPart& known) { return known.part_class == making.part_class; });
    if (part == parts.end()) part = parts.insert(parts.end(), ObjectPart{making.part_class, {}, {}});
    for (PieceIndex piece : making.pieces) {
      part->primitives.push_back(state.pieces[piece].primitive);
      const auto& cluxels = state.pieces[piece].cluxels;
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

/// The hash of the class and of the members' seeds: the same object has the same id whatever lies beside it.
ContentHash idOf(const Scene& scene, const SemanticObject& object) {
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

std::string iriOf(const Primitive& primitive) {
  return std::string(vocabulary::kMap) + "primitive/" + primitive.id.hex();
}

ReasoningResult reason(const Scene& scene, const RuleSet& rules, const ReasoningContext& context) {
  ReasoningState state(scene, rules, context);
  for (const std::string& class_iri : rules.order) {
    const std::size_t first = state.objects.size();
    for (const Rule& rule : rules.rules) {
      if (rule.class_iri != class_iri) continue;
      // What is left of shared primitives is free for the rules that do not share.
      if (!shares(rule)) partAll(state, class_iri);
      RuleRun(state, rule).run();
    }
    partAll(state, class_iri);
    absorbMisfits(state, first, false);
    if (context.oracle != nullptr) context.oracle->objectsSoFar(finishedObjects(state));
  }
  absorbMisfits(state, 0, true);
  return {finishedObjects(state), std::move(state.decisions)};
}

}  // namespace cluxel
