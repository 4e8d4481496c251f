// SPDX-License-Identifier: Apache-2.0
// Objects by hand and at random, and the history of their names.
#pragma once

#include <algorithm>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "mapping/change/object_changes.hpp"
#include "mapping/small_campus.hpp"
#include "mapping/thing_history.hpp"
#include "rules/objects/finished_objects.hpp"

namespace cluxel::mapping {

inline ContentHash hashOf(const std::string& name) {
  return ContentHasher().addText(name).finish();
}
inline ObjectMembers thingMembers(const std::string& name, std::vector<std::uint64_t> seeds) {
  return {hashOf(name), "Tree", std::move(seeds)};
}

/// Objects whose members come and go at random; objects with the same members have the same name.
class RandomObjects {
 public:
  /// The present objects, sorted by id: one that is named by its class, and others.
  std::vector<ObjectMembers> objects() const {
    std::map<int, std::vector<std::uint64_t>> members;
    for (const auto& [member, owner] : owner_of_) members[owner].push_back(member);
    std::vector<ObjectMembers> all;
    for (const auto& [owner, own] : members) {
      ContentHasher hasher;
      for (const std::uint64_t member : own) hasher.add(member);
      all.push_back({owner == 0 ? rules::idOfClassWide("Tree") : hasher.finish(), "Tree", own});
    }
    std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
    return all;
  }
  void change(std::mt19937& random) {
    if (!former_.empty() && random() % 4 == 0) {
      owner_of_ = former_[random() % former_.size()];  // objects come back
      return;
    }
    former_.push_back(owner_of_);
    const auto owner = [&] { return static_cast<int>(random() % 6); };
    switch (random() % 3) {
      case 0:
        return join(owner(), owner());
      case 1:
        return remove(owner());
      default:
        for (int i = 0; i < 8; ++i) owner_of_[random() % 40] = owner();
    }
  }

 private:
  void join(int from, int into) {
    for (auto& [member, owner] : owner_of_) owner = owner == from ? into : owner;
  }
  void remove(int gone) {
    std::erase_if(owner_of_, [&](const auto& entry) { return entry.second == gone; });
  }

  std::map<std::uint64_t, int> owner_of_;
  std::vector<std::map<std::uint64_t, int>> former_;
};

inline std::string historyOf(const rdf::ReadTransaction& transaction) {
  std::string text;
  writeSortedNQuads(QuadReader(transaction), [&](std::string_view piece) { text.append(piece); });
  return text;
}

/// The name of each object.
inline std::map<ContentHash, std::string> namesOf(const std::vector<ObjectMembers>& objects,
                                                  const rdf::ReadTransaction& transaction) {
  const Things things = storedThings(QuadReader(transaction));
  std::map<ContentHash, std::string> names;
  for (const ObjectMembers& object : objects) names[object.id] = thingOf(things, object.id).iri;
  return names;
}

}  // namespace cluxel::mapping
