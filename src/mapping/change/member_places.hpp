// SPDX-License-Identifier: Apache-2.0
// Where the cluxels of objects are: with more scans other points of a place become seeds, and only the place tells
// which object continues which.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <vector>

#include "mapping/change/seed_owners.hpp"
#include "mapping/clouds/cloud.hpp"
#include "mapping/layers/semantic_state.hpp"

namespace cluxel::mapping {

/// How clouds have moved, by id: from where their points were to where they are. Those that stayed are not listed.
using CloudMotions = std::map<ContentHash, Eigen::Isometry3d>;
/// Of the clouds that a map has before and now. `seen_before`: the clouds that `before` has, as its facts count them.
CloudMotions motionsBetween(const rdf::ReadTransaction& before, const std::vector<SeenCloud>& seen_before,
                            const std::vector<Cloud>& now);
/// All clouds move by `T`; none when it is the identity.
CloudMotions motionsBy(const Eigen::Isometry3d& T, const std::vector<Cloud>& clouds);

/// `p_map` [m] in steps of 5 cm. Within some 52 km of the origin no two places are the same.
MemberPlace placeOf(const Eigen::Vector3d& p_map);

/// The members that an object shares with one of the others.
struct SharedMembers {
  std::uint32_t other = 0;  ///< number in the list of the others
  std::size_t count = 0;
  bool is_by_place = false;  ///< the seeds alone would be too few
};

/// For each object, the members that it shares with each of the others, ascending. A member is shared by its seed; if
/// none of the others has the seed, with the nearest member within kSamePlace_m (ties: the smallest id).
/// ObjectsOf::OneMap: a member of the others whose seed one of `objects` has is no candidate. A candidate counts once
/// per object. Cost: linear in the members.
std::vector<std::vector<SharedMembers>> sharedBySeedOrPlace(const ObjectList& objects, ObjectsOf objects_of,
                                                            const ObjectList& others);

/// A cluxel reaches 0.2 m from its seed, so that another one of the same points has its centre nearer than this.
inline constexpr double kSamePlace_m = 0.3;

}  // namespace cluxel::mapping
