// SPDX-License-Identifier: Apache-2.0
// Places trees, bushes and hedges: an avenue, rows along street and paths, groups on the lawns.
#include <algorithm>
#include <cmath>
#include <optional>

#include "simulation/makers/makers.hpp"

namespace cluxel::simulation {
namespace {

using Eigen::Vector2d;

class Planting {
 public:
  Planting(CampusSite& site, std::uint64_t number)
      : site_(site), random_(site.stream(RandomUse::Placement, number)), next_tree_(1000 * number) {}

  CampusRandom& random() { return random_; }

  bool tree(const Vector2d& place, const TreeSpec& spec) {
    if (!site_.claim(place, 0.45)) return false;
    makeTree(site_, place, spec, site_.stream(RandomUse::Tree, next_tree_++));
    return true;
  }

  void avenue() {
    const SitePlan& plan = site_.plan();
    for (const double side : {-1.0, 1.0})
      for (const double y : avenueRows(plan)) {
        TreeSpec spec = usualTree(TreeShape::Round, random_);
        spec.crown_radius_m = random_.uniform(3.0, 3.5);  // wider than half their distance: crowns touch
        spec.clear_trunk_m = random_.uniform(2.3, 2.8);
        tree({plan.west() + side * kAvenueAside_m + random_.uniform(-0.15, 0.15), y + random_.uniform(-0.3, 0.3)},
             spec);
      }
  }

  void eastRow() {
    const SitePlan& plan = site_.plan();
    for (double y = plan.south() + 4; y < plan.north(); y += 4.2) {
      const TreeSpec spec = usualTree(TreeShape::Columnar, random_);
      tree({plan.east() + 3.2, y + random_.uniform(-0.3, 0.3)}, spec);
    }
  }

  void gardens() {
    const SitePlan& plan = site_.plan();
    for (double x = -plan.half_m() + 2; x < plan.half_m(); x += random_.uniform(9, 14)) {
      TreeSpec spec = usualTree(TreeShape::Round, random_);
      spec.crown_radius_m = random_.uniform(1.9, 2.3);
      spec.height_m = random_.uniform(5, 6.5);
      tree({x, plan.streetY() - 8.2}, spec);
    }
  }

  Vector2d anywhere() {
    const double reach = site_.plan().half_m() + 8;
    return {random_.uniform(-reach, reach), random_.uniform(-reach, reach)};
  }

  bool hasRoom(const Vector2d& place, const TreeSpec& spec) const {
    const bool low = spec.clear_trunk_m < 1.8;  // leaves in the way of people
    return site_.plan().onLawn(place, low ? spec.crown_radius_m + 0.3 : 0.8) &&
           site_.distanceToBuildings(place) > spec.crown_radius_m + 0.3;
  }

  /// A tree on free lawn; every third one gets a neighbour with a touching crown.
  void lawnTree(int number) {
    TreeSpec spec = usualTree(static_cast<TreeShape>(number % 4), random_);
    for (int attempt = 0; attempt < 60; ++attempt) {
      const Vector2d place = number % 2 == 0 && attempt < 30 ? onQuad() : anywhere();
      if (!hasRoom(place, spec) || site_.touchesCrown(place, spec.crown_radius_m) || !tree(place, spec)) continue;
      if (number % 3 == 0) companion(place, spec);
      return;
    }
  }

  void bush(bool at_wall) {
    const double radius = random_.uniform(0.45, 1.05);
    for (int attempt = 0; attempt < 80; ++attempt) {
      const Vector2d place = at_wall ? anywhere() : onQuad();
      if (at_wall && site_.distanceToBuildings(place) > radius + 1.2) continue;
      if (!site_.plan().onLawn(place, radius) || !site_.claim(place, radius + 0.15)) continue;
      makeBush(site_, place, radius, site_.stream(RandomUse::Shrub, next_shrub_++));
      return;
    }
  }

  void hedge(const Vector2d& from, const Vector2d& to) {
    if (!site_.claimStrip(from, to, 0.5)) return;
    makeHedge(site_, from, to, site_.stream(RandomUse::Shrub, next_shrub_++));
  }

 private:
  Vector2d onQuad() {
    const SitePlan& plan = site_.plan();
    return {random_.uniform(plan.west(), plan.east()), random_.uniform(plan.south(), plan.north())};
  }
  void companion(const Vector2d& place, const TreeSpec& first) {
    for (int attempt = 0; attempt < 30; ++attempt) {
      const TreeSpec spec = usualTree(static_cast<TreeShape>(random_.below(4)), random_);
      const double angle = random_.uniform(0, 6.283), distance = 0.85 * (first.crown_radius_m + spec.crown_radius_m);
      const Vector2d beside = place + distance * Vector2d{std::cos(angle), std::sin(angle)};
      if (hasRoom(beside, spec) && tree(beside, spec)) return;
    }
  }

  CampusSite& site_;
  CampusRandom random_;
  std::uint64_t next_tree_, next_shrub_ = 0;
};

}  // namespace

std::vector<double> avenueRows(const SitePlan& plan) {
  std::vector<double> rows;
  for (double y = plan.south() + 5; y < plan.north() - 2.5; y += 6) rows.push_back(y);
  return rows;
}

void plantAvenues(CampusSite& site) {
  Planting planting(site, 2);
  planting.avenue();
  planting.eastRow();
  planting.gardens();
}

void plantLawns(CampusSite& site) {
  Planting planting(site, 3);
  const SitePlan& plan = site.plan();
  const double area = 4 * plan.half_m() * plan.half_m();
  for (const double side : {-1.0, 1.0})
    for (double x = 3; x + 5 < std::abs(plan.west()); x += planting.random().uniform(9, 12))
      planting.hedge({side * x, plan.north() + 3.6},
                     {side * (x + planting.random().uniform(3.5, 6)), plan.north() + 3.6});
  for (int i = 0; i < static_cast<int>(area / 330); ++i) planting.lawnTree(i);
  for (int i = 0; i < static_cast<int>(area / 220); ++i) planting.bush(i % 2 == 0);
}

}  // namespace cluxel::simulation
