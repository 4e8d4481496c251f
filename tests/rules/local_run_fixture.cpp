// SPDX-License-Identifier: Apache-2.0
// Changes of scenes, windows around them, and gluing.
#include "rules/local_run_fixture.hpp"

#include <algorithm>

#include "perception/segments/scene_part.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
using namespace rules;

namespace {

Eigen::AlignedBox2d boxOf(const Primitive& primitive) {
  return {Eigen::Vector2d(primitive.min.head<2>()), Eigen::Vector2d(primitive.max.head<2>())};
}

/// With the cluxels' boxes, which may stick out of the primitive's own.
std::vector<Eigen::AlignedBox2d> boxesOf(const Scene& scene) {
  std::vector<Eigen::AlignedBox2d> boxes;
  for (const Primitive& primitive : scene.primitives) boxes.push_back(boxOf(primitive));
  for (std::size_t i = 0; i < scene.cluxels.size(); ++i) {
    const Eigen::Vector2d half = scene.cluxels.extent[i].head<2>().cast<double>() / 2;
    boxes[scene.cluxels.primitive[i]].extend(Eigen::Vector2d(scene.cluxels.center[i].head<2>() - half));
    boxes[scene.cluxels.primitive[i]].extend(Eigen::Vector2d(scene.cluxels.center[i].head<2>() + half));
  }
  return boxes;
}

std::map<ContentHash, PrimitiveIndex> numbersOf(const Scene& scene) {
  std::map<ContentHash, PrimitiveIndex> numbers;
  for (PrimitiveIndex i = 0; i < scene.primitives.size(); ++i) numbers[scene.primitives[i].id] = i;
  return numbers;
}

/// The ids of what the primitive has edges or relations to.
std::multiset<std::pair<int, ContentHash>> tiesOf(const Scene& scene, PrimitiveIndex primitive) {
  std::multiset<std::pair<int, ContentHash>> ties;
  for (const Relation& relation : scene.relationsOf(primitive))
    ties.emplace(static_cast<int>(relation.kind), scene.primitives[relation.to].id);
  for (const std::uint32_t cluxel : scene.primitives[primitive].cluxels)
    for (const std::uint32_t neighbour : scene.cluxels.neighbours(cluxel))
      ties.emplace(-1, scene.primitives[scene.cluxels.primitive[neighbour]].id);
  for (const Relation& relation : scene.relations)
    if (relation.to == primitive) ties.emplace(-2, scene.primitives[relation.from].id);
  return ties;
}

bool isOfWholeClass(const RuleSet& rules, const SemanticObject& object) {
  const Rule& rule = *rules.find(object.rule_id);
  return std::any_of(rule.nodes.begin(), rule.nodes.end(), [](const TreeNode& node) {
    const auto* leaf = std::get_if<AcceptLeaf>(&node.what);
    return leaf != nullptr && leaf->merge_into == MergeInto::Class;
  });
}

std::string inOneLine(const SemanticObject& object) {
  return object.class_iri + " " + object.id.hex() + " " + object.rule_id + " " + std::to_string(object.confidence);
}

std::string memberOf(const Scene& scene, const ObjectPart& part, std::uint32_t cluxel) {
  const SeedName& seed = scene.cluxels.seed[cluxel];
  return part.part_class + " " + scene.cluxels.scans[seed.scan].hex() + " " + std::to_string(seed.point);
}

}  // namespace

