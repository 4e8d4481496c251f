// SPDX-License-Identifier: Apache-2.0
// Sorts successions into what was added, changed, split and joined.
#include "mapping/change/object_changes.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <set>

#include "mapping/change/object_successors.hpp"

namespace cluxel::mapping {

namespace {

/// For each object, the numbers of its successors (or predecessors) on the other side.
struct Succession {
  std::vector<std::vector<std::uint32_t>> after_of, before_of;
};

Succession successionOf(const ObjectList& before, ObjectsOf objects_of, const ObjectList& after) {
  Succession succession{std::vector<std::vector<std::uint32_t>>(before.size()),
                        std::vector<std::vector<std::uint32_t>>(after.size())};
  const auto successors = successorsOf(before, objects_of, after);
  for (std::uint32_t b = 0; b < before.size(); ++b)
    for (const SharedMembers& successor : successors[b]) {
      succession.after_of[b].push_back(successor.other);
      succession.before_of[successor.other].push_back(b);
    }
  return succession;
}

void sortById(std::vector<DerivedObject>& objects) {
  for (DerivedObject& object : objects) std::sort(object.from.begin(), object.from.end());
  std::sort(objects.begin(), objects.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
}

}  // namespace

/// Scan ids are random bits already; the point number is spread over all bits by the golden ratio.
std::uint64_t memberKey(const ContentHash& scan, std::uint32_t point) {
  std::uint64_t key = 0;
  std::memcpy(&key, scan.bytes.data(), sizeof key);
  return key ^ (static_cast<std::uint64_t>(point) + 1) * 0x9E3779B97F4A7C15ULL;
}

std::uint64_t partKey(const std::string& part_class) {
  return memberKey(ContentHasher().addText(part_class).finish(), 0);
}

/// A sum, because members come in no order; the product ties each to its part.
void ObjectMembers::addToPart(std::uint64_t part, std::uint64_t seed) {
  const std::uint64_t mixed = (seed ^ part) * 0x9E3779B97F4A7C15ULL;
  parts += mixed ^ (mixed >> 32U);
}

bool ObjectMembers::isDecidedAs(const ObjectMembers& other) const {
  return rule_id == other.rule_id && parts == other.parts && !hasOtherConfidence(other);
}

bool ObjectMembers::hasOtherConfidence(const ObjectMembers& other) const {
  constexpr double rounding = 1e-9;
  return std::abs(confidence - other.confidence) > rounding;
}

std::vector<ObjectMembers> membersOf(const std::vector<rules::SemanticObject>& objects,
                                     const perception::SceneCluxels& cluxels) {
  std::vector<ObjectMembers> all;
  all.reserve(objects.size());
  for (const rules::SemanticObject& object : objects) {
    ObjectMembers members{object.id, object.class_iri, {}, {}};
    std::size_t count = 0;
    if (!object.is_class_wide) members.rule_id = object.rule_id, members.confidence = object.confidence;
    for (const rules::ObjectPart& part : object.parts) count += part.cluxels.size();
    members.seeds.reserve(count);
    if (!object.is_class_wide) members.places.reserve(count);
    for (const rules::ObjectPart& part : object.parts) {
      const std::uint64_t part_key = partKey(part.part_class);
      for (const std::uint32_t cluxel : part.cluxels) {
        const perception::SeedName& seed = cluxels.seed[cluxel];
        members.seeds.push_back(memberKey(cluxels.scans[seed.scan], seed.point));
        if (object.is_class_wide) continue;
        members.addToPart(part_key, members.seeds.back());
        members.places.push_back(placeOf(cluxels.center[cluxel]));
      }
    }
    all.push_back(std::move(members));
  }
  return all;
}

namespace {

ObjectChanges changesBetween(const ObjectList& before, ObjectsOf objects_of, const ObjectList& after) {
  const Succession succession = successionOf(before, objects_of, after);
  ObjectChanges changes;
  for (std::size_t b = 0; b < before.size(); ++b)
    if (succession.after_of[b].empty()) changes.gone.push_back(before[b]->id);
  for (std::size_t a = 0; a < after.size(); ++a) {
    const auto& predecessors = succession.before_of[a];
    if (predecessors.empty()) {
      changes.added.push_back(after[a]->id);
      continue;
    }
    DerivedObject derived{after[a]->id, {}};
    for (const std::uint32_t b : predecessors) derived.from.push_back(before[b]->id);
    if (std::all_of(derived.from.begin(), derived.from.end(), [&](const auto& from) { return from == derived.id; }))
      ++changes.unchanged;
    else if (predecessors.size() > 1)
      changes.joined.push_back(std::move(derived));
    else if (succession.after_of[predecessors.front()].size() > 1)
      changes.split.push_back(std::move(derived));
    else
      changes.changed.push_back(std::move(derived));
  }
  std::sort(changes.added.begin(), changes.added.end());
  std::sort(changes.gone.begin(), changes.gone.end());
  for (auto* list : {&changes.changed, &changes.split, &changes.joined}) sortById(*list);
  return changes;
}

}  // namespace

ObjectChanges compareObjects(const std::vector<ObjectMembers>& before, const std::vector<ObjectMembers>& after) {
  return changesBetween(listOf(before), ObjectsOf::SeveralMaps, listOf(after));
}

ObjectChanges compareStates(const std::vector<ObjectMembers>& before, const std::vector<ObjectMembers>& after,
                            std::size_t others) {
  const auto byId = [](const ObjectMembers* a, const ObjectMembers* b) { return a->id < b->id; };
  const ObjectList all_before = listOf(before), all_after = listOf(after);
  ObjectList only_before, only_after;
  std::set_difference(all_before.begin(), all_before.end(), all_after.begin(), all_after.end(),
                      std::back_inserter(only_before), byId);
  std::set_difference(all_after.begin(), all_after.end(), all_before.begin(), all_before.end(),
                      std::back_inserter(only_after), byId);
  ObjectChanges changes = changesBetween(only_before, ObjectsOf::OneMap, only_after);
  changes.unchanged = others + after.size() - only_after.size();
  return changes;
}

namespace {

ObjectMembers withoutMembers(ObjectMembers object) {
  object.seeds = {}, object.places = {};
  return object;
}

std::vector<ObjectMembers> valuesOf(std::map<ContentHash, ObjectMembers> objects) {
  std::vector<ObjectMembers> values;
  values.reserve(objects.size());
  for (auto& [id, object] : objects) values.push_back(std::move(object));
  return values;
}

}  // namespace

/// The object is there before and after, with the same members.
void ObjectDifference::setAfter(const ContentHash& id, ObjectMembers before, ObjectMembers after) {
  redecided_.erase(id);
  if (!before.isDecidedAs(after))
    redecided_.emplace(id, RedecidedObject{withoutMembers(std::move(before)), withoutMembers(std::move(after))});
}

void ObjectDifference::add(DifferentObjects change) {
  for (ObjectMembers& object : change.before) {
    if (fresh_.erase(object.id) > 0) continue;
    if (const auto other = redecided_.extract(object.id)) {
      const ObjectMembers& first = other.mapped().before;
      object.rule_id = first.rule_id, object.confidence = first.confidence, object.parts = first.parts;
    }
    gone_.emplace(object.id, std::move(object));
  }
  for (ObjectMembers& object : change.after) {
    const ContentHash id = object.id;
    if (auto former = gone_.extract(id))
      setAfter(id, std::move(former.mapped()), std::move(object));
    else
      fresh_.emplace(id, std::move(object));
  }
  for (RedecidedObject& object : change.redecided) {
    const ContentHash id = object.after.id;
    if (const auto made = fresh_.find(id); made != fresh_.end()) {
      made->second.rule_id = object.after.rule_id, made->second.confidence = object.after.confidence;
      made->second.parts = object.after.parts;
      continue;
    }
    const auto known = redecided_.find(id);
    setAfter(id, known != redecided_.end() ? known->second.before : object.before, std::move(object.after));
  }
}

DifferentObjects ObjectDifference::take() && {
  DifferentObjects all{valuesOf(std::move(gone_)), valuesOf(std::move(fresh_)), {}};
  for (auto& [id, object] : redecided_) all.redecided.push_back(std::move(object));
  return all;
}

DifferentObjects differenceOf(std::vector<ObjectMembers> before, std::vector<ObjectMembers> after) {
  DifferentObjects different;
  auto a = after.begin();
  for (ObjectMembers& object : before) {
    for (; a != after.end() && a->id < object.id; ++a) different.after.push_back(std::move(*a));
    if (a == after.end() || a->id != object.id) {
      different.before.push_back(std::move(object));
      continue;
    }
    if (!object.isDecidedAs(*a))
      different.redecided.push_back({withoutMembers(std::move(object)), withoutMembers(std::move(*a))});
    ++a;
  }
  for (; a != after.end(); ++a) different.after.push_back(std::move(*a));
  return different;
}

}  // namespace cluxel::mapping
