// SPDX-License-Identifier: Apache-2.0
// When objects were there, kept in the map: a change computes it anew only for objects that it reaches.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "base/content_hash.hpp"
#include "mapping/clouds/cloud.hpp"
#include "mapping/presence/object_rows.hpp"
#include "mapping/presence/presence_votes.hpp"
#include "mapping/presence/ray_targets.hpp"
#include "perception/visibility/presence.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::mapping {

/// Presence is a function of places on an object and of the clouds whose rays may pass it: where both are those of the
/// stored presence, that is taken.
class PresenceUpdate {
 public:
  /// `targets` must outlive it.
  PresenceUpdate(const rdf::ReadTransaction& transaction, std::span<const RayTarget> targets,
                 const std::vector<Cloud>& clouds, unsigned threads);
  /// Looks at rays for the objects of which presence is not known; null when there are none.
  RayObserver* observer() { return voting_ ? &*voting_ : nullptr; }
  std::size_t unknownCount() const { return unknown_.size(); }
  /// When each was there, after the observer has seen all rays. Stores the outcome.
  std::vector<std::optional<perception::Presence>> finish(rdf::WriteTransaction& transaction, Covered covered);

 private:
  bool is_told_ = false;                                       ///< two clouds or more have a time and a pose
  std::vector<ContentHash> ids_;                               ///< of each target
  std::vector<std::optional<ContentHash>> causes_;             ///< of its row; absent when it has none
  std::vector<std::optional<perception::Presence>> presence_;  ///< of each target
  std::vector<std::size_t> unknown_;                           ///< numbers of targets
  std::optional<PresenceVoting> voting_;
};

/// The objects of the stored rows that are gone: a scan saw through their place after they were there last
/// (clx:seenThrough). Ascending. Cost: about 100 ns a row.
std::vector<ContentHash> objectsSeenThrough(const rdf::ReadTransaction& transaction);

}  // namespace cluxel::mapping
