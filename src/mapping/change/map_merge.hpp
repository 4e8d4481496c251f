// SPDX-License-Identifier: Apache-2.0
// Merges maps into a new one: the very map that a build from all of their scans would give.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "mapping/change/map_editor.hpp"

namespace cluxel::mapping {

struct MapToMerge {
  std::filesystem::path file;
  /// From this map's frame to that of the first map.
  Eigen::Isometry3d T_first_map = Eigen::Isometry3d::Identity();
  /// The transform was measured, also when it is the identity: the map may have another map origin or coordinate
  /// system.
  bool has_transform = false;
};

struct MergeParams {
  ChangeParams change;
  std::optional<std::size_t> use;  ///< the map whose ontology, rules and model are used; absent: they must be equal
  bool force = false;              ///< replace another map, or an empty file, that is there
  bool drop_statements = false;    ///< with `force`: also when that map has operator statements of its own
  /// A map that meets the others in more tiles does not lend what it decided: what lies along a border is decided at
  /// once.
  std::size_t max_border_tiles = 100;
};

/// Merges `maps` (at least two) into `target`. Scans that several maps hold with the same pose count once. Operator
/// statements of all maps are kept, but those that one of them has withdrawn since. The result appears under its name
/// when it is complete; a killed merge leaves TARGET.merging, which the next one removes. Without `force` a target that
/// is the merge of these maps already, their history included, is left as it is, with a note. Throws Error
/// (InvalidArgument) for another map there; with `force`, for one that has operator statements which the maps lack,
/// unless `drop_statements` is set; when inputs, map origin or coordinate system differ, or a file is named twice;
/// StoreUnavailable for a target that is no map; InputError when a scan has two poses. With `dry_run` the work is done
/// on a copy beside TARGET, or in the folder for temporary files when nothing may be written there; it is removed.
ChangeReport mergeMaps(const std::vector<MapToMerge>& maps, const std::filesystem::path& target,
                       const MergeParams& params, ProgressSink& sink);

}  // namespace cluxel::mapping
