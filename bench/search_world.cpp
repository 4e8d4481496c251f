// SPDX-License-Identifier: Apache-2.0
// Truth of a campus on a grid, and its partial map.
#include "search_world.hpp"

#include <algorithm>
#include <cmath>

#include "base/installation/data_home.hpp"
#include "mapping/build/map_builder.hpp"
#include "scan/formats/scan_writer.hpp"
#include "scan/truth/truth.hpp"
#include "tasks/ways/way_search.hpp"

namespace cluxel::bench {

namespace {

using tasks::Closure;

simulation::Campus campusOf(const WorldParams& params) {
  simulation::CampusParams campus;
  campus.seed = params.seed;
  campus.size_m = params.size_m;
  campus.stops = static_cast<double>(simulation::maxStops(params.size_m));
  campus.points_per_stop = params.points_per_stop;
  return buildCampus(campus);
}

bool isGround(simulation::SurfaceLabel label) {
  return label <= simulation::SurfaceLabel::Sidewalk;
}

/// Visits points of a triangle that lie at most `pitch_m` apart.
template <typename Visit>
void visitTriangle(const simulation::CampusMesh& mesh, const std::array<std::uint32_t, 3>& corner, double pitch_m,
                   const Visit& visit) {
  const Eigen::Vector3d a = mesh.vertices[corner[0]].cast<double>(), b = mesh.vertices[corner[1]].cast<double>(),
                        c = mesh.vertices[corner[2]].cast<double>();
  const double longest = std::max({(b - a).norm(), (c - a).norm(), (c - b).norm()});
  const int n = std::max(1, static_cast<int>(std::ceil(longest / pitch_m)));
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j)
      visit(Eigen::Vector3d(a + (b - a) * (static_cast<double>(i) / n) + (c - a) * (static_cast<double>(j) / n)));
}

}  // namespace

std::filesystem::path buildCampusMap(const simulation::Campus& campus, const simulation::Laser& laser, double share,
                                     const std::filesystem::path& folder, const std::filesystem::path& home) {
  static ProgressSink silence;
  const auto count = static_cast<std::size_t>(std::ceil(share * static_cast<double>(campus.stops.size())));
  std::vector<std::filesystem::path> files;
  for (std::size_t stop = 0; stop < count; ++stop) {
    files.push_back(folder / ("stop" + std::to_string(stop) + ".pcd"));
    writeScanFile(laser.scanAt(stop).scan, files.back());
  }
  mapping::MapInputFiles inputs;
  inputs.model = "campus";
  const std::filesystem::path map = folder / ("campus" + std::to_string(campus.params.seed) + ".clx");
  mapping::BuildParams params;
  params.threads = 1;
  mapping::buildMap(scan::ScanSet::open(files, {}, silence), mapping::readMapInputs(inputs, DataHome(home)), map,
                    params, silence);
  for (const std::filesystem::path& file : files) std::filesystem::remove(file);
  return map;
}

SearchWorld::SearchWorld(const WorldParams& params, const std::filesystem::path& folder,
                         const std::filesystem::path& home)
    : params_(params), campus_(campusOf(params)), laser_(std::make_unique<simulation::Laser>(campus_)) {
  const double half = params_.size_m / 2,
               reach = half * (std::abs(std::cos(campus_.heading_rad)) + std::abs(std::sin(campus_.heading_rad)));
  const int count = static_cast<int>(std::ceil(2 * reach / params_.cell_m));
  frame_ = {std::floor(-reach / params_.cell_m) * params_.cell_m, std::floor(-reach / params_.cell_m) * params_.cell_m,
            params_.cell_m, count, count};
  rasterise();
  map_ = std::make_unique<mapping::MapReader>(buildCampusMap(campus_, *laser_, params_.known_share, folder, home));
  chooseTargets();
}

bool SearchWorld::isInSite(const Eigen::Vector2d& p) const {
  const Eigen::Vector2d plan = Eigen::Rotation2Dd(-campus_.heading_rad) * p;
  return plan.cwiseAbs().maxCoeff() <= params_.size_m / 2;
}

void SearchWorld::rasterise() {
  constexpr double pitch_m = 0.2, lowest_m = 0.2, highest_m = 1.8, eye_band_m = 0.3;
  height_.assign(frame_.size(), 0.0F);
  closure_.assign(frame_.size(), Closure::Open);
  sight_ = {frame_, LargeArray<std::uint8_t>(frame_.size(), 0)};
  for (const simulation::CampusMesh& mesh : campus_.meshes)
    for (const auto& corner : mesh.triangles)
      if (isGround(mesh.label))
        visitTriangle(mesh, corner, pitch_m, [&](const Eigen::Vector3d& p) {
          if (const auto cell = frame_.cellAt(p.head<2>())) height_[*cell] = static_cast<float>(p.z());
        });
  for (const simulation::CampusMesh& mesh : campus_.meshes)
    for (const auto& corner : mesh.triangles)
      if (!isGround(mesh.label))
        visitTriangle(mesh, corner, pitch_m, [&](const Eigen::Vector3d& p) {
          const auto cell = frame_.cellAt(p.head<2>());
          if (!cell) return;
          const double above = p.z() - static_cast<double>(height_[*cell]);
          if (above > lowest_m && above < highest_m) closure_[*cell] = Closure::Obstacle;
          if (std::abs(above - params_.eye_m) < eye_band_m && mesh.transparency < 0.5F) sight_.opaque[*cell] = 1;
        });
  for (std::uint32_t cell = 0; cell < frame_.size(); ++cell)
    if (!isInSite(frame_.centreOf(cell))) closure_[cell] = Closure::Obstacle;
}

