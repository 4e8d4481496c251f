// SPDX-License-Identifier: Apache-2.0
// The formulas of relationInfos().
#include "perception/segments/scene_relations.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/steady_angle.hpp"

namespace cluxel::perception {

namespace {

/// The share of a's axis-parallel box inside b's; flat boxes are padded to 1 cm.
double insideShare(const Primitive& a, const Primitive& b) {
  double share = 1;
  for (int axis = 0; axis < 3; ++axis) {
    constexpr double kThin_m = 0.01;
    const double low = a.min[axis] - kThin_m / 2, high = a.max[axis] + kThin_m / 2;
    const double overlap = std::min(high, b.max[axis] + kThin_m / 2) - std::max(low, b.min[axis] - kThin_m / 2);
    share *= std::max(0.0, overlap) / (high - low);
  }
  return share;
}

double angleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return steadyAcos(a.dot(b));
}

/// The angle between the directions of two walls or two poles [rad]; pi/2 for other pairs.
double directionAngle(const Primitive& a, const Primitive& b) {
  if (a.label != b.label) return std::numbers::pi / 2;
  if (a.label == scan::PrimitiveLabel::VerticalPlane) return angleBetween(a.normal, b.normal);
  if (a.label == scan::PrimitiveLabel::Column) return angleBetween(a.axis, b.axis);
  return std::numbers::pi / 2;
}

/// Whether at least half of the shorter box overlaps the longer one along the longer one's length axis.
bool isAlongside(const Primitive& a, const Primitive& b) {
  constexpr double kShortest_m = 2.0;
  const UprightBox& longer = a.box.size.x() >= b.box.size.x() ? a.box : b.box;
  const UprightBox& shorter = a.box.size.x() >= b.box.size.x() ? b.box : a.box;
  if (shorter.size.x() < kShortest_m) return false;
  const double turn = shorter.yaw_rad - longer.yaw_rad;
  const double half =
      0.5 * (std::abs(steady(std::cos(turn))) * shorter.size.x() + std::abs(steady(std::sin(turn))) * shorter.size.y());
  const Eigen::Vector2d along(steady(std::cos(longer.yaw_rad)), steady(std::sin(longer.yaw_rad)));
  const double middle = (shorter.center - longer.center).head<2>().dot(along);
  const double low = std::max(middle - half, -longer.size.x() / 2), high = std::min(middle + half, longer.size.x() / 2);
  return high - low >= half;
}

void appendPair(const PrimitiveContact& contact, const RelationParams& params, Scene& scene) {
  const Primitive& a = scene.primitives[contact.from];
  const Primitive& b = scene.primitives[contact.to];
  const auto add = [&](RelationKind kind, double measure) {
    scene.relations.push_back({kind, contact.from, contact.to, measure});
  };
  const bool is_near = contact.gap <= params.near_m;
  if (contact.edges > 0) add(RelationKind::Intersects, contact.gap);
  if (contact.gap <= params.touches_m) add(RelationKind::Touches, contact.gap);
  if (is_near) add(RelationKind::Near, contact.gap);
  if (const double share = insideShare(a, b); share >= params.inside_share) add(RelationKind::Inside, share);
  if (const double angle = directionAngle(a, b); is_near && angle <= params.parallel_rad)
    add(RelationKind::ParallelTo, angle);
  if (is_near && isAlongside(a, b)) add(RelationKind::Alongside, contact.gap);
  if (contact.overlaps == 0) return;
  const double rise = contact.height_difference / static_cast<double>(contact.overlaps);
  const bool touches = contact.gap <= params.stands_on_m;
  if (rise > params.above_m) {
    add(RelationKind::Above, rise);
    if (touches && a.min.z() > b.centroid.z()) add(RelationKind::StandsOn, contact.gap);
  } else if (rise < -params.above_m) {
    add(RelationKind::Below, -rise);
    if (touches && b.min.z() > a.centroid.z()) add(RelationKind::Supports, contact.gap);
  }
}

}  // namespace

void appendRelations(const std::vector<PrimitiveContact>& contacts, const RelationParams& params, Scene& scene) {
  for (const PrimitiveContact& contact : contacts) appendPair(contact, params, scene);
  for (PrimitiveIndex i = 0; i < scene.primitives.size(); ++i) {
    const double bottom = scene.primitives[i][Attribute::Bottom];
    if (bottom <= params.ground_m) scene.relations.push_back({RelationKind::TouchesGround, i, i, bottom});
  }
}

}  // namespace cluxel::perception
