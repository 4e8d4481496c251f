// SPDX-License-Identifier: Apache-2.0
// What a change did to the objects of a map: they are compared by the measured points that they hold, and by where
// these are.
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

/// Where a cluxel is, packed: placeOf() in mapping/change/member_places.hpp.
using MemberPlace = std::uint64_t;
inline constexpr MemberPlace kNoMemberPlace = 0;

/// An object with the seed points of its cluxels. Seed points keep their name (scan, point number) when a scan moves.
/// Other points become seeds when scans of the same place come or go: then it matters where a cluxel is.
struct ObjectMembers {
  ContentHash id;
  std::string class_iri;
  std::vector<std::uint64_t> seeds;  ///< hashes of (scan, point), in no order
  /// One place per seed. kNoMemberPlace: the change leaves the tile of this cluxel as it is. Empty when this holds for
  /// all its tiles, and for class-wide objects, which are matched by name.
  std::vector<MemberPlace> places = {};
  /// How it was decided: comparable between objects of the same id. Of class-wide objects, which hold all of a map, it
  /// is left as it is.
  std::string rule_id = {};
  double confidence = 0;
  std::uint64_t parts = 0;  ///< a hash of which member is of which part

  void addToPart(std::uint64_t part, std::uint64_t seed);
  bool isDecidedAs(const ObjectMembers& other) const;
  /// By more than rounding.
  bool hasOtherConfidence(const ObjectMembers& other) const;
  MemberPlace placeOf(std::size_t member) const { return places.empty() ? kNoMemberPlace : places[member]; }
};

/// The hash of a seed point.
std::uint64_t memberKey(const ContentHash& scan, std::uint32_t point);
/// The hash of a class of parts, for ObjectMembers::addToPart().
std::uint64_t partKey(const std::string& part_class);

std::vector<ObjectMembers> membersOf(const std::vector<rules::SemanticObject>& objects,
                                     const perception::SceneCluxels& cluxels);

/// Whose objects are compared: those of several maps may have common members.
enum class ObjectsOf : std::uint8_t { OneMap, SeveralMaps };

/// The objects that an object was derived from.
struct DerivedObject {
  ContentHash id;
  std::vector<ContentHash> from;  ///< ascending
};

/// An object with the same class and members before and after, and with other parts, another rule or another
/// confidence.
struct RedecidedObject {
  ObjectMembers before, after;  ///< without members
};

struct ObjectChanges {
  std::size_t unchanged = 0;             ///< redecided ones do not count
  std::vector<ContentHash> added, gone;  ///< continues no object before; is continued by none after
  std::vector<DerivedObject> changed;    ///< other members or another class, and one predecessor
  std::vector<DerivedObject> split;      ///< the parts of an object that has become several
  std::vector<DerivedObject> joined;     ///< made of several objects
  std::vector<RedecidedObject> redecided;

  bool isEmpty() const {
    return added.empty() && gone.empty() && changed.empty() && split.empty() && joined.empty() && redecided.empty();
  }
};

/// Compares the objects before and after a change, by successorsOf(). Lists are sorted by id. `before` may hold the
/// objects of several maps, in which members occur twice. Cost: linear in the members.
ObjectChanges compareObjects(const std::vector<ObjectMembers>& before, const std::vector<ObjectMembers>& after);
/// The same for the objects of one map before and after, which have no common members. Both sorted by id. An object
/// with the same name before and after is unchanged; such objects need not be given, and `others` is the number of
/// those that are not. Cost: linear in the members of those that differ.
ObjectChanges compareStates(const std::vector<ObjectMembers>& before, const std::vector<ObjectMembers>& after,
                            std::size_t others = 0);

/// The objects that differ, each list sorted by id.
struct DifferentObjects {
  std::vector<ObjectMembers> before, after;
  std::vector<RedecidedObject> redecided;
};

/// The objects that differ after several changes in turn. What came and went again is no difference.
class ObjectDifference {
 public:
  void add(DifferentObjects change);
  DifferentObjects take() &&;

 private:
  void setAfter(const ContentHash& id, ObjectMembers before, ObjectMembers after);

  std::map<ContentHash, ObjectMembers> gone_, fresh_;
  std::map<ContentHash, RedecidedObject> redecided_;
};

/// What differs between the objects of `before` and `after`, both sorted by id.
DifferentObjects differenceOf(std::vector<ObjectMembers> before, std::vector<ObjectMembers> after);

}  // namespace cluxel::mapping
