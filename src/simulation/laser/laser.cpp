// SPDX-License-Identifier: Apache-2.0
// From rays to returns: beam width and mixed pixels, dropouts, range noise, intensity.
#include "simulation/laser/laser.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "cluxel/error.hpp"
#include "simulation/laser/ray_caster.hpp"
#include "simulation/site/campus_random.hpp"

namespace cluxel::simulation {
namespace {

using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kLowest_rad = -50 * kDegree, kHighest_rad = 55 * kDegree;
constexpr double kLowestRing_rad = -24.8 * kDegree, kHighestRing_rad = 2 * kDegree;
constexpr std::size_t kRings = 64;

/// A full turn as columns (pan) of rays (tilt). The tilts have the step of the pan, or are those of a spinning laser's
/// rings.
struct RayGrid {
  std::size_t columns = 0, rows = 0;
  LaserKind kind;

  RayGrid(double rays, LaserKind laser) : kind(laser) {
    if (kind == LaserKind::Spinning) {
      rows = kRings;
      columns = static_cast<std::size_t>(std::lround(rays / kRings));
      return;
    }
    const double step = std::sqrt((kHighest_rad - kLowest_rad) * 2 * std::numbers::pi / rays);
    columns = static_cast<std::size_t>(std::lround(2 * std::numbers::pi / step));
    rows = static_cast<std::size_t>(std::lround((kHighest_rad - kLowest_rad) / step));
  }
  std::size_t size() const { return columns * rows; }
  Vector3d direction(std::size_t ray, CampusRandom& random) const {
    const double column = static_cast<double>(ray / rows) + random.uniform(-0.1, 0.1);
    const double row = static_cast<double>(ray % rows) + 0.5 + random.uniform(-0.1, 0.1);
    const double pan = 2 * std::numbers::pi * column / static_cast<double>(columns);
    const double tilt = kind == LaserKind::Spinning
                            ? ringTilt(ray % rows)
                            : kLowest_rad + (kHighest_rad - kLowest_rad) * row / static_cast<double>(rows);
    return {std::cos(tilt) * std::cos(pan), std::cos(tilt) * std::sin(pan), std::sin(tilt)};
  }
  static double ringTilt(std::size_t ring) {
    return kLowestRing_rad + (kHighestRing_rad - kLowestRing_rad) * static_cast<double>(ring) / (kRings - 1);
  }
};

struct Return {
  Vector3d p_sensor;
  double intensity = 0;
  std::uint32_t mesh = 0;
};

/// A random direction within the beam, uniform over its disc.
Vector3d withinBeam(const Vector3d& direction, double radius_rad, CampusRandom& random) {
  const Vector3d u = direction.unitOrthogonal(), v = direction.cross(u);
  const double around = 2 * std::numbers::pi * random.uniform(), reach = radius_rad * std::sqrt(random.uniform());
  return (direction + reach * (std::cos(around) * u + std::sin(around) * v)).normalized();
}

/// The share of rays lost at grazing incidence: about a third at 87 degrees.
bool isLost(const RayHit& hit, const CampusMesh& mesh, double miss_probability, CampusRandom& random) {
  constexpr double kFlat = 0.045;
  const double grazing = std::exp(-hit.cos_incidence / kFlat);
  const bool lost = random.chance(miss_probability), slipped = random.chance(grazing);
  return random.chance(mesh.transparency) || lost || slipped;
}

}  // namespace

struct Laser::Impl {
  explicit Impl(const Campus& the_campus) : campus(the_campus), caster(the_campus) {}

  const Campus& campus;
  RayCaster caster;

  /// The range that a beam of some width reports, and the nearer of the surfaces that it meets.
  std::optional<RayHit> measure(const Vector3d& origin, const Vector3d& direction, CampusRandom& random) const {
    constexpr double kEdge_m = 0.08, kPulse_m = 1.2;  // echoes closer than the pulse is long run together
    const CampusParams& params = campus.params;
    const auto middle = caster.cast(origin, direction, params.max_range_m);
    const auto side = caster.cast(origin, withinBeam(direction, params.beam_radius_rad, random), params.max_range_m);
    const double share = random.uniform(0.15, 0.85);
    const bool mixes = random.chance(params.mixed_pixel_probability);
    if (!middle || !side) return mixes ? (middle ? middle : side) : middle;
    RayHit hit = *middle;
    const double gap = std::abs(side->range_m - middle->range_m);
    if (!mixes || gap < kEdge_m || gap > kPulse_m) return hit;
    if (side->range_m < middle->range_m) hit = *side;
    hit.range_m = share * middle->range_m + (1 - share) * side->range_m;
    return hit;
  }

