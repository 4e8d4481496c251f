// SPDX-License-Identifier: Apache-2.0
// Trees: a slightly bent trunk, branches, and clumps of small triangles as leaves, so that scans of crowns are
// scattered.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulation/makers/makers.hpp"

namespace cluxel::simulation {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;
constexpr double kTurn = 2 * std::numbers::pi;

/// The surfaces of one tree and the axis of its trunk.
struct Tree {
  CampusMesh trunk, branches, leaves;
  Vector3d foot, lean;  ///< lean: how far the axis moves per metre of height
  double trunk_radius = 0.15;

  Vector3d axisAt(double height) const { return foot + Vector3d{0, 0, height} + height * lean; }
};

void addTrunk(Tree& tree, double height) {
  const double r = tree.trunk_radius;
  addTube(tree.trunk,
          {.from = tree.axisAt(-0.3), .to = tree.axisAt(0.25), .radius_from = 1.5 * r, .radius_to = 1.05 * r});
  addTube(tree.trunk,
          {.from = tree.axisAt(0.25), .to = tree.axisAt(height), .radius_from = 1.05 * r, .radius_to = 0.75 * r});
}

void addBranch(Tree& tree, double height, const Vector3d& tip) {
  const Vector3d root = tree.axisAt(height),
                 knee = root + 0.5 * (tip - root) - Vector3d{0, 0, 0.06 * (tip - root).norm()};
  const double r = 0.32 * tree.trunk_radius;
  addTube(tree.branches,
          {.from = root, .to = knee, .radius_from = r, .radius_to = 0.7 * r, .sides = 6, .capped = false});
  addTube(tree.branches,
          {.from = knee, .to = tip, .radius_from = 0.7 * r, .radius_to = 0.2 * r, .sides = 6, .capped = false});
}

/// Leaves around a point; their density falls with the distance.
void addClump(Tree& tree, CampusRandom& random, const Vector3d& center, double radius, int leaves) {
  for (int i = 0; i < leaves; ++i) {
    const double reach = radius * std::cbrt(random.uniform());
    const Vector3d place = center + reach * randomDirection(random);
    addLeaf(tree.leaves, random, place, random.uniform(0.08, 0.16));
  }
}

/// Round, oval and umbrella crowns: clumps of leaves in the outer part of an ellipsoid.
void addEllipsoidCrown(Tree& tree, CampusRandom& random, const TreeSpec& spec, double flatness) {
  const double half_height = 0.5 * (spec.height_m - spec.clear_trunk_m);
  const double middle = spec.clear_trunk_m + half_height;
  const Vector3d radii{spec.crown_radius_m, spec.crown_radius_m, half_height};
  const double volume = 4.19 * spec.crown_radius_m * spec.crown_radius_m * half_height;
  const int clumps = std::clamp(static_cast<int>(volume * 0.75), 24, 110);
  for (int i = 0; i < clumps; ++i) {
    Vector3d direction = randomDirection(random);
    if (flatness > 0 && direction.z() < 0) direction.z() *= 1 - flatness;
    const double depth = 0.45 + 0.42 * std::sqrt(random.uniform());
    const Vector3d center = tree.axisAt(middle) + depth * radii.cwiseProduct(direction);
    const double clump = random.uniform(0.5, 0.95) * std::min(1.0, 0.34 * spec.crown_radius_m);
    addClump(tree, random, center, clump, static_cast<int>(190 * clump));
    if (i % 4 == 0) addBranch(tree, spec.clear_trunk_m * random.uniform(0.9, 1.25), center);
  }
  addTrunk(tree, middle);
}

/// A spruce: whorls of drooping branches that are longest at the bottom.
void addConicalCrown(Tree& tree, CampusRandom& random, const TreeSpec& spec) {
  const double crown = spec.height_m - spec.clear_trunk_m;
  for (double up = 0; up < crown; up += 0.4) {
    const double reach = spec.crown_radius_m * (1 - up / crown) + 0.12;
    const int twigs = 5 + static_cast<int>(6 * reach);
    for (int i = 0; i < twigs; ++i) {
      const double around = kTurn * (i + random.uniform()) / twigs, length = reach * random.uniform(0.75, 1.05);
      const Vector3d root = tree.axisAt(spec.clear_trunk_m + up);
      const Vector3d tip = root + Vector3d{length * std::cos(around), length * std::sin(around), -0.35 * length};
      for (int leaf = 0, leaves = 6 + static_cast<int>(22 * length); leaf < leaves; ++leaf) {
        const Vector3d aside = 0.14 * randomDirection(random);
        const Vector3d place = root + std::sqrt(random.uniform()) * (tip - root) + aside;
        addLeaf(tree.leaves, random, place, random.uniform(0.07, 0.13));
      }
      if (i % 3 == 0 && length > 0.6) addBranch(tree, spec.clear_trunk_m + up, root + 0.8 * (tip - root));
    }
  }
  addTrunk(tree, 0.85 * spec.height_m);
}

const char* nameOf(TreeShape shape) {
  switch (shape) {
    case TreeShape::Round:
      return "round tree";
    case TreeShape::Conical:
      return "spruce";
    case TreeShape::Columnar:
      return "columnar tree";
    case TreeShape::Spreading:
      return "spreading tree";
  }
  return "tree";
}

void noteTouchingCrowns(CampusSite& site, std::int32_t id) {
  const auto& objects = site.campus().objects;
  const CampusObject& tree = objects[static_cast<std::size_t>(id)];
  for (std::int32_t other = 0; other < id; ++other) {
    const CampusObject& neighbour = objects[static_cast<std::size_t>(other)];
    if (neighbour.class_number != static_cast<int>(ObjectClass::Tree)) continue;
    const double distance = (neighbour.position - tree.position).head<2>().norm();
    if (distance < tree.reach_m + neighbour.reach_m) site.addTrait(id, "crown touches " + std::to_string(other));
  }
}

}  // namespace

