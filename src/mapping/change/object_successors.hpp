// SPDX-License-Identifier: Apache-2.0
// Which objects after a change continue which objects before it.
#pragma once

#include <vector>

#include "mapping/change/member_places.hpp"

namespace cluxel::mapping {

/// For each object before, its successors, ascending: the objects after with its name, and those with which it shares
/// at least half of the members of the smaller of the two. Members are shared by seed points. Places count for objects
/// before that none continues by seeds, and for objects after that continue none by seeds. They also count where seeds
/// do not tell which object after has most of the members of an object before. Class-wide objects have no successor and
/// no predecessor but by name. The objects after have no common members
/// with each other. Cost: linear in the members.
std::vector<std::vector<SharedMembers>> successorsOf(const ObjectList& before, ObjectsOf objects_of,
                                                     const ObjectList& after);

/// Whether an object after has most of the members of one before by their seeds: it is surely the same, and nothing
/// that merely stands near. Cost: n log n in the members.
bool holdsMostOf(const ObjectMembers& before, const ObjectMembers& after);

}  // namespace cluxel::mapping
