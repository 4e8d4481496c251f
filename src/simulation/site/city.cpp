// SPDX-License-Identifier: Apache-2.0
// Districts share the city's heading and terrain; all else follows from a seed of their own.
#include "simulation/site/city.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "cluxel/error.hpp"
#include "simulation/site/campus_random.hpp"
#include "simulation/site/site_plan.hpp"

namespace cluxel::simulation {

using Eigen::Vector2d, Eigen::Vector3d;

namespace {

/// Instances of a district are numbered within a range of this length.
constexpr std::int32_t kInstancesPerDistrict = 100'000;

void checkEdge(std::size_t edge, const char* what) {
  if (edge >= 1 && edge <= kMaxCityEdge) return;
  throw Error(ErrorKind::InvalidArgument, "a city cannot have " + std::to_string(edge) + " " + what +
                                              " of districts: " + "choose 1 to " + std::to_string(kMaxCityEdge));
}

std::uint64_t seedOf(std::uint64_t city_seed, const DistrictPlace& place) {
  return CampusRandom{city_seed, static_cast<std::uint64_t>(RandomUse::District), place.column, place.row}.next();
}

/// The terrain as it is described from another origin. Heights are above that of the origin.
Terrain seenFrom(const Vector2d& origin, Terrain terrain) {
  for (Terrain::Wave& wave : terrain.waves) wave.phase_rad += wave.wave_number.dot(origin);
  return terrain;
}

bool isWithinRange(const CampusMesh& mesh, const Campus& campus) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& vertex : mesh.vertices) box.extend(vertex.cast<double>());
  return std::any_of(campus.stops.begin(), campus.stops.end(), [&](const Eigen::Isometry3d& stop) {
    return box.exteriorDistance(Vector3d(stop.translation())) <= campus.params.max_range_m;
  });
}

/// Adds the objects of a district, which lies `away` from the one of `into`, and those of its surfaces that its scans
/// may see.
void addDistrict(const Campus& campus, const DistrictPlace& place, const Vector3d& away, District& into) {
  const bool is_own = place.number == into.place.number;
  for (CampusMesh mesh : campus.meshes) {
    for (Eigen::Vector3f& vertex : mesh.vertices)
      if (!is_own) vertex = (vertex.cast<double>() + away).cast<float>();
    if (!is_own && !isWithinRange(mesh, into.campus)) continue;
    if (mesh.instance >= 0) {
      CampusObject object = campus.objects[static_cast<std::size_t>(mesh.instance)];
      object.position += away;
      object.box.translate(away);
      mesh.instance += place.first_instance;
      into.objects.emplace(mesh.instance, std::move(object));
    }
    into.scene.meshes.push_back(std::move(mesh));
  }
}

}  // namespace

void check(const CityParams& params) {
  if (params.district.visits != 1 || params.district.pose_error_m != 0 || params.district.later_stops != 0)
    throw Error(
        ErrorKind::InvalidArgument,
        "a city is visited once: leave visits at 1, and pose-error and later-stops, which concern later visits, "
        "at 0");
  check(params.district);
  checkEdge(params.columns, "columns");
  checkEdge(params.rows, "rows");
}

City::City(const CityParams& params)
    : params_(params),
      frame_(campusFrameOf(params.district.seed)),
      pitch_m_(params.district.size_m + 2 * SitePlan::kMargin_m) {
  check(params);
  // Stops lie within 0.32 of the size from the middle, and a metre more; a district ends at half the pitch, but for
  // crowns.
  const double seen_m = 0.32 * params.district.size_m + 1 + params.district.max_range_m + kMaxOverhang_m;
  reach_ = static_cast<std::size_t>((seen_m + pitch_m_ / 2) / pitch_m_);
}

DistrictPlace City::placeOf(std::size_t number) const {
  DistrictPlace place;
  place.city_seed = params_.district.seed;
  place.number = number;
  place.column = number % params_.columns;
  place.row = number / params_.columns;
  place.first_instance = static_cast<std::int32_t>(number) * kInstancesPerDistrict;
  const Vector2d origin(pitch_m_ * static_cast<double>(place.column), pitch_m_ * static_cast<double>(place.row));
  place.origin_map.head<2>() = Eigen::Rotation2Dd(frame_.heading_rad) * origin;
  place.origin_map.z() = frame_.terrain.slope.dot(origin);
  return place;
}

Campus City::campusOf(std::size_t number) const {
  const DistrictPlace place = placeOf(number);
  CampusParams params = params_.district;
  params.seed = seedOf(params_.district.seed, place);
  const Vector2d origin(pitch_m_ * static_cast<double>(place.column), pitch_m_ * static_cast<double>(place.row));
  return buildCampus(params, {.terrain = seenFrom(origin, frame_.terrain), .heading_rad = frame_.heading_rad});
}

std::vector<std::size_t> City::around(std::size_t number) const {
  const DistrictPlace place = placeOf(number);
  const auto isNear = [this](std::size_t a, std::size_t b) { return (a > b ? a - b : b - a) <= reach_; };
  std::vector<std::size_t> numbers;
  for (std::size_t other = 0; other < size(); ++other)
    if (other != number && isNear(other % params_.columns, place.column) && isNear(other / params_.columns, place.row))
      numbers.push_back(other);
  return numbers;
}

District City::district(std::size_t number) const {
  if (number >= size())
    throw Error(ErrorKind::InvalidArgument, "the city has " + std::to_string(size()) +
                                                " districts, numbered from 0: there is no district " +
                                                std::to_string(number));
  District district{.place = placeOf(number), .campus = campusOf(number), .scene = {}, .objects = {}};
  district.scene = district.campus;
  district.scene.meshes.clear();
  addDistrict(district.campus, district.place, Vector3d::Zero(), district);
  for (const std::size_t other : around(number)) {
    const DistrictPlace place = placeOf(other);
    addDistrict(campusOf(other), place, place.origin_map - district.place.origin_map, district);
  }
  return district;
}

std::size_t City::lastToSee(std::size_t number) const {
  const DistrictPlace place = placeOf(number);
  return std::min(place.row + reach_, params_.rows - 1) * params_.columns +
         std::min(place.column + reach_, params_.columns - 1);
}

}  // namespace cluxel::simulation