  std::optional<Return> shoot(std::size_t stop, std::size_t ray, const RayGrid& grid) const {
    CampusRandom random{campus.params.seed, static_cast<std::uint64_t>(RandomUse::Ray), stop, ray};
    const Eigen::Isometry3d& T_map_sensor = campus.stops[stop];
    const Vector3d direction = grid.direction(ray, random);
    const auto hit = measure(T_map_sensor.translation(), T_map_sensor.linear() * direction, random);
    if (!hit) return std::nullopt;
    const CampusMesh& mesh = campus.meshes[hit->mesh];
    if (isLost(*hit, mesh, campus.params.miss_probability, random)) return std::nullopt;
    const double range = hit->range_m + campus.params.range_sigma_m * random.normal();
    if (!(range >= 0.3 && range <= campus.params.max_range_m)) return std::nullopt;  // along a triangle it is no number
    const double shine = mesh.reflectivity * (0.4 + 0.6 * hit->cos_incidence) * (1 + 0.06 * random.normal());
    return Return{range * direction, std::clamp(shine, 0.0, 1.0), hit->mesh};
  }

  /// So many rays that about points_per_stop of them return, from a coarse turn. At most five times as many.
  RayGrid gridFor(std::size_t stop) const {
    const RayGrid preview(6000, campus.params.laser);
    std::size_t returns = 0;
    for (std::size_t ray = 0; ray < preview.size(); ++ray) returns += shoot(stop, ray, preview).has_value() ? 1 : 0;
    const double share = std::max(0.2, static_cast<double>(returns) / static_cast<double>(preview.size()));
    return RayGrid(campus.params.points_per_stop / share, campus.params.laser);
  }
};

Laser::Laser(const Campus& campus) : impl_(std::make_unique<Impl>(campus)) {}
Laser::~Laser() = default;
Laser::Laser(Laser&&) noexcept = default;

std::optional<RayHit> Laser::cast(const Vector3d& origin_map, const Vector3d& direction_map) const {
  return impl_->caster.cast(origin_map, direction_map, impl_->campus.params.max_range_m);
}

bool Laser::reaches(const Eigen::Isometry3d& T_map_sensor, const Vector3d& place_map) const {
  const Vector3d place = T_map_sensor.inverse() * place_map;
  const CampusParams& params = impl_->campus.params;
  const double elevation = std::atan2(place.z(), place.head<2>().norm());
  const bool spins = params.laser == LaserKind::Spinning;
  return place.norm() <= params.max_range_m && elevation >= (spins ? kLowestRing_rad : kLowest_rad) &&
         elevation <= (spins ? kHighestRing_rad : kHighest_rad);
}

double Laser::meanStep_rad(std::size_t stop) const {
  const bool spins = impl_->campus.params.laser == LaserKind::Spinning;
  const double height = spins ? kHighestRing_rad - kLowestRing_rad : kHighest_rad - kLowest_rad;
  return std::sqrt(height * 2 * std::numbers::pi / static_cast<double>(impl_->gridFor(stop).size()));
}

namespace {

void append(SimulatedScan& result, const Return& echo, const CampusMesh& mesh) {
  scan::ScanPoints& points = result.scan.points;
  points.x.push_back(static_cast<float>(echo.p_sensor.x()));
  points.y.push_back(static_cast<float>(echo.p_sensor.y()));
  points.z.push_back(static_cast<float>(echo.p_sensor.z()));
  points.intensity.push_back(static_cast<float>(echo.intensity));
  points.label.push_back(static_cast<std::uint32_t>(mesh.label));
  const SurfaceInfo& surface = infoOf(mesh.label);
  result.truth.primitive.push_back(surface.primitive ? static_cast<std::int8_t>(*surface.primitive) : std::int8_t{-1});
  result.truth.object_class.push_back(static_cast<std::int8_t>(surface.object_number));
  result.truth.instance.push_back(mesh.instance);
}

}  // namespace

SimulatedScan Laser::scanAt(std::size_t stop) const {
  const Campus& campus = impl_->campus;
  if (stop >= campus.stops.size())
    throw Error(ErrorKind::InvalidArgument, "the campus has " + std::to_string(campus.stops.size()) +
                                                " stops, numbered from 0: there is no stop " + std::to_string(stop));
  SimulatedScan result;
  result.truth.class_names = scan::truthClassNames();
  const RayGrid grid = impl_->gridFor(stop);
  for (std::size_t ray = 0; ray < grid.size(); ++ray)
    if (const auto echo = impl_->shoot(stop, ray, grid)) append(result, *echo, campus.meshes[echo->mesh]);
  result.scan.T_map_sensor = campus.stops[stop];
  result.scan.has_pose = true;
  result.scan.time_s = stopTime_s(stop);
  result.scan.source = "generated stop " + std::to_string(stop);
  result.scan.id = contentIdOf(result.scan);
  return result;
}

}  // namespace cluxel::simulation
