// SPDX-License-Identifier: Apache-2.0
// A grid of the places that are asked for; each member of the others looks around itself.
#include "mapping/change/member_places.hpp"

#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "mapping/clouds/scan_store.hpp"

namespace cluxel::mapping {

namespace {

using Steps = std::array<std::int32_t, 3>;

constexpr double kStep_m = 0.05;
constexpr std::int32_t kNear = 6;  ///< steps
static_assert(kNear * kStep_m > kSamePlace_m - 1e-9 && kNear * kStep_m < kSamePlace_m + 1e-9);
constexpr int kBits = 21;  ///< of each coordinate
constexpr std::int64_t kHalf = std::int64_t{1} << (kBits - 1), kMask = (std::int64_t{1} << kBits) - 1;
constexpr std::uint32_t kNone = 0xffffffffU;

Steps stepsOf(MemberPlace place) {
  Steps steps{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    steps[axis] = static_cast<std::int32_t>(static_cast<std::int64_t>(place >> (kBits * axis)) & kMask);
  return steps;
}

std::int64_t squaredDistance(const Steps& a, const Steps& b) {
  std::int64_t sum = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t difference = a[axis] - b[axis];
    sum += difference * difference;
  }
  return sum;
}

/// A member whose seed no other object has, and the nearest member of another so far. There may be millions of them.
struct Lookout {
  std::uint32_t object = 0;
  Steps steps{};
  std::int32_t nearest = kNear * kNear;
  std::uint32_t owner = kNoOwner;
  std::uint32_t member = 0;    ///< of the owner
  std::uint32_t next = kNone;  ///< in the same cell
};

class PlaceGrid {
 public:
  void add(const Lookout& lookout) {
    std::uint32_t& first = cells_.try_emplace(cellOf(lookout.steps, {0, 0, 0}), kNone).first->second;
    lookouts_.push_back(lookout);
    lookouts_.back().next = std::exchange(first, static_cast<std::uint32_t>(lookouts_.size() - 1));
  }
  const std::vector<Lookout>& lookouts() const { return lookouts_; }

  template <typename IsBetter>
  void offer(const Steps& steps, std::uint32_t owner, std::uint32_t member, const IsBetter& is_better) {
    for (std::int32_t x = -1; x <= 1; ++x)
      for (std::int32_t y = -1; y <= 1; ++y)
        for (std::int32_t z = -1; z <= 1; ++z) {
          const auto cell = cells_.find(cellOf(steps, {x, y, z}));
          if (cell == cells_.end()) continue;
          for (std::uint32_t number = cell->second; number != kNone; number = lookouts_[number].next) {
            Lookout& lookout = lookouts_[number];
            const std::int64_t distance = squaredDistance(lookout.steps, steps);
            if (distance > lookout.nearest) continue;
            if (distance == lookout.nearest && !is_better(owner, lookout.owner)) continue;
            lookout.nearest = static_cast<std::int32_t>(distance), lookout.owner = owner, lookout.member = member;
          }
        }
  }

 private:
  static std::uint64_t cellOf(const Steps& steps, const Steps& shift) {
    std::uint64_t cell = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
      cell = cell << kBits | static_cast<std::uint64_t>(steps[axis] / kNear + shift[axis] + 1);
    return cell;
  }

  std::vector<Lookout> lookouts_;
  std::unordered_map<std::uint64_t, std::uint32_t> cells_;  ///< the last one in it
};

}  // namespace

CloudMotions motionsBetween(const rdf::ReadTransaction& before, const std::vector<SeenCloud>& seen_before,
                            const std::vector<Cloud>& now) {
  std::map<ContentHash, ContentHash> contents;
  for (const SeenCloud& cloud : seen_before) contents.emplace(cloud.id, cloud.content);
  CloudMotions motions;
  const std::vector<SeenCloud> seen_now = seenClouds(now);
  for (std::size_t i = 0; i < now.size(); ++i) {
    const auto known = contents.find(now[i].id);
    if (known == contents.end() || known->second == seen_now[i].content) continue;
    if (const auto was = storedCloud(before, now[i].id))
      motions.emplace(now[i].id, now[i].T_map_sensor * was->T_map_sensor.inverse());
  }
  return motions;
}

CloudMotions motionsBy(const Eigen::Isometry3d& T, const std::vector<Cloud>& clouds) {
  CloudMotions motions;
  if (T.matrix().isIdentity(0)) return motions;
  for (const Cloud& cloud : clouds) motions.emplace(cloud.id, T);
  return motions;
}

MemberPlace placeOf(const Eigen::Vector3d& p_map) {
  MemberPlace place = std::uint64_t{1} << 63U;
  for (int axis = 0; axis < 3; ++axis)
    place |= static_cast<MemberPlace>((std::llround(p_map[axis] / kStep_m) + kHalf) & kMask) << (kBits * axis);
  return place;
}

std::vector<std::vector<SharedMembers>> sharedBySeedOrPlace(const ObjectList& objects, ObjectsOf objects_of,
                                                            const ObjectList& others) {
  std::vector<std::map<std::uint32_t, SharedMembers>> shared(objects.size());
  const auto add = [&](std::uint32_t object, std::uint32_t other) {
    ++shared[object].try_emplace(other, SharedMembers{other}).first->second.count;
  };
  std::optional<SeedOwners> owners(others);
  PlaceGrid grid;
  for (std::uint32_t object = 0; object < objects.size(); ++object)
    for (std::size_t member = 0; member < objects[object]->seeds.size(); ++member) {
      const std::uint32_t owner = owners->ownerOf(objects[object]->seeds[member]);
      if (owner != kNoOwner)
        add(object, owner);
      else if (const MemberPlace place = objects[object]->placeOf(member); place != kNoMemberPlace)
        grid.add({object, stepsOf(place)});
    }
  if (objects_of == ObjectsOf::OneMap)
    owners.emplace(objects);
  else
    owners.reset();
  const auto is_better = [&](std::uint32_t a, std::uint32_t b) {
    return b == kNoOwner || others[a]->id < others[b]->id;
  };
  for (std::uint32_t other = 0; other < others.size() && !grid.lookouts().empty(); ++other)
    for (std::uint32_t member = 0; member < others[other]->places.size(); ++member)
      if (const MemberPlace place = others[other]->places[member];
          place != kNoMemberPlace && (!owners || owners->ownerOf(others[other]->seeds[member]) == kNoOwner))
        grid.offer(stepsOf(place), other, member, is_better);
  std::set<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>> met;  // object, other and its member
  for (const Lookout& lookout : grid.lookouts())
    if (lookout.owner != kNoOwner && met.emplace(lookout.object, lookout.owner, lookout.member).second) {
      add(lookout.object, lookout.owner);
      shared[lookout.object].at(lookout.owner).is_by_place = true;
    }
  std::vector<std::vector<SharedMembers>> lists(objects.size());
  for (std::size_t object = 0; object < objects.size(); ++object)
    for (const auto& [other, members] : shared[object]) lists[object].push_back(members);
  return lists;
}

}  // namespace cluxel::mapping
