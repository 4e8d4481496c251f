// SPDX-License-Identifier: Apache-2.0
// Places fences, hedges, thickets, bicycles and motorcycles at the borders of gardens and lawns. This layout comes last
// and uses the ground that is left.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulation/makers/makers.hpp"

namespace cluxel::simulation {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;

class BorderLayout {
 public:
  explicit BorderLayout(CampusSite& site)
      : site_(site), plan_(site.plan()), random_(site.stream(RandomUse::Placement, 6)) {}

  /// Consecutive fences of different kinds along a line parallel to the street.
  void alongStreet(double across, double thicket_share) {
    const double y = plan_.streetY() + across;
    for (double x = -plan_.half_m() - 4; x < plan_.half_m() + 4;) {
      const double end = x + random_.uniform(4, 13);
      if (random_.chance(0.8)) border({x, y}, {end, y}, thicket_share);
      x = end + random_.uniform(0.5, 3);
    }
  }

  void acrossLawns() {
    const double area = (plan_.east() - plan_.west()) * (plan_.north() - plan_.south());
    for (int i = 0; i < 2 + static_cast<int>(area / 200); ++i)
      for (int attempt = 0; attempt < 25; ++attempt) {
        const Vector2d from{random_.uniform(plan_.west(), plan_.east()), random_.uniform(plan_.south(), plan_.north())};
        const double heading = random_.below(4) * pi / 4, length = random_.uniform(4, 9);
        if (border(from, from + length * Vector2d{std::cos(heading), std::sin(heading)}, 0.4)) break;
      }
  }

  /// Fences between the gardens of neighbouring houses.
  void betweenGardens() {
    for (double x = -plan_.half_m(); x < plan_.half_m(); x += random_.uniform(7, 13))
      border({x, plan_.streetY() - 8}, {x, plan_.streetY() - 8 - random_.uniform(2, 6)}, 0.2);
  }

  void bicycles() {
    for (double x = -plan_.half_m() + 3; x < plan_.half_m(); x += random_.uniform(8, 17)) {
      const Vector2d place{x, plan_.streetY() - random_.uniform(4.8, 6.0)};
      if (random_.chance(0.5)) {
        const double slant = random_.uniform(-0.2, 0.2), heading = random_.chance(0.5) ? pi : 0;
        cycle(place, slant + heading, 0.5, CycleKind::Bicycle);
      } else {
        rack(place);
      }
    }
    rack({random_.uniform(3.5, 5), plan_.north() + 2.4});
    rack({plan_.west() + 3.5, plan_.south() + 3.2});
  }

  void motorcycles() {
    for (double x = -plan_.half_m() + 2; x < plan_.half_m(); x += random_.uniform(11, 19)) {
      const double side = random_.chance(0.5) ? 1 : -1;
      const Vector2d place{x, plan_.streetY() + side * random_.uniform(2.9, 3.3)};
      if (farFromCars(place))
        cycle(place, random_.uniform(-0.4, 0.4) + (side > 0 ? 0.5 : -0.5) * pi, 0.7, CycleKind::Motorcycle);
    }
  }

 private:
  CampusRandom stream() { return site_.stream(RandomUse::SmallObject, 9000 + next_++); }

  bool isLawn(const Vector2d& from, const Vector2d& to, double half_width) const {
    const int pieces = 1 + static_cast<int>((to - from).norm() / 0.5);
    for (int piece = 0; piece <= pieces; ++piece)
      if (!plan_.onLawn(from + (to - from) * piece / pieces, half_width)) return false;
    return true;
  }
  bool take(const Vector2d& from, const Vector2d& to, double half_width) {
    return isLawn(from, to, half_width) && site_.claimStrip(from, to, half_width);
  }

  /// A thicket or a fence; it is split in halves when the ground is occupied.
  bool border(const Vector2d& from, const Vector2d& to, double thicket_share) {
    constexpr double kShortest_m = 2;
    if (random_.chance(thicket_share) ? thicket(from, to) : fence(from, to)) return true;
    const Vector2d middle = 0.5 * (from + to);
    if ((to - middle).norm() < kShortest_m) return false;
    const bool first = border(from, middle, thicket_share), second = border(middle, to, thicket_share);
    return first || second;
  }
  bool thicket(const Vector2d& from, const Vector2d& to) {
    const ThicketSpec spec{.height_m = random_.uniform(0.9, 3.2), .half_depth_m = random_.uniform(0.45, 0.9)};
    if (!take(from, to, spec.half_depth_m)) return false;
    makeThicket(site_, from, to, spec, stream());
    return true;
  }
  /// A fence, with or without a hedge behind it.
  bool fence(const Vector2d& from, const Vector2d& to) {
    constexpr double kFenceHalf_m = 0.25, kHedge_m = 0.65;
    if (!take(from, to, kFenceHalf_m)) return false;
    makeFence(site_, from, to, static_cast<FenceKind>(random_.below(5)), stream());
    const Vector2d along = (to - from).normalized(), behind = kHedge_m * Vector2d{along.y(), -along.x()};
    if (random_.chance(0.35) && take(from + behind, to + behind, 0.35))
      makeHedge(site_, from + behind, to + behind, stream());
    return true;
  }

  void cycle(const Vector2d& place, double yaw_rad, double radius, CycleKind kind) {
    if (site_.claim(place, radius)) makeCycle(site_, place, yaw_rad, kind, stream());
  }
  /// Cycles parked side by side with the same heading.
  void rack(const Vector2d& place) {
    const int count = 3 + random_.below(4);
    if (!site_.claimStrip(place, place + Vector2d{0.55 * (count - 1), 0}, 0.75)) return;
    for (int i = 0; i < count; ++i) {
      const double slant = random_.uniform(-0.06, 0.06), aside = random_.uniform(-0.08, 0.08);
      makeCycle(site_, place + Vector2d{0.55 * i, aside}, 0.5 * pi + slant, CycleKind::Bicycle, stream());
    }
  }
  bool farFromCars(const Vector2d& place) const {
    return std::none_of(site_.campus().objects.begin(), site_.campus().objects.end(), [&](const CampusObject& object) {
      return object.class_number == static_cast<int>(ObjectClass::Vehicle) &&
             (object.position.head<2>() - place).norm() < 3.4;
    });
  }

  CampusSite& site_;
  const SitePlan& plan_;
  CampusRandom random_;
  std::uint64_t next_ = 0;
};

}  // namespace

void layOutBorders(CampusSite& site) {
  BorderLayout layout(site);
  layout.bicycles();
  layout.motorcycles();
  layout.alongStreet(7.7, 0.5);
  layout.alongStreet(10, 0.8);
  layout.alongStreet(-9.2, 0.7);
  layout.alongStreet(-7.1, 0.3);
  layout.betweenGardens();
  layout.acrossLawns();
}

}  // namespace cluxel::simulation
