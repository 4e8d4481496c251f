// SPDX-License-Identifier: Apache-2.0
// Which objects before and after a change hold the same measured points, and how many of them.
#pragma once

#include <cstdint>
#include <vector>

#include "mapping/change/object_changes.hpp"

namespace cluxel::mapping {

/// Objects that are compared, by address: they hold many members.
using ObjectList = std::vector<const ObjectMembers*>;
ObjectList listOf(const std::vector<ObjectMembers>& objects);

struct CommonMembers {
  std::uint32_t after = 0;  ///< number of an object
  std::size_t count = 0;
};

/// For each object before, the objects after that share members with it, ascending. The objects after have no common
/// members with each other. Cost: linear in the members.
std::vector<std::vector<CommonMembers>> commonMembers(const ObjectList& before, const ObjectList& after);

}  // namespace cluxel::mapping
