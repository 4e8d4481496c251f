// SPDX-License-Identifier: Apache-2.0
// Places utility lines, lamps, signs, parked cars, garden fences, hedges, hydrants and people along the street.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulation/makers/makers.hpp"

namespace cluxel::simulation {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;

constexpr double kKerbLine_m = 4.55;  ///< from the middle of the street: poles stand here, beside the kerb
constexpr double kWalkBack_m = 6.25;  ///< the far edge of the walk

class StreetLayout {
 public:
  explicit StreetLayout(CampusSite& site)
      : site_(site), plan_(site.plan()), random_(site.stream(RandomUse::Placement, 4)) {}

  void utilityLine() {
    std::vector<Vector2d> places;
    for (double x = -plan_.half_m() - 2; x < plan_.half_m() + 3; x += random_.uniform(21, 25)) {
      const Vector2d place = at(x, kKerbLine_m);
      if (site_.claim(place, 0.2)) places.push_back(place);
    }
    makeUtilityLine(site_, places, furniture());
  }

  void crossings() {
    for (const double middle : plan_.crossingsX())
      for (const double side : {-1.0, 1.0})
        sign(at(middle + 2.7 * side, kKerbLine_m * side),
             {.yaw_rad = side < 0 ? pi : 0, .plates = 1 + random_.below(2)});
  }

  void lamps() {
    for (double x = -plan_.half_m() + 6; x < plan_.half_m(); x += 19)
      for (const double side : {-1.0, 1.0}) {
        const Vector2d place = at(x + (side < 0 ? 9.0 : 0.0) + random_.uniform(-1, 1), side * kKerbLine_m);
        if (site_.claim(place, 0.2)) makeArmLamp(site_, place, -side * pi / 2, furniture());
      }
  }

  void signs() {
    for (const CampusObject& object : std::vector(site_.campus().objects)) {
      const bool garden_tree = object.class_number == static_cast<int>(ObjectClass::Tree) &&
                               std::abs(object.position.y() - (plan_.streetY() - 8.2)) < 0.5;
      if (!garden_tree || !random_.chance(0.6)) continue;
      const SignSpec spec{
          .yaw_rad = random_.chance(0.5) ? 0 : pi, .plates = 1 + random_.below(2), .leaves = random_.chance(0.4)};
      sign(at(object.position.x() + random_.uniform(-0.8, 0.8), -kWalkBack_m), spec);  // under its crown
    }
    for (double x = -plan_.half_m() + 11; x < plan_.half_m(); x += random_.uniform(14, 22)) {
      const SignSpec spec{.yaw_rad = random_.chance(0.5) ? 0.1 : pi - 0.1};
      sign(at(x, (random_.chance(0.5) ? 1 : -1) * kKerbLine_m), spec);
    }
  }

  void cars() {
    std::uint64_t number = 0;
    for (const double side : {-1.0, 1.0})
      for (double x = -plan_.half_m() - 5; x < plan_.half_m() + 5; x += 6.2, ++number) {
        const bool near_crossing = std::any_of(plan_.crossingsX().begin(), plan_.crossingsX().end(),
                                               [x](double middle) { return std::abs(x - middle) < 6; });
        if (near_crossing || !random_.chance(0.55)) continue;
        const double yaw = (side > 0 ? pi : 0) + random_.uniform(-0.03, 0.03);
        makeCar(site_, at(x + random_.uniform(-0.5, 0.5), side * 2.8), yaw, site_.stream(RandomUse::Car, number));
      }
  }

  void gardenBorders() {
    double x = -plan_.half_m();
    for (int piece = random_.below(3); x < plan_.half_m(); ++piece) {
      const double end = x + random_.uniform(5, 9);
      const Vector2d from = at(x, -7.1), to = at(end, -7.1);
      if (piece % 3 == 0 && site_.claimStrip(from, to, 0.3)) makeFence(site_, from, to, FenceKind::Pickets, small());
      if (piece % 3 == 1 && site_.claimStrip(from, to, 0.35))
        makeHedge(site_, from, to, site_.stream(RandomUse::Shrub, 500 + next_++));
      x = end + random_.uniform(0.8, 1.6);
    }
  }

  void smallObjects() {
    for (double x = -plan_.half_m() + 8; x < plan_.half_m(); x += random_.uniform(28, 40))
      if (const Vector2d place = at(x, -4.7); site_.claim(place, 0.3)) makeHydrant(site_, place, small());
    for (double x = -plan_.half_m() + 5; x < plan_.half_m(); x += random_.uniform(14, 26))
      if (const Vector2d place = at(x, -random_.uniform(5, 5.8)); site_.claim(place, 0.45))
        makePerson(site_, place, small());
    for (double x = -plan_.half_m() + 14; x < plan_.half_m(); x += random_.uniform(18, 30))
      if (const Vector2d place = at(x, -kWalkBack_m); site_.claim(place, 0.4)) makeBin(site_, place, small());
    for (const double middle : plan_.crossingsX())
      for (const double aside : {-1.95, 1.95})
        if (const Vector2d place{middle + aside, plan_.streetY() + 7.3}; site_.claim(place, 0.15))
          makeBollard(site_, place, small());
  }

 private:
  Vector2d at(double x, double across) const { return {x, plan_.streetY() + across}; }
  CampusRandom furniture() { return site_.stream(RandomUse::Furniture, next_++); }
  CampusRandom small() { return site_.stream(RandomUse::SmallObject, next_++); }
  void sign(const Vector2d& place, const SignSpec& spec) {
    if (site_.claim(place, 0.25)) makeSign(site_, place, spec, furniture());
  }

  CampusSite& site_;
  const SitePlan& plan_;
  CampusRandom random_;
  std::uint64_t next_ = 0;
};

}  // namespace

void furnishStreet(CampusSite& site) {
  StreetLayout layout(site);
  layout.crossings();
  layout.utilityLine();
  layout.lamps();
  layout.signs();
  layout.cars();
  layout.gardenBorders();
  layout.smallObjects();
}

}  // namespace cluxel::simulation
