// SPDX-License-Identifier: Apache-2.0
// Picket, bar, wire mesh and board fences, and low garden walls.
#include <algorithm>
#include <cmath>

#include "simulation/makers/makers.hpp"

namespace cluxel::simulation {

using Eigen::Isometry3d, Eigen::Vector2d, Eigen::Vector3d;

namespace {

/// A line on the ground along which a fence is built.
class FenceLine {
 public:
  FenceLine(const CampusSite& site, const Vector2d& from, const Vector2d& to)
      : site_(site),
        from_(from),
        to_(to),
        length_((to - from).norm()),
        yaw_rad_(std::atan2(to.y() - from.y(), to.x() - from.x())) {}

  double length() const { return length_; }
  Vector3d foot(double s) const { return site_.onGround(from_ + (to_ - from_) * (std::min(s, length_) / length_)); }
  /// The upright pose at `s` with x along the line.
  Isometry3d at(double s) const { return standing(foot(s), yaw_rad_); }

  /// Adds a rail between two places at a height above the ground.
  void rail(CampusMesh& mesh, double s, double next, double up, double radius) const {
    const Vector3d above{0, 0, up};
    addTube(
        mesh,
        {.from = foot(s) + above, .to = foot(next) + above, .radius_from = radius, .radius_to = radius, .sides = 4});
  }
  /// Adds a post every `distance` and calls `between` for each pair of consecutive posts.
  template <typename Between>
  void posts(CampusMesh& mesh, double distance, const Vector3d& size, double aside, const Between& between) const {
    for (double s = 0; s <= length_; s += distance) {
      addBox(mesh, movedBy(at(s), {0, aside, 0.5 * size.z() - 0.1}), size);
      if (s < length_) between(s, std::min(s + distance, length_));
    }
  }

 private:
  const CampusSite& site_;
  Vector2d from_, to_;
  double length_, yaw_rad_;
};

void addPickets(CampusMesh& fence, const FenceLine& line, CampusRandom& random) {
  const double height = random.uniform(1.0, 1.5);
  constexpr double kSlat_m = 0.1, kPitch_m = 0.15, kPost_m = 2.0;
  for (double s = kPitch_m / 2; s < line.length(); s += kPitch_m)
    addBox(fence, movedBy(line.at(s), {0, 0, 0.5 * height + 0.05}), {kSlat_m, 0.02, height - 0.1});
  line.posts(fence, kPost_m, {0.09, 0.09, height + 0.2}, -0.06, [&](double s, double next) {
    for (const double up : {0.25, height - 0.2}) line.rail(fence, s, next, up, 0.03);
  });
}

void addBars(CampusMesh& fence, const FenceLine& line, CampusRandom& random) {
  const double height = random.uniform(0.9, 1.8), pitch = random.uniform(0.10, 0.14);
  for (double s = pitch; s < line.length(); s += pitch)
    addTube(fence, {.from = line.foot(s) + Vector3d{0, 0, 0.08},
                    .to = line.foot(s) + Vector3d{0, 0, height},
                    .radius_from = 0.011,
                    .radius_to = 0.011,
                    .sides = 4,
                    .capped = false});
  line.posts(fence, 2.5, {0.06, 0.06, height + 0.2}, 0, [&](double s, double next) {
    for (const double up : {0.12, height - 0.05}) line.rail(fence, s, next, up, 0.02);
  });
}

/// Flat strips model the wires at the width that a laser beam sees.
void addWireMesh(CampusMesh& fence, const FenceLine& line, CampusRandom& random) {
  const double height = random.uniform(1.0, 1.8);
  constexpr double kPitch_m = 0.06, kWire_m = 0.01;
  for (double s = kPitch_m; s < line.length(); s += kPitch_m)
    addBox(fence, movedBy(line.at(s), {0, 0, 0.5 * height}), {kWire_m, 0.004, height});
  line.posts(fence, 2.5, {0.05, 0.05, height + 0.25}, 0.03, [&](double s, double next) {
    for (double up = kPitch_m; up < height; up += 2 * kPitch_m) line.rail(fence, s, next, up, 0.5 * kWire_m);
  });
}

void addBoards(CampusMesh& fence, const FenceLine& line, CampusRandom& random) {
  const double height = random.uniform(0.9, 1.8), board = random.uniform(0.12, 0.2);
  const double gap = random.chance(0.5) ? 0.01 : 0.07;
  line.posts(fence, 2.2, {0.1, 0.1, height + 0.15}, -0.06, [&](double s, double next) {
    const double middle = 0.5 * (s + next);
    for (double up = 0.08 + board / 2; up < height; up += board + gap)
      addBox(fence, movedBy(line.at(middle), {0, 0, up}), {next - s + 0.02, 0.025, board});
  });
}

/// Built in segments of one metre, so that it follows the ground.
void addLowWall(CampusMesh& wall, const FenceLine& line, CampusRandom& random) {
  const double height = random.uniform(0.6, 1.3), thick = random.uniform(0.18, 0.35);
  const bool coped = random.chance(0.5);
  const int pieces = std::max(1, static_cast<int>(line.length()));
  const double piece = line.length() / pieces;
  for (int i = 0; i < pieces; ++i) {
    const Isometry3d T = line.at((i + 0.5) * piece);
    addBox(wall, movedBy(T, {0, 0, 0.5 * height - 0.1}), {piece + 0.01, thick, height + 0.2});
    if (coped) addBox(wall, movedBy(T, {0, 0, height + 0.03}), {piece + 0.01, thick + 0.1, 0.06});
  }
}

const char* nameOf(FenceKind kind) {
  switch (kind) {
    case FenceKind::Pickets:
      return "pickets";
    case FenceKind::Bars:
      return "bars";
    case FenceKind::WireMesh:
      return "wire mesh";
    case FenceKind::Boards:
      return "boards";
    case FenceKind::LowWall:
      return "low wall";
  }
  return "";
}

}  // namespace

std::int32_t makeFence(CampusSite& site, const Vector2d& from, const Vector2d& to, FenceKind kind,
                       CampusRandom random) {
  const FenceLine line(site, from, to);
  const std::int32_t id =
      site.addObject(ObjectClass::SmallObject, "fence", site.onGround(0.5 * (from + to)), line.length() / 2);
  site.addTrait(id, nameOf(kind));
  CampusMesh fence = surfaceOf(SurfaceLabel::Fence, id, {.reflectivity = 0.5F});
  switch (kind) {
    case FenceKind::Pickets:
      addPickets(fence, line, random);
      break;
    case FenceKind::Bars:
      addBars(fence, line, random);
      break;
    case FenceKind::WireMesh:
      addWireMesh(fence, line, random);
      break;
    case FenceKind::Boards:
      addBoards(fence, line, random);
      break;
    case FenceKind::LowWall:
      addLowWall(fence, line, random);
      break;
  }
  site.addSurface(std::move(fence));
  return id;
}

}  // namespace cluxel::simulation
