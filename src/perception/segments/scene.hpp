// SPDX-License-Identifier: Apache-2.0
// The scene: all primitives with their relations, and their cluxels with the graph. It is the input of the rules.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "perception/segments/primitive.hpp"
#include "perception/tile.hpp"
#include "perception/visibility/sensor_sight.hpp"

namespace cluxel::perception {

/// Relations between primitives. relationInfos() gives formulas and tolerances.
enum class RelationKind : std::uint8_t {
  Intersects,
  Touches,
  TouchesGround,
  Above,
  Below,
  Supports,
  StandsOn,
  Inside,
  Near,
  ParallelTo,
  Alongside,
  Count_
};
inline constexpr std::size_t kRelationKindCount = static_cast<std::size_t>(RelationKind::Count_);

struct RelationInfo {
  RelationKind kind;
  std::string_view name;      ///< snake_case, as rules write it: "touches_ground"
  std::string_view property;  ///< local name of the RDF property: "touchesGround"
  std::string_view help;      ///< the formula in words, with its tolerance in metres
};
const std::array<RelationInfo, kRelationKindCount>& relationInfos();
std::optional<RelationKind> relationKindOf(std::string_view name);

struct Relation {
  RelationKind kind = RelationKind::Near;
  PrimitiveIndex from = 0, to = 0;
  double measure = 0;  ///< the value that is compared with the tolerance: a gap or distance [m], or a share
  auto operator<=>(const Relation&) const = default;
};

/// A cluxel's seed point: the number of its scan in SceneCluxels::scans, and the point's number in that scan.
struct SeedName {
  std::uint32_t scan = 0, point = 0;
};

/// The seed points of the cluxels of a scene.
struct SceneSeeds {
  std::vector<SeedName> seed;      ///< identifies a cluxel independently of the other points of its tile
  std::vector<ContentHash> scans;  ///< ids of the scans of `seed`, ascending
};

/// Cluxels of the whole scene as a structure of arrays, sorted by tile and number, with their graph in CSR form.
struct SceneCluxels : SceneSeeds {
  TileGrid grid;  ///< of the map
  std::vector<CluxelName> name;
  std::vector<Eigen::Vector3d> center;      ///< mean of own points [m, map]
  std::vector<Eigen::Vector3f> extent;      ///< size of the box around own points [m]
  std::vector<Eigen::Vector3d> low_corner;  ///< of that box [m, map]
  std::vector<std::uint32_t> point_count;
  std::vector<PrimitiveIndex> primitive;
  std::vector<std::uint32_t> component;  ///< number in the tile's ComponentTile; empty but for assembled scenes
  std::vector<scan::PrimitiveLabel> label;
  std::vector<std::array<float, scan::kPrimitiveLabelCount>> probability;
  std::vector<float> height_above_ground;  ///< of the centre [m]
  std::vector<std::uint32_t> edge_offset;  ///< size() + 1 entries
  std::vector<std::uint32_t> edge_target;  ///< ascending within a cluxel; both directions are stored

  std::size_t size() const { return name.size(); }
  std::span<const std::uint32_t> neighbours(std::uint32_t cluxel) const {
    return {edge_target.data() + edge_offset[cluxel], edge_target.data() + edge_offset[cluxel + 1]};
  }
};

/// A scan of which the place of the sensor is known.
struct SceneView {
  ContentHash scan;
  Eigen::Isometry3d T_map_sensor = Eigen::Isometry3d::Identity();
  SensorSight sight;
};

struct Scene {
  SceneCluxels cluxels;
  std::vector<SceneView> views;                ///< ascending by scan
  std::vector<Primitive> primitives;           ///< sorted by id
  std::vector<Relation> relations;             ///< sorted; symmetric ones are stored in both directions
  std::vector<std::uint32_t> relation_offset;  ///< per primitive, the first of its relations (`from`); size + 1 entries

  std::span<const Relation> relationsOf(PrimitiveIndex primitive) const {
    return {relations.data() + relation_offset[primitive], relations.data() + relation_offset[primitive + 1]};
  }
};

/// Sorts relations and fills relation_offset.
void indexRelations(Scene& scene);

}  // namespace cluxel::perception
