// SPDX-License-Identifier: Apache-2.0
// A flat table of the members after: a node for each member would cost most of the comparison.
#include "mapping/change/common_members.hpp"

#include <bit>
#include <map>

#include "base/mixed_bits.hpp"

namespace cluxel::mapping {

namespace {

/// Maps members to the numbers of their objects. Open addressing, at most half full.
class OwnerTable {
 public:
  explicit OwnerTable(std::size_t members) : slots_(std::bit_ceil(2 * members + 1)) {}

  /// Keeps the first owner of a member.
  void add(std::uint64_t member, std::uint32_t owner) {
    Slot& slot = slots_[placeOf(member)];
    if (slot.owner == kNoOwner) slot = {member, owner};
  }
  std::uint32_t ownerOf(std::uint64_t member) const { return slots_[placeOf(member)].owner; }

  static constexpr std::uint32_t kNoOwner = 0xffffffffU;

 private:
  struct Slot {
    std::uint64_t member = 0;
    std::uint32_t owner = kNoOwner;
  };
  /// The slot of the member, or the one into which it goes.
  std::size_t placeOf(std::uint64_t member) const {
    std::size_t place = mixedBits(member) & (slots_.size() - 1);
    while (slots_[place].owner != kNoOwner && slots_[place].member != member) place = (place + 1) & (slots_.size() - 1);
    return place;
  }

  std::vector<Slot> slots_;
};

}  // namespace

ObjectList listOf(const std::vector<ObjectMembers>& objects) {
  ObjectList list;
  list.reserve(objects.size());
  for (const ObjectMembers& object : objects) list.push_back(&object);
  return list;
}

std::vector<std::vector<CommonMembers>> commonMembers(const ObjectList& before, const ObjectList& after) {
  std::size_t members = 0;
  for (const ObjectMembers* object : after) members += object->seeds.size();
  OwnerTable owners(members);
  for (std::uint32_t a = 0; a < after.size(); ++a)
    for (const std::uint64_t seed : after[a]->seeds) owners.add(seed, a);
  std::vector<std::vector<CommonMembers>> common(before.size());
  for (std::size_t b = 0; b < before.size(); ++b) {
    std::map<std::uint32_t, std::size_t> shared;
    for (const std::uint64_t seed : before[b]->seeds)
      if (const std::uint32_t owner = owners.ownerOf(seed); owner != OwnerTable::kNoOwner) ++shared[owner];
    for (const auto& [owner, count] : shared) common[b].push_back({owner, count});
  }
  return common;
}

}  // namespace cluxel::mapping
