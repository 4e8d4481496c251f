// SPDX-License-Identifier: Apache-2.0
// Functions that make one object each: they add the object and its surfaces to the campus and return its instance id.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "simulation/site/campus_site.hpp"

namespace cluxel::simulation {

void makeGround(CampusSite& site);

struct BuildingSpec {
  Eigen::AlignedBox2d footprint;
  int floors = 2;
  bool gabled = false;
  bool portico = false;  ///< columns and a canopy before the middle of the south side
};
std::int32_t makeBuilding(CampusSite& site, const BuildingSpec& spec, CampusRandom random);

enum class TreeShape { Round, Conical, Columnar, Spreading };
struct TreeSpec {
  TreeShape shape = TreeShape::Round;
  double crown_radius_m = 3;
  double clear_trunk_m = 2.2;  ///< height of the lowest leaves
  double height_m = 8;
};
/// Usual dimensions of a shape.
TreeSpec usualTree(TreeShape shape, CampusRandom& random);
std::int32_t makeTree(CampusSite& site, const Eigen::Vector2d& place, const TreeSpec& spec, CampusRandom random);

std::int32_t makeBush(CampusSite& site, const Eigen::Vector2d& place, double radius, CampusRandom random);
std::int32_t makeHedge(CampusSite& site, const Eigen::Vector2d& from, const Eigen::Vector2d& to, CampusRandom random);
/// Higher vegetation is not part of the truth, because annotators disagree whether it is a bush or a tree.
inline constexpr double kBushTop_m = 1.6;
struct ThicketSpec {
  double height_m = 2;
  double half_depth_m = 0.8;
};
/// A thicket of merged shrubs. Up to kBushTop_m it is one bush; higher ones are leaves without an object.
void makeThicket(CampusSite& site, const Eigen::Vector2d& from, const Eigen::Vector2d& to, const ThicketSpec& spec,
                 CampusRandom random);

/// `yaw_rad` is the direction of the arm.
std::int32_t makeStraightLamp(CampusSite& site, const Eigen::Vector2d& place, CampusRandom random);
std::int32_t makeArmLamp(CampusSite& site, const Eigen::Vector2d& place, double yaw_rad, CampusRandom random);

struct SignSpec {
  double yaw_rad = 0;  ///< where the face looks
  int plates = 1;
  bool leaves = false;  ///< a clutter of leaves on top
};
std::int32_t makeSign(CampusSite& site, const Eigen::Vector2d& place, const SignSpec& spec, CampusRandom random);

/// A row of poles along x with wires between them.
void makeUtilityLine(CampusSite& site, const std::vector<Eigen::Vector2d>& places, CampusRandom random);

/// `yaw_rad` is the heading of the car.
std::int32_t makeCar(CampusSite& site, const Eigen::Vector2d& place, double yaw_rad, CampusRandom random);

std::int32_t makeBin(CampusSite& site, const Eigen::Vector2d& place, CampusRandom random);
std::int32_t makeBench(CampusSite& site, const Eigen::Vector2d& place, double yaw_rad, CampusRandom random);
std::int32_t makeBollard(CampusSite& site, const Eigen::Vector2d& place, CampusRandom random);
enum class FenceKind { Pickets, Bars, WireMesh, Boards, LowWall };
std::int32_t makeFence(CampusSite& site, const Eigen::Vector2d& from, const Eigen::Vector2d& to, FenceKind kind,
                       CampusRandom random);
enum class CycleKind { Bicycle, Motorcycle };
/// `yaw_rad` is its heading.
std::int32_t makeCycle(CampusSite& site, const Eigen::Vector2d& place, double yaw_rad, CycleKind kind,
                       CampusRandom random);
std::int32_t makeHydrant(CampusSite& site, const Eigen::Vector2d& place, CampusRandom random);
std::int32_t makePerson(CampusSite& site, const Eigen::Vector2d& place, CampusRandom random);

/// The layout functions in the order of their calls. Each uses the ground that the earlier ones left free.
void layOutBuildings(CampusSite& site);
void plantAvenues(CampusSite& site);
void furnishStreet(CampusSite& site);
void furnishPaths(CampusSite& site);
void plantLawns(CampusSite& site);
void layOutBorders(CampusSite& site);

/// The y coordinates of the trees on each side of the avenue along the west path.
std::vector<double> avenueRows(const SitePlan& plan);
inline constexpr double kAvenueAside_m = 2.9;  ///< from the middle of the path to the trunks

}  // namespace cluxel::simulation
