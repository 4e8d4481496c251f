// SPDX-License-Identifier: Apache-2.0
// A flat table.
#include "mapping/change/seed_owners.hpp"

#include "base/mixed_bits.hpp"

namespace cluxel::mapping {

ObjectList listOf(const std::vector<ObjectMembers>& objects) {
  ObjectList list;
  list.reserve(objects.size());
  for (const ObjectMembers& object : objects) list.push_back(&object);
  return list;
}

SeedOwners::SeedOwners(const ObjectList& objects) {
  std::size_t members = 0;
  for (const ObjectMembers* object : objects) members += object->seeds.size();
  slots_.resize(members + members / 2 + 1);
  for (std::uint32_t owner = 0; owner < objects.size(); ++owner)
    for (const std::uint64_t seed : objects[owner]->seeds)
      if (Slot& slot = slots_[slotOf(seed)]; slot.owner == kNoOwner) slot = {seed, owner};
}

std::size_t SeedOwners::slotOf(std::uint64_t seed) const {
  __extension__ using Number128 = unsigned __int128;
  auto slot = static_cast<std::size_t>((static_cast<Number128>(mixedBits(seed)) * slots_.size()) >> 64U);
  while (slots_[slot].owner != kNoOwner && slots_[slot].seed != seed) slot = slot + 1 < slots_.size() ? slot + 1 : 0;
  return slot;
}

}  // namespace cluxel::mapping
