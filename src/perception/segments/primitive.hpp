// SPDX-License-Identifier: Apache-2.0
// Primitives: connected cluxels of one label (the paper's clusters), with the attributes that rules read.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "base/content_hash.hpp"
#include "perception/tile.hpp"
#include "scan/truth/primitive_label.hpp"

namespace cluxel::perception {

enum class Dimension : std::uint8_t { Length, Area, Volume, Angle, Ratio, Count };  ///< m, m2, m3, rad, 1, 1

/// The attributes of a primitive. attributeInfos() gives name, unit, range and meaning.
enum class Attribute : std::uint8_t {
  Height,               ///< vertical extent [m]
  HorizontalExtent,     ///< larger side of the smallest-area yaw-aligned box [m]
  HorizontalThickness,  ///< smaller side of that box [m]
  Length,               ///< the larger side of the box (= HorizontalExtent), for car-like things [m]
  Width,                ///< the smaller side of the box [m]
  FootprintArea,        ///< area of occupied 0.25 m map cells [m2]
  Volume,               ///< volume of the yaw-aligned box [m3]
  Bottom,               ///< height of the lowest point above the local ground [m]
  Top,                  ///< height of the highest point above the local ground [m]
  ElevationSpan,        ///< Top - Bottom [m]
  FreeHeightBelow,      ///< clear height below it: its median height above the ground [m]
  NormalTilt,           ///< angle between the best plane's normal and the vertical [rad]
  AxisTilt,             ///< angle between the main axis and the vertical [rad]
  Linearity,
  Planarity,
  Scattering,  ///< (l1-l2)/l1, (l2-l3)/l1, l3/l1 of the covariance's eigenvalues l1>=l2>=l3
  Radius,      ///< rms distance of points to the main axis [m]
  Roughness,   ///< rms distance to the best plane [m]
  PointCount,
  CluxelCount,
  Probability,    ///< mean probability of the label over its points
  GroundContact,  ///< share of its lowest 0.3 m that touches ground
  ViewCount,      ///< number of scans that saw it
  MeanIntensity,  ///< mean intensity when the scans have it, else 0
  Count_
};
inline constexpr std::size_t kAttributeCount = static_cast<std::size_t>(Attribute::Count_);

struct AttributeInfo {
  Attribute attribute;
  std::string_view name;      ///< snake_case, as rules write it
  std::string_view property;  ///< local name of the RDF property: "horizontalExtent"
  Dimension dimension;
  std::string_view help;
};
/// One row per attribute, in the order of the enumeration.
const std::array<AttributeInfo, kAttributeCount>& attributeInfos();
std::optional<Attribute> attributeOf(std::string_view name);
/// Whether it depends on where the thing ends: a scan that does not show the end measures too little.
bool isOfAnEnd(Attribute attribute);

/// An upright box. `yaw`: angle of its length axis from the map's x [rad, in [-pi/2, pi/2)].
struct UprightBox {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< [m, map frame]
  Eigen::Vector3d size = Eigen::Vector3d::Zero();    ///< length, width, height [m]
  double yaw_rad = 0;
};

/// A cluxel's name: tile and number within the tile.
struct CluxelName {
  TileKey tile;
  std::uint32_t index = 0;
  auto operator<=>(const CluxelName&) const = default;
};

using PrimitiveIndex = std::uint32_t;

struct Primitive {
  ContentHash id;  ///< hash of the label and the sorted members
  scan::PrimitiveLabel label = scan::PrimitiveLabel::Scatter;
  std::vector<std::uint32_t> cluxels;  ///< numbers in SceneCluxels, ascending
  std::array<double, kAttributeCount> attributes{};
  std::array<float, scan::kPrimitiveLabelCount> probabilities{};  ///< mean over points
  UprightBox box;
  Eigen::Vector3d min = Eigen::Vector3d::Zero(), max = Eigen::Vector3d::Zero();  ///< axis-parallel bounds [m, map]
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();                            ///< mean of its points [m, map]
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();                               ///< main axis, z >= 0
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();                             ///< best plane's normal, z >= 0
  double ground_z = 0;               ///< height of the local ground under its centroid [m, map]
  std::vector<std::uint32_t> views;  ///< numbers in Scene::views of the scans that saw it, ascending

  double operator[](Attribute attribute) const { return attributes[static_cast<std::size_t>(attribute)]; }
};

}  // namespace cluxel::perception