RuleSet smallRules() {
  return rulesOf(
      "[clx:Ground, clx:Building, [clx:Tree, clx:StreetLamp, clx:Vehicle, clx:Bush], clx:Pole, clx:SmallObject]", R"(
  - id: ground
    class: clx:Ground
    seed: { label: horizontal_plane }
    tree: { accept: { merge_into: class, confidence: 0.9 } }
  - id: building/wall
    class: clx:Building
    seed: { label: vertical_plane, as: facade, where: [ height >= 1 m ] }
    group: { near: 0.6 m, limits: [ length <= 7 m ] }
    tree:
      test: length >= 1.2 m
      yes: { accept: { part: clx:Facade, confidence: 0.9,
        absorb: [ { from: { label: small_structure }, when: [ gap to facade <= 0.5 m ], max_fraction_of_points: 0.5 },
                  { from: { label: scatter }, when: [ gap to facade <= 0.5 m ], max_fraction_of_points: 0.3, late: true } ] } }
      no: { reject: narrow }
  - id: building/fragments
    class: clx:Building
    seed: { label: vertical_plane, as: piece }
    tree:
      test: gap to clx:Building <= 0.8 m
      yes: { accept: { part: clx:Facade, merge_into: related, confidence: 0.9 } }
      no: { reject: alone }
  - id: tree/any
    class: clx:Tree
    seed: { label: column, as: trunk }
    group: { horizontal: 0.4 m, vertical: 1 m, limits: [ horizontal_extent <= 1 m ] }
    evidence: [ { gap_to: { object: clx:Bush }, curve: { 0.5 m: -1, 1.5 m: 0 } } ]
    tree:
      find: { as: top, label: scatter, share: true, choose: all, where: [ gap to trunk <= 0.6 m, top >= 1.5 m ] }
      found:
        accept:
          parts: { trunk: clx:TreeTrunk, top: clx:TreeTop }
          confidence: 0.7
          split: { shared: top, from: trunk, reach: 3 m, jump: 0.5 m, gather: { within: 1 m, above: 1 m } }
          absorb: [ { from: { label: small_structure }, when: [ gap to top <= 0.4 m ], max_fraction_of_points: 0.4 } ]
      missing: { reject: no crown }
  - id: tree/crown-fragments
    class: clx:Tree
    seed: { label: scatter, as: leaves, where: [ bottom >= 1 m ] }
    tree:
      test: gap to clx:Tree <= 1 m
      yes: { accept: { part: clx:TreeTop, merge_into: related, confidence: 0.9 } }
      no: { reject: no tree beside it }
  - id: lamp
    class: clx:StreetLamp
    seed: { label: column, as: pole }
    tree:
      find: { as: head, label_in: [small_structure, scatter], where: [ gap to pole <= 0.6 m, bottom >= 1 m ], choose: nearest }
      found: { accept: { parts: { pole: clx:LampPole, head: clx:LampHead }, confidence: 0.6 } }
      missing: { reject: no head }
  - id: car
    class: clx:Vehicle
    seed: { label: small_structure, as: body }
    group: { near: 0.5 m, limits: [ length <= 3.5 m, top <= 2.5 m ] }
    evidence: [ { measure: length of whole, curve: { 0.5 m: -2, 2 m: 1 } } ]
    tree: { accept: { confidence: 0.5,
      absorb: [ { from: { label_in: [scatter, column] }, when: [ gap to body <= 0.3 m ], max_fraction_of_points: 0.6 } ] } }
  - id: bush
    class: clx:Bush
    seed: { label: scatter, as: leaves }
    group: { near: 0.4 m, limits: [ length <= 4 m ] }
    tree:
      test: bottom <= 0.5 m
      yes: { accept: { confidence: 0.55 } }
      no: { reject: high }
  - id: pole
    class: clx:Pole
    seed: { label: column, as: pole }
    tree:
      find: { as: beside, label: column, where: [ gap to pole <= 0.8 m ], choose: nearest }
      found: { reject: one of two, leave: unknown }
      missing: { accept: { confidence: 0.6 } }
  - id: rest
    class: clx:SmallObject
    seed: { label_in: [small_structure, column, scatter], as: thing }
    group: { near: 0.3 m, limits: [ length <= 3 m ] }
    tree:
      any: [ gap to clx:Tree <= 0.5 m, gap to clx:Vehicle <= 0.3 m ]
      yes: { reject: beside something }
      no: { accept: { confidence: 0.4, absorb: [ { from: { label: vertical_plane }, when: [ gap to thing <= 0.5 m ],
            max_fraction_of_points: 0.5, late: true } ] } }
)");
}

double within(std::mt19937& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random() % 10000U) / 10000);
}