TreeSpec usualTree(TreeShape shape, CampusRandom& random) {
  const double vigour = random.uniform();
  switch (shape) {
    case TreeShape::Conical:
      return {shape, 1.6 + 0.9 * vigour, random.uniform(0.5, 1.1), 7 + 4 * vigour};
    case TreeShape::Columnar:
      return {shape, 0.9 + 0.5 * vigour, random.uniform(1.1, 1.7), 8 + 4 * vigour};
    case TreeShape::Spreading:
      return {shape, 4 + 1.2 * vigour, random.uniform(2.6, 3.2), 7 + 2 * vigour};
    case TreeShape::Round:
      break;
  }
  return {shape, 2.3 + 1.3 * vigour, random.uniform(2.0, 2.7), 6.5 + 2.5 * vigour};
}

std::int32_t makeTree(CampusSite& site, const Vector2d& place, const TreeSpec& spec, CampusRandom random) {
  const Vector3d foot = site.onGround(place);
  const std::int32_t id = site.addObject(ObjectClass::Tree, nameOf(spec.shape), foot, spec.crown_radius_m);
  Tree tree;
  tree.trunk = surfaceOf(SurfaceLabel::TreeTrunk, id, {.reflectivity = 0.3F});
  tree.branches = surfaceOf(SurfaceLabel::TreeBranch, id, {.reflectivity = 0.3F});
  tree.leaves = surfaceOf(SurfaceLabel::TreeTop, id, {.reflectivity = 0.5F});
  tree.foot = foot;
  tree.lean = {random.uniform(-0.04, 0.04), random.uniform(-0.04, 0.04), 0};
  tree.trunk_radius = (0.016 + 0.006 * random.uniform()) * spec.height_m + 0.02;
  if (spec.shape == TreeShape::Conical)
    addConicalCrown(tree, random, spec);
  else
    addEllipsoidCrown(tree, random, spec, spec.shape == TreeShape::Spreading ? 0.75 : 0.25);
  for (CampusMesh* surface : {&tree.trunk, &tree.branches, &tree.leaves}) site.addSurface(std::move(*surface));
  noteTouchingCrowns(site, id);
  return id;
}

}  // namespace cluxel::simulation
