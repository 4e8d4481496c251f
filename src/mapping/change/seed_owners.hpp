// SPDX-License-Identifier: Apache-2.0
// Which object holds a seed point.
#pragma once

#include <cstdint>
#include <vector>

#include "mapping/change/object_changes.hpp"

namespace cluxel::mapping {

/// Objects that are compared, by address: they hold many members.
using ObjectList = std::vector<const ObjectMembers*>;
ObjectList listOf(const std::vector<ObjectMembers>& objects);

inline constexpr std::uint32_t kNoOwner = 0xffffffffU;

/// Open addressing, two thirds full: a node for each member would cost most of a comparison.
class SeedOwners {
 public:
  /// Of a seed that several objects hold, the first one counts.
  explicit SeedOwners(const ObjectList& objects);
  /// The number of an object, or kNoOwner.
  std::uint32_t ownerOf(std::uint64_t seed) const { return slots_[slotOf(seed)].owner; }

 private:
  struct Slot {
    std::uint64_t seed = 0;
    std::uint32_t owner = kNoOwner;
  };
  /// The slot of the seed, or the one into which it goes.
  std::size_t slotOf(std::uint64_t seed) const;

  std::vector<Slot> slots_;
};

}  // namespace cluxel::mapping
