// SPDX-License-Identifier: Apache-2.0
// What a change did to the objects of a map: they are compared by the measured points that they hold.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/content_hash.hpp"
#include "perception/segments/scene.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::mapping {

/// An object with the seed points of its cluxels. Seed points keep their name (scan, point number) when a scan moves.
struct ObjectMembers {
  ContentHash id;
  std::string class_iri;
  std::vector<std::uint64_t> seeds;  ///< hashes of (scan, point), in no order
};

/// The hash of a seed point.
std::uint64_t memberKey(const ContentHash& scan, std::uint32_t point);

std::vector<ObjectMembers> membersOf(const std::vector<rules::SemanticObject>& objects,
                                     const perception::SceneSeeds& seeds);

/// The objects that an object was derived from.
struct DerivedObject {
  ContentHash id;
  std::vector<ContentHash> from;  ///< ascending
};

struct ObjectChanges {
  std::size_t unchanged = 0;
  std::vector<ContentHash> added, gone;  ///< share no seed point with an object before, or after
  std::vector<DerivedObject> changed;    ///< other members or another class, and one predecessor
  std::vector<DerivedObject> split;      ///< the parts of an object that has become several
  std::vector<DerivedObject> joined;     ///< made of several objects

  bool isEmpty() const { return added.empty() && gone.empty() && changed.empty() && split.empty() && joined.empty(); }
};

/// Compares the objects before and after a change. An object goes on in another when that holds at least half of its
/// seed points, or the other way round. Lists are sorted by id. `before` may hold the objects of several maps, in which
/// members occur twice. Cost: linear in the members.
ObjectChanges compareObjects(const std::vector<ObjectMembers>& before, const std::vector<ObjectMembers>& after);
/// The same for the objects of one map before and after, which have no common members. Both sorted by id. An object
/// with the same name before and after is unchanged; such objects need not be given, and `others` is the number of
/// those that are not. Cost: linear in the members of those that differ.
ObjectChanges compareStates(const std::vector<ObjectMembers>& before, const std::vector<ObjectMembers>& after,
                            std::size_t others = 0);

/// The objects that differ after several changes in turn. What came and went again is no difference.
class ObjectDifference {
 public:
  /// The objects that one change took away, and those that it made.
  void add(std::vector<ObjectMembers> before, std::vector<ObjectMembers> after);
  /// Objects before and after, sorted by id.
  std::pair<std::vector<ObjectMembers>, std::vector<ObjectMembers>> take() &&;

 private:
  std::map<ContentHash, ObjectMembers> gone_, fresh_;
};

/// Leaves out what is in both lists; both are sorted by id.
void keepDifferent(std::vector<ObjectMembers>& before, std::vector<ObjectMembers>& after);

}  // namespace cluxel::mapping
