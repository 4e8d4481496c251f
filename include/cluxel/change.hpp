// SPDX-License-Identifier: Apache-2.0
// Changes of a map: how to make them, and what they did to its objects.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace cluxel {

struct ChangeOptions {
  std::filesystem::path poses = {};  ///< poses of added scans, as in BuildOptions
  unsigned threads = 0;              ///< 0: one per processor; the map does not depend on it
  /// A batch of scans is committed when it has this many points, at least 1. Absent: 70 million where scans are added,
  /// 6 million where they move or maps are merged.
  std::optional<std::uint64_t> batch_points = {};
  bool dry_run = false;  ///< compute what would change, and write nothing
};

struct MergeOptions {
  unsigned threads = 0;                            ///< as in ChangeOptions
  std::optional<std::uint64_t> batch_points = {};  ///< as in ChangeOptions
  /// Of two maps: takes points of the second to the frame of the first, 4x4 row by row, translation in metres; a rigid
  /// motion within 1e-6. Given, also as the identity, it allows another map origin and coordinate system.
  std::optional<std::array<double, 16>> T_first_second = {};
  std::filesystem::path use = {};  ///< the map of them whose ontology, rules and model are used; empty: all agree
  bool force = false;              ///< replace another map, or an empty file, that is there
  /// With `force`: replace that map also when it has operator statements, or withdrawals of them, which the maps to be
  /// merged do not have. They are lost.
  bool drop_statements = false;
  bool dry_run = false;  ///< of mergeInto(): compute what it would make, and leave the target as it is
};

/// Another pose of a scan that is in the map.
struct CloudPose {
  std::string cloud;                      ///< its id (four digits or more), source path or file name
  std::array<double, 16> T_map_sensor{};  ///< as in Cloud: a rigid motion
};

/// Added: continues no object. Gone: no object continues it. Changed: continues one, with other members or another
/// class. Split: one of several objects that continue one. Joined: continues several. Redecided: has the same members
/// and class, and other parts, another rule or another confidence.
enum class ChangeKind : std::uint8_t { Added, Gone, Changed, Split, Joined, Redecided };

/// An object that a change added, removed or altered.
struct ObjectChange {
  ChangeKind kind = ChangeKind::Changed;
  std::string iri;                        ///< of Gone: the IRI that it had
  std::string class_name;                 ///< "Tree"; by IRI if that name is another's
  std::vector<std::string> derived_from;  ///< IRIs of Changed, Split and Joined before the change
};

/// What a change did. Object B continues object A when they share at least half of the cluxels of the smaller one.
/// Cluxels are matched by seed point, and by position where seed points match no object.
struct MapChanges {
  std::size_t scans_added = 0, scans_already_there = 0, scans_removed = 0, scans_moved = 0;
  std::size_t tiles_changed = 0;      ///< tiles of 16 m of which something was computed anew and differs
  std::size_t objects_unchanged = 0;  ///< without those of ChangeKind::Redecided
  std::vector<ObjectChange> objects;  ///< by kind, then by IRI
};

}  // namespace cluxel
