// SPDX-License-Identifier: Apache-2.0
// Which objects go on in which after a change.
#pragma once

#include <vector>

#include "mapping/change/member_places.hpp"

namespace cluxel::mapping {

/// For each object before, the objects after in which it goes on, ascending: those with its name, and those with which
/// it shares at least half of the members of the smaller of the two. Members are shared by seed points. Places count
/// for objects before that go on in none by their seeds, and for objects after that none goes on in by its seeds. The
/// objects after have no common members with each other. Cost: linear in the members.
std::vector<std::vector<SharedMembers>> successorsOf(const ObjectList& before, ObjectsOf objects_of,
                                                     const ObjectList& after);

}  // namespace cluxel::mapping
