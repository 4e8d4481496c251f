// SPDX-License-Identifier: Apache-2.0
// Buildings with recessed windows, ledges, doors, steps, flat or gabled roofs and porticos.
#include <algorithm>
#include <cmath>

#include "simulation/makers/facade.hpp"
#include "simulation/makers/makers.hpp"

namespace cluxel::simulation {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

/// Surfaces and dimensions shared by the parts of one building.
struct Building {
  BuildingSurfaces surfaces;
  FacadeStyle style;
  double ground_m = 0, eaves_m = 0;
};

double lowestGround(const CampusSite& site, const Eigen::AlignedBox2d& footprint) {
  double lowest = 1e9;
  for (double s : {0.0, 0.5, 1.0})
    for (double t : {0.0, 0.5, 1.0}) {
      const Vector2d place = footprint.min() + footprint.sizes().cwiseProduct(Vector2d{s, t});
      lowest = std::min(lowest, site.onGround(place).z());
    }
  return lowest;
}

void addWalls(Building& building, const Eigen::AlignedBox2d& footprint) {
  const Vector2d a = footprint.min(), b = footprint.max();
  const std::array<Vector2d, 5> corners{a, Vector2d{b.x(), a.y()}, b, Vector2d{a.x(), b.y()}, a};
  for (std::size_t side = 0; side < 4; ++side) {
    FacadePlace place;
    const Vector2d along = corners[side + 1] - corners[side];
    place.origin = {corners[side].x(), corners[side].y(), building.ground_m};
    place.along = Vector3d{along.x(), along.y(), 0}.normalized();
    place.outward = place.along.cross(Vector3d::UnitZ());
    place.length_m = along.norm();
    place.door = side == 0 || side == 2;  // the long sides face street and paths
    addFacade(building.surfaces, building.style, place);
  }
}

void addFlatRoof(Building& building, const Eigen::AlignedBox2d& footprint) {
  const double z = building.eaves_m;
  const Vector2d a = footprint.min(), b = footprint.max();
  addQuad(building.surfaces.flat_roof,
          {Vector3d{a.x(), a.y(), z}, Vector3d{b.x(), a.y(), z}, Vector3d{b.x(), b.y(), z}, Vector3d{a.x(), b.y(), z}});
}

void addGabledRoof(Building& building, const Eigen::AlignedBox2d& footprint, double pitch_rad) {
  const bool along_x = footprint.sizes().x() >= footprint.sizes().y();
  const Vector2d center = footprint.center();
  const double half_span = 0.5 * (along_x ? footprint.sizes().y() : footprint.sizes().x());
  const double half_ridge = 0.5 * (along_x ? footprint.sizes().x() : footprint.sizes().y());
  const double rise = half_span * std::tan(pitch_rad), overhang = 0.4, thick = 0.15;
  const auto at = [&](double along, double across, double z) -> Vector3d {
    return along_x ? Vector3d{center.x() + along, center.y() + across, z}
                   : Vector3d{center.x() + across, center.y() + along, z};
  };
  for (const double side : {-1.0, 1.0}) {
    const double low = building.eaves_m - overhang * std::tan(pitch_rad), out = side * (half_span + overhang);
    for (const double lift : {0.0, thick})
      addQuad(building.surfaces.gabled_roof,
              {at(-half_ridge - overhang, out, low + lift), at(half_ridge + overhang, out, low + lift),
               at(half_ridge + overhang, 0, building.eaves_m + rise + lift),
               at(-half_ridge - overhang, 0, building.eaves_m + rise + lift)});
    const double gable = side * half_ridge;
    addTriangle(building.surfaces.facade, at(gable, -half_span, building.eaves_m),
                at(gable, half_span, building.eaves_m), at(gable, 0, building.eaves_m + rise));
  }
}

void addPortico(Building& building, const CampusSite& site, const Eigen::AlignedBox2d& footprint) {
  const double front = footprint.min().y() - 2.6, middle = footprint.center().x(), top = building.ground_m + 3.4;
  for (const double x : {-4.5, -1.9, 1.9, 4.5}) {
    const Vector3d foot = site.onGround({middle + x, front});
    addTube(building.surfaces.column, {.from = foot - Vector3d{0, 0, 0.3},
                                       .to = {foot.x(), foot.y(), top},
                                       .radius_from = 0.24,
                                       .radius_to = 0.2,
                                       .sides = 14});
  }
  addBox(building.surfaces.flat_roof, standing({middle, 0.5 * (front - 0.5 + footprint.min().y()), top + 0.15}, 0),
         {10.4, footprint.min().y() - front + 0.5, 0.3});
}

FacadeStyle styleOf(const BuildingSpec& spec, CampusRandom& random) {
  FacadeStyle style;
  style.floors = spec.floors;
  style.floor_height_m = random.uniform(3.0, 3.6);
  style.bay_m = random.uniform(2.6, 3.6);
  style.window_width_m = random.uniform(1.0, 1.5);
  style.window_height_m = random.uniform(1.3, 1.8);
  style.recess_m = random.uniform(0.1, 0.22);
  style.course_depth_m = random.chance(0.7) ? random.uniform(0.08, 0.16) : 0;
  return style;
}

}  // namespace

std::int32_t makeBuilding(CampusSite& site, const BuildingSpec& spec, CampusRandom random) {
  const Vector2d middle = spec.footprint.center();
  const std::int32_t id =
      site.addObject(ObjectClass::Building, spec.gabled ? "gabled building" : "flat-roofed building",
                     site.onGround(middle), 0.5 * spec.footprint.diagonal().norm());
  Building building{.surfaces = BuildingSurfaces(id, static_cast<float>(random.uniform(0.3, 0.7))),
                    .style = styleOf(spec, random)};
  building.ground_m = lowestGround(site, spec.footprint) + 0.35;
  building.eaves_m = building.ground_m + spec.floors * building.style.floor_height_m;
  addWalls(building, spec.footprint);
  if (spec.gabled)
    addGabledRoof(building, spec.footprint, random.uniform(0.5, 0.8));
  else
    addFlatRoof(building, spec.footprint);
  if (spec.portico) addPortico(building, site, spec.footprint);
  building.surfaces.addTo(site);
  return id;
}

}  // namespace cluxel::simulation
