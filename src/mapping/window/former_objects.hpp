// SPDX-License-Identifier: Apache-2.0
// The members of objects as they were before a change.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "mapping/build/tile_stages.hpp"
#include "mapping/change/member_places.hpp"
#include "mapping/layers/tile_layer.hpp"
#include "mapping/stored_grid.hpp"
#include "mapping/window/map_window.hpp"

namespace cluxel::mapping {

/// Collects the members of objects from the layers of tiles.
class MemberLists {
 public:
  /// Places are where the seed points are after `motions`.
  explicit MemberLists(const rdf::ReadTransaction& transaction, CloudMotions motions = {})
      : transaction_(transaction), grid_(storedGrid(transaction)), motions_(std::move(motions)) {}
  /// Adds the members that `layer` holds of the objects for which `is_wanted`. `summary`: of the same tile, of which
  /// places matter when its seeds may be others afterwards.
  void add(const TileLayer& layer, const perception::SummaryTile& summary, bool has_places,
           const std::function<bool(const ContentHash&)>& is_wanted);
  /// Sorted by id.
  std::vector<ObjectMembers> take();

 private:
  struct Collected {
    ObjectMembers members;
    bool is_class_wide = false;
  };

  /// For each scan of a tile how it has moved; null for one that has not.
  std::vector<const Eigen::Isometry3d*> motionsOf(const std::vector<ContentHash>& scans) const;

  const rdf::ReadTransaction& transaction_;
  perception::TileGrid grid_;
  CloudMotions motions_;
  std::map<ContentHash, Collected> objects_;
};

/// All objects of a map as it is stored, read tile by tile, with places as after `motions`. Memory: 16 bytes a cluxel,
/// of class-wide objects 8.
std::vector<ObjectMembers> storedMembers(const rdf::ReadTransaction& transaction, CloudMotions motions = {});

/// Collects members from the layers of tiles that are not written yet.
class FormerObjects {
 public:
  /// `stages` holds the summaries of the tiles that did not change. `will_change`: tiles of which the seeds may be
  /// others later in the same change.
  FormerObjects(const rdf::ReadTransaction& transaction, const TileStages& stages, FormerSummaries& former,
                std::function<bool(const perception::TileKey&)> will_change, CloudMotions motions)
      : stages_(stages),
        former_(former),
        will_change_(std::move(will_change)),
        members_(transaction, std::move(motions)) {}

  /// Adds the members that `layer` holds of the objects for which `is_wanted`.
  void add(const TileLayer& layer, const std::function<bool(const ContentHash&)>& is_wanted);
  /// Sorted by id.
  std::vector<ObjectMembers> take() { return members_.take(); }

 private:
  /// The summary that the tile had when the layer was written. Null where there was none.
  const perception::SummaryTile* summaryOf(const perception::TileKey& tile) const;

  const TileStages& stages_;
  FormerSummaries& former_;
  std::function<bool(const perception::TileKey&)> will_change_;
  MemberLists members_;
};

/// All objects of the map before the change, while its layers are not written yet. Memory as above.
std::vector<ObjectMembers> formerObjects(const rdf::ReadTransaction& transaction, const OutputChanges& changes,
                                         CloudMotions motions);

}  // namespace cluxel::mapping
