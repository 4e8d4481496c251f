// SPDX-License-Identifier: Apache-2.0
// Places the buildings: a main hall in the north, halls in the west and east, a row of houses south of the street.
#include <algorithm>
#include <cmath>

#include "simulation/makers/makers.hpp"

namespace cluxel::simulation {
namespace {

using Eigen::Vector2d;

class BuildingLayout {
 public:
  explicit BuildingLayout(CampusSite& site) : site_(site), random_(site.stream(RandomUse::Placement, 1)) {}

  void build(const BuildingSpec& spec) {
    site_.reserve(spec.footprint);
    const Vector2d door{spec.footprint.center().x(), spec.footprint.min().y()};
    if (spec.portico) site_.reserve({door - Vector2d{5.4, 3.3}, door + Vector2d{5.4, 0}});
    makeBuilding(site_, spec, site_.stream(RandomUse::Building, built_++));
  }

  void northHalls() {
    const SitePlan& plan = site_.plan();
    const double half_width = std::max(9.0, 0.36 * plan.half_m()), front = plan.north() + 8;
    build({.footprint = {Vector2d{-half_width, front}, Vector2d{half_width, front + 12}},
           .floors = 2 + random_.below(3),
           .gabled = false,
           .portico = true});
    for (const double side : {-1.0, 1.0}) {
      const double near = side * (half_width + random_.uniform(5, 7)), far = near + side * random_.uniform(10, 14);
      const double set_back = random_.uniform(0, 3);
      build({.footprint = {Vector2d{std::min(near, far), front + set_back},
                           Vector2d{std::max(near, far), front + set_back + 9}},
             .floors = 2,
             .gabled = true});
    }
  }

  void sideHalls() {
    const SitePlan& plan = site_.plan();
    const double low = plan.south() + 7, high = plan.north() - random_.uniform(0, 2);
    const double west = plan.west() - 9.5, east = plan.east() + 8.5;
    build({.footprint = {Vector2d{west - 10, low}, Vector2d{west, high}}, .floors = 3, .gabled = random_.chance(0.5)});
    build({.footprint = {Vector2d{east, low}, Vector2d{east + 10, high}}, .floors = 2, .gabled = random_.chance(0.5)});
  }

  void southRow() {
    const SitePlan& plan = site_.plan();
    double x = -plan.half_m() - random_.uniform(0, 4);
    while (x < plan.half_m()) {
      const double width = random_.uniform(11, 18), front = plan.streetY() - random_.uniform(10.4, 12);
      build({.footprint = {Vector2d{x, front - random_.uniform(8.5, 10.5)}, Vector2d{x + width, front}},
             .floors = 1 + random_.below(3),
             .gabled = random_.chance(0.7)});
      x += width + random_.uniform(3, 6);
    }
  }

 private:
  CampusSite& site_;
  CampusRandom random_;
  std::uint64_t built_ = 0;
};

}  // namespace

void layOutBuildings(CampusSite& site) {
  BuildingLayout layout(site);
  layout.northHalls();
  layout.sideHalls();
  layout.southRow();
}

}  // namespace cluxel::simulation
