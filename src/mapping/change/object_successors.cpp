// SPDX-License-Identifier: Apache-2.0
// By name and seeds first; places may mistake what stands close together.
#include "mapping/change/object_successors.hpp"

#include <algorithm>

namespace cluxel::mapping {

namespace {

using Shared = std::vector<std::vector<SharedMembers>>;

class SuccessorSearch {
 public:
  SuccessorSearch(const ObjectList& before, const ObjectList& after)
      : before_(before), after_(after), successors_(before.size()), has_predecessor_(after.size(), 0) {}

  Shared run() {
    addByNameAndSeeds();
    addOfOrphans();
    addOfNewcomers();
    for (auto& list : successors_)
      std::sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.other < b.other; });
    return std::move(successors_);
  }

 private:
  void add(std::uint32_t before, std::uint32_t after, std::size_t count) {
    successors_[before].push_back({after, count});
    has_predecessor_[after] = 1;
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
        if (const std::uint32_t owner = owners.ownerOf(seed); owner != kNoOwner) ++shared[owner];
      const auto same = named.find(before_[b]->id);
      if (same != named.end()) shared.try_emplace(same->second, 0);
      for (const auto& [a, count] : shared)
        if (isEnough(b, a, count) || after_[a]->id == before_[b]->id) add(b, a, count);
    }
  }

  /// Objects before that go on in none.
  void addOfOrphans() {
    std::vector<std::uint32_t> numbers;
    ObjectList orphans;
    for (std::uint32_t b = 0; b < before_.size(); ++b)
      if (successors_[b].empty() && !before_[b]->places.empty()) orphans.push_back(before_[b]), numbers.push_back(b);
    if (orphans.empty()) return;
    const Shared shared = sharedBySeedOrPlace(orphans, after_);
    for (std::size_t i = 0; i < orphans.size(); ++i)
      for (const auto& [a, count] : shared[i])
        if (isEnough(numbers[i], a, count)) add(numbers[i], a, count);
  }

  /// Objects after in which none goes on.
  void addOfNewcomers() {
    std::vector<std::uint32_t> numbers;
    ObjectList newcomers;
    for (std::uint32_t a = 0; a < after_.size(); ++a)
      if (has_predecessor_[a] == 0 && !after_[a]->places.empty()) newcomers.push_back(after_[a]), numbers.push_back(a);
    if (newcomers.empty()) return;
    const Shared shared = sharedBySeedOrPlace(newcomers, before_);
    for (std::size_t i = 0; i < newcomers.size(); ++i)
      for (const auto& [b, count] : shared[i])
        if (isEnough(b, numbers[i], count)) add(b, numbers[i], count);
  }

  const ObjectList& before_;
  const ObjectList& after_;
  Shared successors_;
  std::vector<char> has_predecessor_;
};

}  // namespace

Shared successorsOf(const ObjectList& before, const ObjectList& after) {
  return SuccessorSearch(before, after).run();
}

}  // namespace cluxel::mapping
