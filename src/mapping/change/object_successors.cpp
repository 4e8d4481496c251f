// SPDX-License-Identifier: Apache-2.0
// Matches by name and seeds first, then by place, because places may confuse objects that stand close together.
#include "mapping/change/object_successors.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <string>

#include "rules/objects/finished_objects.hpp"

namespace cluxel::mapping {

namespace {

using Shared = std::vector<std::vector<SharedMembers>>;

/// Which objects take in all of their class, by which they are named.
std::vector<char> areClassWide(const ObjectList& objects) {
  std::vector<char> are_wide;
  are_wide.reserve(objects.size());
  std::map<std::string, ContentHash> id_of_class;
  for (const ObjectMembers* object : objects) {
    const auto [known, is_new] = id_of_class.try_emplace(object->class_iri);
    if (is_new) known->second = rules::idOfClassWide(object->class_iri);
    are_wide.push_back(object->id == known->second ? 1 : 0);
  }
  return are_wide;
}

class SuccessorSearch {
 public:
  SuccessorSearch(const ObjectList& before, ObjectsOf objects_of, const ObjectList& after)
      : before_(before),
        objects_of_(objects_of),
        after_(after),
        is_wide_before_(areClassWide(before)),
        is_wide_after_(areClassWide(after)),
        successors_(before.size()),
        has_predecessor_(after.size(), 0) {}

  Shared run() {
    addByNameAndSeeds();
    addByPlaces();
    for (auto& list : successors_)
      std::sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.other < b.other; });
    return std::move(successors_);
  }

 private:
  void add(std::uint32_t before, std::uint32_t after, std::size_t count, bool is_by_place = false) {
    successors_[before].push_back({after, count, is_by_place});
    has_predecessor_[after] = 1;
  }

  /// Of a class-wide object only the name counts: what became a part of the ground is not the ground.
  bool mayShare(std::uint32_t before, std::uint32_t after) const {
    return is_wide_before_[before] == 0 && is_wide_after_[after] == 0;
  }

  bool isEnough(std::uint32_t before, std::uint32_t after, std::size_t count) const {
    return 2 * count >= std::min(before_[before]->seeds.size(), after_[after]->seeds.size());
  }

  void addByNameAndSeeds() {
    std::map<ContentHash, std::uint32_t> named;
    for (std::uint32_t a = 0; a < after_.size(); ++a) named.emplace(after_[a]->id, a);
    const SeedOwners owners(after_);
    for (std::uint32_t b = 0; b < before_.size(); ++b) {
      std::map<std::uint32_t, std::size_t> shared;
      for (const std::uint64_t seed : before_[b]->seeds)
        if (const std::uint32_t owner = owners.ownerOf(seed); owner != kNoOwner && mayShare(b, owner)) ++shared[owner];
      const auto same = named.find(before_[b]->id);
      if (same != named.end()) shared.try_emplace(same->second, 0);
      for (const auto& [a, count] : shared)
        if (isEnough(b, a, count) || after_[a]->id == before_[b]->id) add(b, a, count);
    }
  }

  /// Whether seeds tell where most of an object is, or its name does.
  bool isSettled(std::uint32_t before) const {
    if (is_wide_before_[before] != 0) return true;
    return std::any_of(successors_[before].begin(), successors_[before].end(), [&](const SharedMembers& successor) {
      return isMost(before, successor.count) || after_[successor.other]->id == before_[before]->id;
    });
  }
  bool isMost(std::uint32_t before, std::size_t count) const { return 2 * count > before_[before]->seeds.size(); }

  /// For objects before of which seeds do not tell where most is, and for objects after that continue none.
  void addByPlaces() {
    const std::vector<char> has_seeds_of_before = has_predecessor_;
    std::vector<char> is_orphan, is_settled;
    for (std::uint32_t b = 0; b < before_.size(); ++b) {
      is_orphan.push_back(successors_[b].empty() ? 1 : 0);
      is_settled.push_back(isSettled(b) ? 1 : 0);
    }
    const bool is_all_known = std::count(is_settled.begin(), is_settled.end(), 0) == 0 &&
                              std::count(has_seeds_of_before.begin(), has_seeds_of_before.end(), 0) == 0;
    const auto has_places = [](const ObjectMembers* object) { return !object->places.empty(); };
    if (is_all_known || std::none_of(before_.begin(), before_.end(), has_places)) return;
    const Shared shared = sharedBySeedOrPlace(before_, objects_of_, after_);
    for (std::uint32_t b = 0; b < before_.size(); ++b)
      for (const auto& [a, count, is_by_place] : shared[b]) {
        if (!mayShare(b, a)) continue;
        const auto by_seeds = std::find_if(successors_[b].begin(), successors_[b].end(),
                                           [other = a](const SharedMembers& known) { return known.other == other; });
        if (by_seeds != successors_[b].end()) {
          if (is_settled[b] == 0) by_seeds->count = count;
        } else if (is_by_place && isEnough(b, a, count) &&
                   (is_orphan[b] != 0 || has_seeds_of_before[a] == 0 || (is_settled[b] == 0 && isMost(b, count)))) {
          add(b, a, count, true);
        }
      }
  }

  const ObjectList& before_;
  ObjectsOf objects_of_;
  const ObjectList& after_;
  std::vector<char> is_wide_before_, is_wide_after_;
  Shared successors_;
  std::vector<char> has_predecessor_;
};

}  // namespace

Shared successorsOf(const ObjectList& before, ObjectsOf objects_of, const ObjectList& after) {
  return SuccessorSearch(before, objects_of, after).run();
}

bool holdsMostOf(const ObjectMembers& before, const ObjectMembers& after) {
  const std::set<std::uint64_t> seeds(after.seeds.begin(), after.seeds.end());
  const auto shared =
      std::count_if(before.seeds.begin(), before.seeds.end(), [&](std::uint64_t seed) { return seeds.contains(seed); });
  return 2 * static_cast<std::size_t>(shared) > before.seeds.size();
}

}  // namespace cluxel::mapping
