// SPDX-License-Identifier: Apache-2.0
// A flat table.
#include "mapping/change/seed_owners.hpp"

#include <bit>

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
  slots_.resize(std::bit_ceil(2 * members + 1));
  for (std::uint32_t owner = 0; owner < objects.size(); ++owner)
    for (const std::uint64_t seed : objects[owner]->seeds)
      if (Slot& slot = slots_[slotOf(seed)]; slot.owner == kNoOwner) slot = {seed, owner};
}

std::size_t SeedOwners::slotOf(std::uint64_t seed) const {
  std::size_t slot = mixedBits(seed) & (slots_.size() - 1);
  while (slots_[slot].owner != kNoOwner && slots_[slot].seed != seed) slot = (slot + 1) & (slots_.size() - 1);
  return slot;
}

}  // namespace cluxel::mapping