BoxScene randomStreet(std::mt19937& random, double length_m, double things_per_m) {
  BoxScene street;
  const auto add = [&](const std::string& name, PrimitiveLabel label, Eigen::Vector3d centre, Eigen::Vector3d size) {
    street.boxes.push_back(box(name + std::to_string(street.boxes.size()), label, centre, size));
  };
  for (double x = 4; x < length_m; x += 8) add("ground", kGroundLabel, {x, 0, 0}, {8, 4, 0.1});
  const auto count = static_cast<int>(things_per_m * length_m);
  for (int i = 0; i < count; ++i) {
    const double x = within(random, 0, length_m), y = within(random, -2, 2);
    switch (random() % 7) {
      case 0: {
        const double height = within(random, 1.2, 2.4), wide = within(random, 0.8, 3.5);
        add("trunk", kColumn, {x, y, height / 2}, {0.3, 0.3, height});
        add("crown", kScatter, {x + within(random, -1, 1), y, height + 0.7}, {wide, within(random, 0.6, 1.5), 1.2});
        break;
      }
      case 1:
        add("pole", kColumn, {x, y, 1.5}, {0.15, 0.15, 3});
        if (random() % 2 == 0) add("head", kSmall, {x + 0.2, y, 3.1}, {0.6, 0.3, 0.3});
        break;
      case 2:
        add("front", kSmall, {x, y, 0.7}, {within(random, 0.6, 1.8), 1.2, 1.2});
        add("back", kSmall, {x + within(random, 1, 2.4), y, 0.7}, {within(random, 0.6, 1.4), 1.2, 1.2});
        break;
      case 3:
        add("bush", kScatter, {x, y, 0.5}, {within(random, 0.4, 2), within(random, 0.4, 1), 0.9});
        break;
      case 4:
        add("wall", kWall, {x, 3.5, 1.5}, {within(random, 0.6, 4), 0.2, within(random, 0.8, 3)});
        break;
      case 5:
        add("leaves", kScatter, {x, y, within(random, 1.5, 3)}, {within(random, 0.3, 1.5), 0.5, 0.5});
        break;
      default:
        add("bit", static_cast<PrimitiveLabel>(random() % 5), {x, y, within(random, 0.3, 2.5)},
            {within(random, 0.2, 0.6), within(random, 0.2, 0.6), within(random, 0.2, 0.6)});
    }
  }
  return street;
}

RuleSet rulesOfLoneGround() {
  RuleSet rules = outdoorRules();
  for (Rule& rule : rules.rules)
    if (rule.id == "ground/patches") rule.group.reset();
  return rules;
}

ChangedScene changeOf(const Scene& all, const Eigen::Vector2d& place, double around_m, std::mt19937& random) {
  std::vector<PrimitiveIndex> before, after;
  for (PrimitiveIndex i = 0; i < all.primitives.size(); ++i) {
    const bool near = boxOf(all.primitives[i]).exteriorDistance(place) <= around_m;
    const unsigned fate = near ? random() % 4 : 3;
    if (fate != 0) before.push_back(i);
    if (fate != 1) after.push_back(i);
  }
  return {partOf(all, before), partOf(all, after), place};
}

Window windowOf(const ChangedScene& change, const ReasoningResult& before, double around_m, double reach_m) {
  Window window;
  const std::vector<Eigen::AlignedBox2d> boxes = boxesOf(change.after), old_boxes = boxesOf(change.before);
  const std::map<ContentHash, PrimitiveIndex> old = numbersOf(change.before), now = numbersOf(change.after);
  std::vector<PrimitiveIndex> kept, left;
  for (PrimitiveIndex i = 0; i < boxes.size(); ++i)
    (boxes[i].exteriorDistance(change.place) <= around_m ? kept : left).push_back(i);
  window.scene = partOf(change.after, kept);
  for (const auto& [id, number] : old)
    if (now.count(id) == 0) window.gone.push_back(old_boxes[number]);
  for (PrimitiveIndex i = 0; i < kept.size(); ++i) {
    const auto known = old.find(change.after.primitives[kept[i]].id);
    const bool is_new = known == old.end();
    window.is_dirty.push_back(is_new || tiesOf(change.after, kept[i]) != tiesOf(change.before, known->second) ? 1 : 0);
    window.stored_trace.push_back(is_new ? std::nullopt : std::optional(before.traces[known->second]));
    const bool is_cut = tiesOf(window.scene, i).size() != tiesOf(change.after, kept[i]).size();
    window.is_open.push_back(is_cut || std::any_of(left.begin(), left.end(),
                                                   [&](PrimitiveIndex other) {
                                                     return boxes[kept[i]].exteriorDistance(boxes[other]) <= reach_m;
                                                   })
                                 ? 1
                                 : 0);
  }
  return window;
}

