// SPDX-License-Identifier: Apache-2.0
// The kinds of surfaces of the generated campus: their ids in a scan's `label` field, and their truth.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "scan/truth/primitive_label.hpp"

namespace cluxel::simulation {

/// The label id of a surface; labels/campus.yaml maps the same ids for training and scoring.
enum class SurfaceLabel : std::uint32_t {
  Lawn = 1,
  Path,
  Street,
  Kerb,
  Crossing,
  Sidewalk,
  Facade = 10,
  Window,
  Door,
  Ledge,
  FlatRoof,
  GabledRoof,
  BuildingColumn,
  Stairs,
  TreeTrunk = 20,
  TreeBranch,
  TreeTop,
  BushTop = 30,
  HedgeTop,
  LampPole = 40,
  LampArm,
  LampHead,
  SignPole = 50,
  SignPlate,
  UtilityPole = 60,
  Crossarm,
  CarBody = 70,
  CarWindow,
  CarWheel,
  Bin = 80,
  Bench,
  Bollard,
  Fence,
  Hydrant,
  Person,
  Bicycle,
  Motorcycle,
  Wire = 90,
  LeafClutter,
  Thicket,
};

/// The truth of a surface. Absent fields are left out of training and scoring.
struct SurfaceInfo {
  SurfaceLabel label;
  std::string_view name;  ///< snake_case
  std::optional<scan::PrimitiveLabel> primitive;
  std::string_view object_class;  ///< a name of truthClassNames(), or empty
  std::string_view part;          ///< local name of the part in the ontology, or empty
  int object_number = -1;         ///< the class's number in truth files, -1: none
};

/// All surfaces, in the order of their ids.
std::span<const SurfaceInfo> surfaceInfos();
const SurfaceInfo& infoOf(SurfaceLabel label);

}  // namespace cluxel::simulation
