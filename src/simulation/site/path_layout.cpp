// SPDX-License-Identifier: Apache-2.0
// Places post lamps, benches, bins and signs along the paths; some lamps stand between the trees of the avenue.
#include <cmath>
#include <numbers>

#include "simulation/makers/makers.hpp"

namespace cluxel::simulation {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;

class PathLayout {
 public:
  explicit PathLayout(CampusSite& site)
      : site_(site), plan_(site.plan()), random_(site.stream(RandomUse::Placement, 5)) {}

  void lamps() {
    const auto rows = avenueRows(plan_);
    for (std::size_t i = 0; i + 1 < rows.size(); i += 2)  // under the crowns
      lamp({plan_.west() + (i % 4 == 0 ? 1 : -1) * (kAvenueAside_m - 0.5), 0.5 * (rows[i] + rows[i + 1])});
    for (double y = plan_.south() + 6; y < plan_.north() - 3; y += 13) lamp({plan_.east() - 2.3, y});
    for (double x = plan_.west() + 7; x < plan_.east() - 4; x += 15) lamp({x, plan_.north() - 2.3});
  }

  void benches() {
    for (double x = plan_.west() + 4; x < plan_.east() - 3; x += random_.uniform(8, 13)) {
      bench({x, plan_.north() + 2.2}, -pi / 2);
      bench({x + 2, plan_.windingY(x + 2) + 2.0}, -pi / 2);
    }
  }

  void signs() {
    const auto rows = avenueRows(plan_);
    for (std::size_t i = 0; i < rows.size(); i += 2)  // under the crowns, one in two overgrown
      sign({plan_.west() + 2.1, rows[i] + 1.1},
           {.yaw_rad = -pi / 2, .plates = 1 + static_cast<int>(i / 2 % 2), .leaves = i % 4 == 0});
    for (const double x : {plan_.west() + 2.4, plan_.east() - 2.4})
      sign({x, plan_.north() - 3.4}, {.yaw_rad = random_.uniform(-pi, pi), .plates = 2});
    sign({plan_.east() - 2.3, plan_.south() + 3.5}, {.yaw_rad = -pi / 2});
  }

  void bollards() {
    for (const double x : {-1.8, 1.8})
      for (double y = plan_.north() + 2.2; y < plan_.north() + 4.5; y += 1.4)
        if (site_.claim({x, y}, 0.15)) makeBollard(site_, {x, y}, small());
  }

  void people() {
    for (double x = plan_.west() + 9; x < plan_.east() - 4; x += random_.uniform(12, 20))
      if (const Vector2d place{x, plan_.windingY(x)}; site_.claim(place, 0.45)) makePerson(site_, place, small());
  }

 private:
  CampusRandom furniture() { return site_.stream(RandomUse::Furniture, 5000 + next_++); }
  CampusRandom small() { return site_.stream(RandomUse::SmallObject, 5000 + next_++); }
  void lamp(const Vector2d& place) {
    if (site_.claim(place, 0.2)) makeStraightLamp(site_, place, furniture());
  }
  void sign(const Vector2d& place, const SignSpec& spec) {
    if (site_.claim(place, 0.25)) makeSign(site_, place, spec, furniture());
  }
  void bench(const Vector2d& place, double yaw_rad) {
    if (!site_.claim(place, 1.0)) return;
    makeBench(site_, place, yaw_rad, small());
    const Vector2d beside = place + Vector2d{1.5, 0};
    if (random_.chance(0.5) && site_.claim(beside, 0.35)) makeBin(site_, beside, small());
  }

  CampusSite& site_;
  const SitePlan& plan_;
  CampusRandom random_;
  std::uint64_t next_ = 0;
};

}  // namespace

void furnishPaths(CampusSite& site) {
  PathLayout layout(site);
  layout.lamps();
  layout.signs();
  layout.benches();
  layout.bollards();
  layout.people();
}

}  // namespace cluxel::simulation