KnownObjects objectsIn(const Scene& scene, const ReasoningResult& result, const RuleSet& rules) {
  KnownObjects known;
  for (const SemanticObject& object : result.objects) {
    if (!isOfWholeClass(rules, object)) {
      known.insert(inOneLine(object));
      continue;
    }
    for (const ObjectPart& part : object.parts)
      for (const std::uint32_t cluxel : part.cluxels) known.insert(memberOf(scene, part, cluxel));
  }
  return known;
}

std::map<ContentHash, std::uint64_t> tracesOf(const Scene& scene, const std::vector<std::uint64_t>& traces) {
  std::map<ContentHash, std::uint64_t> by_id;
  for (PrimitiveIndex i = 0; i < traces.size(); ++i) by_id[scene.primitives[i].id] = traces[i];
  return by_id;
}

Glued gluedOf(const ChangedScene& change, const ReasoningResult& before, const Window& window,
              const LocalOutcome& outcome, const RuleSet& rules) {
  Glued glued;
  const std::map<ContentHash, PrimitiveIndex> now = numbersOf(change.after);
  std::set<ContentHash> decided;
  for (PrimitiveIndex i = 0; i < outcome.layer.size(); ++i)
    if (outcome.layer[i] <= kLastDecidedLayer) decided.insert(window.scene.primitives[i].id);
  const auto isDecided = [&](const Scene& scene, PrimitiveIndex i) {
    return decided.count(scene.primitives[i].id) > 0;
  };
  const auto take = [&](const Scene& scene, const ReasoningResult& result, const auto& takes) {
    for (const SemanticObject& object : result.objects) {
      const bool whole_class = isOfWholeClass(rules, object);
      bool any = false;
      for (const ObjectPart& part : object.parts) {
        for (const PrimitiveIndex i : part.primitives) any = any || takes(scene, i);
        if (whole_class)
          for (const std::uint32_t cluxel : part.cluxels)
            if (takes(scene, scene.cluxels.primitive[cluxel])) glued.objects.insert(memberOf(scene, part, cluxel));
      }
      if (any && !whole_class) glued.objects.insert(inOneLine(object));
    }
  };
  take(window.scene, outcome.result, isDecided);
  // Of the stored objects those remain of which no member is gone or decided.
  ReasoningResult stored;
  for (const SemanticObject& object : before.objects) {
    const bool changed = std::any_of(object.parts.begin(), object.parts.end(), [&](const ObjectPart& part) {
      return std::any_of(part.primitives.begin(), part.primitives.end(), [&](PrimitiveIndex i) {
        return now.count(change.before.primitives[i].id) == 0 || isDecided(change.before, i);
      });
    });
    if (!changed || isOfWholeClass(rules, object)) stored.objects.push_back(object);
  }
  take(change.before, stored, [&](const Scene& scene, PrimitiveIndex i) {
    return !isDecided(scene, i) && now.count(scene.primitives[i].id) > 0;
  });
  for (const auto& [id, trace] : tracesOf(change.before, before.traces))
    if (now.count(id) > 0) glued.traces[id] = trace;
  for (PrimitiveIndex i = 0; i < outcome.result.traces.size(); ++i)
    if (outcome.layer[i] <= kLastDecidedLayer) glued.traces[window.scene.primitives[i].id] = outcome.result.traces[i];
  return glued;
}

}  // namespace cluxel::testing