tasks::TerrainGrid SearchWorld::terrain() const {
  tasks::TerrainParams params;
  params.cell_m = params_.cell_m;
  const Eigen::Vector2d low(frame_.min_x, frame_.min_y);
  const Eigen::Vector2d inner(frame_.columns - 0.5, frame_.rows - 0.5);
  params.area = Eigen::AlignedBox2d(low, low + inner * params_.cell_m);
  return terrainOf(*map_, params);
}

tasks::PassableGrid SearchWorld::belief() const {
  tasks::WayParams params;
  params.crosses_unobserved = true;
  params.max_slope = 1;
  params.max_step_m = 1;
  tasks::PassableGrid grid = passableOf(terrain(), params, std::vector<bool>(map_->objects().size(), false), {});
  for (std::uint32_t cell = 0; cell < frame_.size(); ++cell)
    if (!isInSite(frame_.centreOf(cell))) grid.closure[cell] = Closure::Obstacle;
  return grid;
}

tasks::PassableGrid SearchWorld::trueGrid() const {
  tasks::PassableGrid grid = belief();
  grid.closure = closure_;
  return grid;
}

Eigen::Vector2d SearchWorld::start() const {
  // The scans have no times; their names follow the route.
  const std::vector<mapping::Cloud> clouds = map_->clouds();
  const auto last =
      std::max_element(clouds.begin(), clouds.end(), [](const auto& a, const auto& b) { return a.source < b.source; });
  return last->T_map_sensor.translation().head<2>();
}

bool SearchWorld::isSeenFrom(const SearchTarget& target, std::uint32_t cell) const {
  const Eigen::Vector2d at = frame_.centreOf(cell);
  if ((target.at - at).norm() > params_.view_m) return false;
  const Eigen::Vector3d eye(at.x(), at.y(), static_cast<double>(height_[cell]) + params_.eye_m);
  return std::any_of(target.points.begin(), target.points.end(), [&](const Eigen::Vector3d& point) {
    const auto hit = laser_->cast(eye, (point - eye).normalized());
    return hit && campus_.meshes[hit->mesh].instance == target.instance;
  });
}

void SearchWorld::chooseTargets() {
  constexpr double known_within_m = 1.5;
  constexpr std::size_t points_each = 24;
  const auto& names = scan::truthClassNames();
  std::vector<Eigen::Vector2d> known;
  for (std::size_t i = 0; i < map_->objects().size(); ++i)
    if (mapping::localName(map_->objects()[i].class_iri) == params_.class_name)
      known.push_back(tasks::placeNamed(*map_, map_->objects()[i].id.hex()));
  const tasks::PassableGrid grid = trueGrid();
  const auto walk_m = cheapestWays(grid, openCellNear(grid, start()), {.is_priced = false}).cost;
  for (std::size_t i = 0; i < campus_.objects.size(); ++i) {
    const simulation::CampusObject& object = campus_.objects[i];
    if (object.class_number < 0 || names[static_cast<std::size_t>(object.class_number)] != params_.class_name) continue;
    ++objects_of_class_;
    SearchTarget target{static_cast<std::int32_t>(i), object.position.head<2>(), {}};
    if (std::any_of(known.begin(), known.end(),
                    [&](const auto& place) { return (place - target.at).norm() < known_within_m; }))
      continue;
    std::vector<Eigen::Vector3d> all;
    for (const simulation::CampusMesh& mesh : campus_.meshes)
      if (mesh.instance == target.instance)
        for (const auto& t : mesh.triangles)
          all.emplace_back((mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]).cast<double>() / 3);
    const std::size_t stride = std::max<std::size_t>(1, all.size() / points_each);
    for (std::size_t p = 0; p < all.size(); p += stride) target.points.push_back(all[p]);
    bool is_visible = false;
    for (std::uint32_t cell = 0; cell < frame_.size() && !is_visible; cell += 3)
      is_visible = std::isfinite(walk_m[cell]) && isSeenFrom(target, cell);
    if (is_visible) targets_.push_back(std::move(target));
  }
}

}  // namespace cluxel::bench
