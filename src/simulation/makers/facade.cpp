// SPDX-License-Identifier: Apache-2.0
// Splits a wall into rectangles around its openings.
#include "simulation/makers/facade.hpp"

#include <algorithm>
#include <cmath>

namespace cluxel::simulation {

using Eigen::Vector3d;

BuildingSurfaces::BuildingSurfaces(std::int32_t instance, float wall_reflectivity)
    : facade(surfaceOf(SurfaceLabel::Facade, instance, {.reflectivity = wall_reflectivity})),
      window(surfaceOf(SurfaceLabel::Window, instance, {.reflectivity = 0.1F, .transparency = 0.6F})),
      door(surfaceOf(SurfaceLabel::Door, instance, {.reflectivity = 0.3F})),
      ledge(surfaceOf(SurfaceLabel::Ledge, instance, {.reflectivity = 0.6F})),
      flat_roof(surfaceOf(SurfaceLabel::FlatRoof, instance, {.reflectivity = 0.3F})),
      gabled_roof(surfaceOf(SurfaceLabel::GabledRoof, instance, {.reflectivity = 0.25F})),
      column(surfaceOf(SurfaceLabel::BuildingColumn, instance, {.reflectivity = 0.6F})),
      stairs(surfaceOf(SurfaceLabel::Stairs, instance, {.reflectivity = 0.4F})) {}

void BuildingSurfaces::addTo(CampusSite& site) {
  for (CampusMesh* mesh : {&facade, &window, &door, &ledge, &flat_roof, &gabled_roof, &column, &stairs})
    site.addSurface(std::move(*mesh));
}

namespace {

/// Coordinates on a facade [m]: s along the wall, t upwards from the ground floor, d outwards.
class FacadeMaker {
 public:
  FacadeMaker(BuildingSurfaces& surfaces, const FacadeStyle& style, const FacadePlace& place)
      : surfaces_(surfaces), style_(style), place_(place) {
    bays_ = std::max(1, static_cast<int>(place.length_m / style.bay_m));
    bay_m_ = place.length_m / bays_;
    opening_m_ = std::min(style.window_width_m, bay_m_ - 0.6);
  }

  void addFloor(int floor) {
    const double below = floor == 0 ? -1.5 : floor * style_.floor_height_m, level = floor * style_.floor_height_m;
    const double sill = level + style_.sill_m, head = sill + style_.window_height_m;
    const double above = level + style_.floor_height_m;
    const int door_bay = place_.door && floor == 0 ? bays_ / 2 : -1;
    wall(0, place_.length_m, head, above);
    for (int bay = 0; bay < bays_; ++bay) {
      const double s0 = bay * bay_m_, s1 = s0 + bay_m_, left = 0.5 * (s0 + s1 - opening_m_), right = left + opening_m_;
      wall(s0, left, sill, head);
      wall(right, s1, sill, head);
      const bool door = bay == door_bay;
      wall(s0, door ? left : s1, below, sill);
      if (door) wall(right, s1, below, sill);
      opening(door ? surfaces_.door : surfaces_.window, {left, right, door ? below : sill, head});
      if (door)
        steps(0.5 * (left + right));
      else
        windowSill(left, right, sill);
    }
    if (style_.course_depth_m > 0) course(above - 0.1, style_.course_depth_m, 0.2);
  }

  void addCornice() { course(style_.floors * style_.floor_height_m, std::max(0.2, style_.course_depth_m + 0.1), 0.3); }

 private:
  struct Opening {
    double left, right, bottom, top;
  };

  Vector3d at(double s, double t, double d) const {
    return place_.origin + s * place_.along + t * Vector3d::UnitZ() + d * place_.outward;
  }
  void wall(double s0, double s1, double t0, double t1) {
    addQuad(surfaces_.facade, {at(s0, t0, 0), at(s1, t0, 0), at(s1, t1, 0), at(s0, t1, 0)});
  }
  void opening(CampusMesh& pane, const Opening& o) {
    const double d = -style_.recess_m;
    addQuad(pane, {at(o.left, o.bottom, d), at(o.right, o.bottom, d), at(o.right, o.top, d), at(o.left, o.top, d)});
    const std::array<std::pair<double, double>, 5> corners{
        {{o.left, o.bottom}, {o.right, o.bottom}, {o.right, o.top}, {o.left, o.top}, {o.left, o.bottom}}};
    for (std::size_t i = 0; i < 4; ++i) {
      const auto [s0, t0] = corners[i];
      const auto [s1, t1] = corners[i + 1];
      addQuad(surfaces_.facade, {at(s0, t0, 0), at(s1, t1, 0), at(s1, t1, d), at(s0, t0, d)});
    }
  }
  /// A bar along the wall that protrudes from its face.
  void bar(CampusMesh& mesh, double s0, double s1, double middle_t, double height, double depth) {
    Eigen::Isometry3d T_map_bar = Eigen::Isometry3d::Identity();
    T_map_bar.linear().col(0) = place_.along;
    T_map_bar.linear().col(1) = -place_.outward;
    T_map_bar.linear().col(2) = Vector3d::UnitZ();
    T_map_bar.translation() = at(0.5 * (s0 + s1), middle_t, 0.5 * depth);
    addBox(mesh, T_map_bar, {s1 - s0, depth, height});
  }
  void windowSill(double left, double right, double sill) {
    bar(surfaces_.ledge, left - 0.08, right + 0.08, sill - 0.04, 0.08, 0.09);
  }
  void course(double middle_t, double depth, double height) {
    bar(surfaces_.ledge, -depth, place_.length_m + depth, middle_t, height, depth);
  }
  void steps(double middle) {
    for (int step = 0; step < 3; ++step)
      bar(surfaces_.stairs, middle - 1.1, middle + 1.1, -0.16 * step - 0.5, 1.0, 0.35 * (step + 2));
  }

  BuildingSurfaces& surfaces_;
  const FacadeStyle& style_;
  const FacadePlace& place_;
  int bays_ = 1;
  double bay_m_ = 3, opening_m_ = 1.2;
};

}  // namespace

void addFacade(BuildingSurfaces& surfaces, const FacadeStyle& style, const FacadePlace& place) {
  FacadeMaker maker(surfaces, style, place);
  for (int floor = 0; floor < style.floors; ++floor) maker.addFloor(floor);
  maker.addCornice();
}

}  // namespace cluxel::simulation
