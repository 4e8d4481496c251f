// SPDX-License-Identifier: Apache-2.0
// The table of surfaces. labels/campus.yaml repeats it; a test compares the two.
#include "simulation/laser/surface_label.hpp"

#include <algorithm>
#include <array>
#include <cassert>

#include "scan/truth/truth.hpp"

namespace cluxel::simulation {
namespace {

using enum scan::PrimitiveLabel;
using L = SurfaceLabel;
constexpr std::nullopt_t kNone = std::nullopt;

constexpr std::array kSurfaces{
    SurfaceInfo{L::Lawn, "lawn", HorizontalPlane, "Ground", ""},
    SurfaceInfo{L::Path, "path", HorizontalPlane, "Ground", ""},
    SurfaceInfo{L::Street, "street", HorizontalPlane, "Ground", ""},
    SurfaceInfo{L::Kerb, "kerb", HorizontalPlane, "Ground", ""},
    SurfaceInfo{L::Crossing, "crossing", HorizontalPlane, "Ground", ""},
    SurfaceInfo{L::Sidewalk, "sidewalk", HorizontalPlane, "Ground", ""},
    SurfaceInfo{L::Facade, "facade", VerticalPlane, "Building", "Facade"},
    SurfaceInfo{L::Window, "window", VerticalPlane, "Building", "Facade"},
    SurfaceInfo{L::Door, "door", VerticalPlane, "Building", "Facade"},
    SurfaceInfo{L::Ledge, "ledge", VerticalPlane, "Building", "Facade"},
    SurfaceInfo{L::FlatRoof, "flat_roof", HorizontalPlane, "Building", "Roof"},
    SurfaceInfo{L::GabledRoof, "gabled_roof", kNone, "Building", "Roof"},
    SurfaceInfo{L::BuildingColumn, "building_column", Column, "Building", ""},
    SurfaceInfo{L::Stairs, "stairs", kNone, "Building", ""},
    SurfaceInfo{L::TreeTrunk, "tree_trunk", Column, "Tree", "TreeTrunk"},
    SurfaceInfo{L::TreeBranch, "tree_branch", Scatter, "Tree", "TreeTop"},
    SurfaceInfo{L::TreeTop, "tree_top", Scatter, "Tree", "TreeTop"},
    SurfaceInfo{L::BushTop, "bush", Scatter, "Bush", ""},
    SurfaceInfo{L::HedgeTop, "hedge", Scatter, "Bush", ""},
    SurfaceInfo{L::LampPole, "lamp_pole", Column, "StreetLamp", "LampPole"},
    SurfaceInfo{L::LampArm, "lamp_arm", SmallStructure, "StreetLamp", "LampHead"},
    SurfaceInfo{L::LampHead, "lamp_head", SmallStructure, "StreetLamp", "LampHead"},
    SurfaceInfo{L::SignPole, "sign_pole", Column, "StreetSign", "SignPole"},
    SurfaceInfo{L::SignPlate, "sign_plate", SmallStructure, "StreetSign", "SignPlate"},
    SurfaceInfo{L::UtilityPole, "utility_pole", Column, "UtilityPole", "PoleMast"},
    SurfaceInfo{L::Crossarm, "crossarm", kNone, "UtilityPole", "PoleCrossarm"},
    SurfaceInfo{L::CarBody, "car_body", SmallStructure, "Vehicle", ""},
    SurfaceInfo{L::CarWindow, "car_window", SmallStructure, "Vehicle", ""},
    SurfaceInfo{L::CarWheel, "car_wheel", SmallStructure, "Vehicle", ""},
    SurfaceInfo{L::Bin, "bin", SmallStructure, "SmallObject", ""},
    SurfaceInfo{L::Bench, "bench", SmallStructure, "SmallObject", ""},
    SurfaceInfo{L::Bollard, "bollard", Column, "SmallObject", ""},
    SurfaceInfo{L::Fence, "fence", VerticalPlane, "SmallObject", ""},
    SurfaceInfo{L::Hydrant, "hydrant", SmallStructure, "SmallObject", ""},
    SurfaceInfo{L::Person, "person", SmallStructure, "SmallObject", ""},
    SurfaceInfo{L::Bicycle, "bicycle", SmallStructure, "SmallObject", ""},
    SurfaceInfo{L::Motorcycle, "motorcycle", SmallStructure, "SmallObject", ""},
    SurfaceInfo{L::Wire, "wire", kNone, "", ""},
    SurfaceInfo{L::LeafClutter, "leaf_clutter", Scatter, "", ""},
    SurfaceInfo{L::Thicket, "thicket", Scatter, "", ""},
};

std::array<SurfaceInfo, kSurfaces.size()> numbered() {
  auto surfaces = kSurfaces;
  const auto& classes = scan::truthClassNames();
  for (SurfaceInfo& surface : surfaces) {
    const auto found = std::find(classes.begin(), classes.end(), surface.object_class);
    if (found != classes.end()) surface.object_number = static_cast<int>(found - classes.begin());
  }
  return surfaces;
}

}  // namespace

std::span<const SurfaceInfo> surfaceInfos() {
  static const auto surfaces = numbered();
  return surfaces;
}

const SurfaceInfo& infoOf(SurfaceLabel label) {
  const auto surfaces = surfaceInfos();
  const auto found =
      std::find_if(surfaces.begin(), surfaces.end(), [label](const SurfaceInfo& info) { return info.label == label; });
  assert(found != surfaces.end());
  return *found;
}

}  // namespace cluxel::simulation
