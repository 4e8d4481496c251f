// SPDX-License-Identifier: Apache-2.0
// Overlaps are counted by seed point; an object has successors and predecessors by half of the smaller one's points.
#include "mapping/change/object_changes.hpp"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <map>
#include <unordered_map>

namespace cluxel::mapping {

namespace {

using Number = std::uint32_t;

/// For each object, the numbers of its successors (or predecessors) on the other side.
struct Succession {
  std::vector<std::vector<Number>> after_of, before_of;
};

Succession successionOf(const std::vector<ObjectMembers>& before, const std::vector<ObjectMembers>& after) {
  std::unordered_map<std::uint64_t, Number> owner;
  for (Number a = 0; a < after.size(); ++a)
    for (const std::uint64_t seed : after[a].seeds) owner.emplace(seed, a);
  Succession succession{std::vector<std::vector<Number>>(before.size()),
                        std::vector<std::vector<Number>>(after.size())};
  for (Number b = 0; b < before.size(); ++b) {
    std::map<Number, std::size_t> shared;
    for (const std::uint64_t seed : before[b].seeds)
      if (const auto found = owner.find(seed); found != owner.end()) ++shared[found->second];
    for (const auto& [a, count] : shared) {
      if (2 * count < std::min(before[b].seeds.size(), after[a].seeds.size())) continue;
      succession.after_of[b].push_back(a);
      succession.before_of[a].push_back(b);
    }
  }
  return succession;
}

/// Scan ids are random bits already; the point number is spread over all bits by the golden ratio.
std::uint64_t keyOfSeed(const ContentHash& scan, std::uint32_t point) {
  std::uint64_t key = 0;
  std::memcpy(&key, scan.bytes.data(), sizeof key);
  return key ^ (static_cast<std::uint64_t>(point) + 1) * 0x9E3779B97F4A7C15ULL;
}

void sortById(std::vector<DerivedObject>& objects) {
  for (DerivedObject& object : objects) std::sort(object.from.begin(), object.from.end());
  std::sort(objects.begin(), objects.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
}

}  // namespace

std::vector<ObjectMembers> membersOf(const std::vector<rules::SemanticObject>& objects,
                                     const perception::SceneSeeds& seeds) {
  std::vector<ObjectMembers> all;
  all.reserve(objects.size());
  for (const rules::SemanticObject& object : objects) {
    ObjectMembers members{object.id, object.class_iri, {}};
    for (const rules::ObjectPart& part : object.parts)
      for (const std::uint32_t cluxel : part.cluxels) {
        const perception::SeedName& seed = seeds.seed[cluxel];
        members.seeds.push_back(keyOfSeed(seeds.scans[seed.scan], seed.point));
      }
    std::sort(members.seeds.begin(), members.seeds.end());
    all.push_back(std::move(members));
  }
  return all;
}

ObjectChanges compareObjects(const std::vector<ObjectMembers>& before, const std::vector<ObjectMembers>& after) {
  const Succession succession = successionOf(before, after);
  ObjectChanges changes;
  for (std::size_t b = 0; b < before.size(); ++b)
    if (succession.after_of[b].empty()) changes.gone.push_back(before[b].id);
  for (std::size_t a = 0; a < after.size(); ++a) {
    const auto& predecessors = succession.before_of[a];
    if (predecessors.empty()) {
      changes.added.push_back(after[a].id);
      continue;
    }
    DerivedObject derived{after[a].id, {}};
    for (const Number b : predecessors) derived.from.push_back(before[b].id);
    if (std::find(derived.from.begin(), derived.from.end(), derived.id) != derived.from.end())
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

ObjectChanges compareStates(const std::vector<ObjectMembers>& before, const std::vector<ObjectMembers>& after) {
  const auto byId = [](const ObjectMembers& a, const ObjectMembers& b) { return a.id < b.id; };
  std::vector<ObjectMembers> only_before, only_after;
  std::set_difference(before.begin(), before.end(), after.begin(), after.end(), std::back_inserter(only_before), byId);
  std::set_difference(after.begin(), after.end(), before.begin(), before.end(), std::back_inserter(only_after), byId);
  ObjectChanges changes = compareObjects(only_before, only_after);
  changes.unchanged = after.size() - only_after.size();
  return changes;
}

}  // namespace cluxel::mapping
