// SPDX-License-Identifier: Apache-2.0
// The formulas of the site plan.
#include "simulation/site/site_plan.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cluxel::simulation {

using Eigen::Vector2d;

SitePlan::SitePlan(double size_m)
    : half_(size_m / 2),
      street_y_(-0.22 * size_m),
      west_(-0.32 * size_m),
      east_(0.32 * size_m),
      south_(street_y_ + 5.8),
      north_(0.2 * size_m),
      crossings_{west_, east_} {}

double SitePlan::windingY(double x) const {
  const double middle = 0.5 * (south_ + north_), swing = 0.18 * (north_ - south_);
  return middle + swing * std::sin(2 * std::numbers::pi * x / (east_ - west_));
}

SurfaceLabel SitePlan::kindAt(double x, double y) const {
  const double across = std::abs(y - street_y_);
  if (across < kStreetHalf_m) {
    const bool crossing = std::any_of(crossings_.begin(), crossings_.end(),
                                      [x](double middle) { return std::abs(x - middle) < kCrossingHalf_m; });
    const bool stripe = static_cast<long>(std::floor((y - street_y_ + kStreetHalf_m) / 0.5)) % 2 == 0;
    return crossing && stripe ? SurfaceLabel::Crossing : SurfaceLabel::Street;
  }
  if (across < kStreetHalf_m + kKerbWidth_m) return SurfaceLabel::Kerb;
  if (across < kWalkOuter_m) return SurfaceLabel::Sidewalk;
  const bool within_y = y > south_ && y < north_ + kPathHalf_m;
  const bool upwards = within_y && (std::abs(x - west_) < kPathHalf_m || std::abs(x - east_) < kPathHalf_m);
  const bool sideways = std::abs(y - north_) < kPathHalf_m && x > west_ && x < east_;
  const bool to_door = std::abs(x) < kPathHalf_m && y > north_ && y < north_ + 8;
  const bool winding = x > west_ && x < east_ && std::abs(y - windingY(x)) < 0.8 * kPathHalf_m;
  return upwards || sideways || to_door || winding ? SurfaceLabel::Path : SurfaceLabel::Lawn;
}

double SitePlan::offsetAt(double x, double y) const {
  const double across = std::abs(y - street_y_);
  constexpr double kEdge_m = kStreetHalf_m - 0.005;  // between the two grid lines of the kerb's face
  if (across >= kEdge_m) return kindAt(x, y) == SurfaceLabel::Path ? -0.03 : 0;
  double sunk = kKerbHeight_m;  // the street rises to the walks at crossings
  for (const double middle : crossings_) {
    const double ramp = std::clamp((std::abs(x - middle) - kCrossingHalf_m) / 1.5, 0.0, 1.0);
    sunk = std::min(sunk, 0.03 + (kKerbHeight_m - 0.03) * ramp);
  }
  return -sunk;
}

bool SitePlan::onLawn(const Vector2d& center, double radius) const {
  for (int i = 0; i < 16; ++i) {
    const double angle = std::numbers::pi * i / 8;
    const Vector2d edge = center + radius * Vector2d{std::cos(angle), std::sin(angle)};
    if (kindAt(edge.x(), edge.y()) != SurfaceLabel::Lawn) return false;
  }
  return kindAt(center.x(), center.y()) == SurfaceLabel::Lawn;
}

SitePlan::RoutePoint SitePlan::routeAt(double distance_m) const {
  using std::numbers::pi;
  const std::array<Vector2d, 6> corners{Vector2d{0, south_},     Vector2d{west_, south_}, Vector2d{west_, north_},
                                        Vector2d{east_, north_}, Vector2d{east_, south_}, Vector2d{0, south_}};
  constexpr std::array kHeadings{pi, pi / 2, 0.0, -pi / 2, pi};
  double left = std::fmod(distance_m, routeLength_m());
  for (std::size_t leg = 0; leg < kHeadings.size(); ++leg) {
    const double length = (corners[leg + 1] - corners[leg]).norm();
    if (left <= length) return {corners[leg] + (corners[leg + 1] - corners[leg]) * (left / length), kHeadings[leg]};
    left -= length;
  }
  return {corners.back(), kHeadings.back()};
}

double SitePlan::distanceToRoute(const Vector2d& point) const {
  const double x = std::clamp(point.x(), west_, east_), y = std::clamp(point.y(), south_, north_);
  const double inside = std::min({x - west_, east_ - x, y - south_, north_ - y});
  const double outside = (point - Vector2d{x, y}).norm();
  return outside > 0 ? outside : inside;
}

namespace {

std::vector<double> gridOver(double reach, std::vector<double> lines) {
  for (double line = -reach; line <= reach + 1e-9; line += 0.5) lines.push_back(line);
  std::sort(lines.begin(), lines.end());
  constexpr double kSame_m = 0.004;
  lines.erase(std::unique(lines.begin(), lines.end(), [](double a, double b) { return b - a < kSame_m; }), lines.end());
  return lines;
}

}  // namespace

std::vector<double> SitePlan::gridX() const {
  std::vector<double> lines;
  for (const double middle : {west_, east_, 0.0})
    for (const double edge : {kPathHalf_m, kCrossingHalf_m, kCrossingHalf_m + 1.5})
      for (const double sign : {-1.0, 1.0}) lines.push_back(middle + sign * edge);
  return gridOver(half_ + kMargin_m, lines);
}

std::vector<double> SitePlan::gridY() const {
  std::vector<double> lines{north_ - kPathHalf_m, north_ + kPathHalf_m};
  for (const double side : {-1.0, 1.0}) {
    for (const double across : {kStreetHalf_m - 0.01, kStreetHalf_m, kStreetHalf_m + kKerbWidth_m, kWalkOuter_m})
      lines.push_back(street_y_ + side * across);
    for (int stripe = 0; stripe < 8; ++stripe) lines.push_back(street_y_ + side * 0.5 * stripe);
  }
  return gridOver(half_ + kMargin_m, lines);
}

}  // namespace cluxel::simulation
