// SPDX-License-Identifier: Apache-2.0
// Each object stands alone in a scene of its own, a bush that is cut in two; rays that meet it there are cast in the
// scene of the visit.
#include "simulation/laser/visit_truth.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/file_bytes.hpp"
#include "base/parallel.hpp"
#include "scan/truth/truth.hpp"
#include "simulation/laser/laser.hpp"
#include "simulation/site/campus_site.hpp"

namespace cluxel::simulation {

namespace {

using Eigen::AlignedBox3d, Eigen::Vector3d;

constexpr double kBehind_m = 0.05;  ///< a ray that ends this much before a surface counts as reaching it
/// Rays in each direction for one of the laser: its own pass small things that others like them would meet.
constexpr int kFiner = 3;

/// The surfaces of each object, as it stood when it was first there.
std::map<std::int32_t, std::vector<CampusMesh>> surfacesOfObjects(const VisitedSite& site) {
  std::map<std::int32_t, std::vector<CampusMesh>> surfaces;
  for (const Campus& campus : site.visits) {
    std::map<std::int32_t, std::vector<CampusMesh>> found;
    for (const CampusMesh& mesh : campus.meshes)
      if (!surfaces.contains(mesh.instance)) found[mesh.instance].push_back(mesh);
    surfaces.merge(found);
  }
  return surfaces;
}

/// An object that stands alone in a scene of its own.
struct LoneObject {
  LoneObject(const CampusParams& params, const std::vector<CampusMesh>& meshes, const AlignedBox3d& its_bounds)
      : bounds(its_bounds) {
    campus.params = params;
    campus.meshes = meshes;
    laser.emplace(campus);
  }
  LoneObject(const LoneObject&) = delete;

  Campus campus;
  std::optional<Laser> laser;
  AlignedBox3d bounds;
};

/// A visit: its campus and how densely the laser looks from each stop.
struct VisitScene {
  explicit VisitScene(const Campus& the_campus) : campus(the_campus), laser(the_campus) {
    for (std::size_t stop = 0; stop < campus.stops.size(); ++stop) step_rad.push_back(laser.meanStep_rad(stop));
  }
  VisitScene(const VisitScene&) = delete;

  const Campus& campus;
  Laser laser;
  std::vector<double> step_rad;  ///< between rays, by stop
};

/// The rays within `part` that reach the object from a stop, or would if it stood there: `finer` by `finer` for each
/// ray of the laser, in a grid through the object's bounds.
std::size_t raysOn(const LoneObject& object, const AlignedBox3d& part, const VisitScene& visit, std::size_t stop,
                   int finer) {
  const Eigen::Isometry3d& T_map_sensor = visit.campus.stops[stop];
  const double step_rad = visit.step_rad[stop] / finer;
  const Vector3d origin = T_map_sensor.translation(), middle = object.bounds.center() - origin;
  const double distance = middle.norm(), radius = 0.5 * object.bounds.sizes().norm();
  const double half_angle = std::asin(std::min(0.99, radius / distance));
  const Vector3d forward = middle.normalized(), right = forward.unitOrthogonal(), up = forward.cross(right);
  const int steps = static_cast<int>(std::ceil(half_angle / step_rad));
  std::size_t rays = 0;
  for (int i = -steps; i <= steps; ++i)
    for (int j = -steps; j <= steps; ++j) {
      const Vector3d way = forward + std::tan(i * step_rad) * right + std::tan(j * step_rad) * up;
      const Vector3d direction = way.normalized();
      const auto hit = object.laser->cast(origin, direction);
      if (!hit) continue;
      const Vector3d place = origin + hit->range_m * direction;
      if (!part.contains(place) || !visit.laser.reaches(T_map_sensor, place)) continue;
      const auto first = visit.laser.cast(origin, direction);
      rays += first && first->range_m >= hit->range_m - kBehind_m ? 1 : 0;
    }
  return rays;
}

/// The points within `part` that a visit measures on the object, or would if it stood there. Where they are few, a
/// finer grid counts them: zero only when none of its rays reaches the object.
std::size_t pointsOn(const LoneObject& object, const AlignedBox3d& part, const VisitScene& visit) {
  const auto rays = [&](int finer) {
    std::size_t sum = 0;
    for (std::size_t stop = 0; stop < visit.step_rad.size(); ++stop) sum += raysOn(object, part, visit, stop, finer);
    return sum;
  };
  constexpr std::size_t kFew = 50;
  if (const std::size_t points = rays(1); points >= kFew) return points;
  return (rays(kFiner) + kFiner * kFiner - 1) / (kFiner * kFiner);
}

bool isScored(const CampusObject& object) {
  return object.class_number != static_cast<int>(ObjectClass::Ground) &&
         object.class_number != static_cast<int>(ObjectClass::Building);
}

const std::string& className(const CampusObject& object) {
  return scan::truthClassNames()[static_cast<std::size_t>(object.class_number)];
}

std::string boxText(const AlignedBox3d& box) {
  char text[160];
  if (box.isEmpty()) return ",,,,,";
  std::snprintf(text, sizeof text, "%.2f,%.2f,%.2f,%.2f,%.2f,%.2f", box.min().x(), box.min().y(), box.min().z(),
                box.max().x(), box.max().y(), box.max().z());
  return text;
}

AlignedBox3d padded(const AlignedBox3d& box) {
  return AlignedBox3d(box.min() - Vector3d::Constant(0.01), box.max() + Vector3d::Constant(0.01));
}

/// How an object looks from a visit on.
struct Shape {
  std::size_t since = 0;
  std::unique_ptr<LoneObject> object;
};

AlignedBox3d boundsOf(const std::vector<CampusMesh>& meshes) {
  AlignedBox3d bounds;
  for (const CampusMesh& mesh : meshes)
    for (const Eigen::Vector3f& vertex : mesh.vertices) bounds.extend(vertex.cast<double>());
  return bounds;
}

std::vector<CampusMesh> surfacesOf(const Campus& campus, std::int32_t instance) {
  std::vector<CampusMesh> surfaces;
  for (const CampusMesh& mesh : campus.meshes)
    if (mesh.instance == instance) surfaces.push_back(mesh);
  return surfaces;
}

class TruthTables {
 public:
  TruthTables(const VisitedSite& site, unsigned threads)
      : site_(site), objects_(site.visits.front().objects), threads_(threads) {
    for (const auto& [instance, meshes] : surfacesOfObjects(site))
      if (instance >= 0 && isScored(objects_[static_cast<std::size_t>(instance)]))
        addShape(instance, 0, meshes, objects_[static_cast<std::size_t>(instance)].box);
    for (const SiteEvent& event : site.events)
      if (event.kind == SiteEventKind::Cut) addRest(event);
    for (const Campus& campus : site.visits) scenes_.push_back(std::make_unique<VisitScene>(campus));
  }

  std::string events() const {
    std::string table =
        "visit,event,class,instance,new_instance,xmin,ymin,zmin,xmax,ymax,zmax,new_xmin,new_ymin,new_zmin,new_xmax,"
        "new_ymax,new_zmax,points_before,points_after,new_points_before,new_points_after\n";
    for (const SiteEvent& event : site_.events) {
      const std::int32_t any = event.instance >= 0 ? event.instance : event.new_instance;
      const AlignedBox3d gone = event.gone.isEmpty() ? boxOn(event.visit - 1, event.instance) : event.gone;
      const AlignedBox3d come = event.kind == SiteEventKind::Cut ? AlignedBox3d()
                                : event.come.isEmpty()           ? boxOn(event.visit, event.new_instance)
                                                                 : event.come;
      table += std::to_string(event.visit) + "," + std::string(nameOf(event.kind)) + "," +
               className(objects_[static_cast<std::size_t>(any)]) + "," + std::to_string(event.instance) + "," +
               std::to_string(event.new_instance) + "," + boxText(gone) + "," + boxText(come) + "," +
               pointsText(event, event.instance, gone) + "," + pointsText(event, event.new_instance, come) + "\n";
    }
    return table;
  }

  std::string visits() const {
    std::string table = "instance,class,visit,present,points\n";
    std::vector<std::int32_t> instances;
    for (const auto& [instance, shapes] : shapes_) instances.push_back(instance);
    for (std::size_t visit = 0; visit < site_.visits.size(); ++visit) {
      std::set<std::int32_t> present;
      for (const CampusMesh& mesh : site_.visits[visit].meshes) present.insert(mesh.instance);
      std::vector<std::size_t> points(instances.size());
      parallelFor(instances.size(), threads_,
                  [&](std::size_t i) { points[i] = pointsOnAll(shapeOn(visit, instances[i]), visit); });
      for (std::size_t i = 0; i < instances.size(); ++i)
        table += std::to_string(instances[i]) + "," + className(objects_[static_cast<std::size_t>(instances[i])]) +
                 "," + std::to_string(visit) + "," + (present.contains(instances[i]) ? "1," : "0,") +
                 std::to_string(points[i]) + "\n";
    }
    return table;
  }

 private:
  void addShape(std::int32_t instance, std::size_t since, const std::vector<CampusMesh>& meshes,
                const AlignedBox3d& bounds) {
    shapes_[instance].push_back({since, std::make_unique<LoneObject>(site_.visits.front().params, meshes, bounds)});
  }

  /// What is left of a bush that is cut.
  void addRest(const SiteEvent& event) {
    const std::vector<CampusMesh> meshes = surfacesOf(site_.visits[event.visit], event.instance);
    addShape(event.instance, event.visit, meshes, boundsOf(meshes));
  }

  /// The object as it stands on a visit; before it is there as it arrives, afterwards as it left.
  const LoneObject& shapeOn(std::size_t visit, std::int32_t instance) const {
    const std::vector<Shape>& shapes = shapes_.at(instance);
    const auto later = std::find_if(shapes.begin() + 1, shapes.end(), [&](const Shape& s) { return s.since > visit; });
    return *std::prev(later)->object;
  }

  AlignedBox3d boxOn(std::size_t visit, std::int32_t instance) const {
    return instance < 0 ? AlignedBox3d() : shapeOn(visit, instance).bounds;
  }

  std::size_t pointsOnAll(const LoneObject& object, std::size_t visit) const {
    return pointsOn(object, padded(object.bounds), *scenes_[visit]);
  }

  /// Points on a part in the visit before an event and in its own; empty when there is no such part. What is cut off
  /// counts in both as it was before.
  std::string pointsText(const SiteEvent& event, std::int32_t instance, const AlignedBox3d& part) const {
    if (instance < 0 || part.isEmpty()) return ",";
    const std::size_t before = event.visit - 1, shape_after = event.kind == SiteEventKind::Cut ? before : event.visit;
    const auto points = [&](std::size_t shape_on, std::size_t visit) {
      return std::to_string(pointsOn(shapeOn(shape_on, instance), padded(part), *scenes_[visit]));
    };
    return points(before, before) + "," + points(shape_after, event.visit);
  }

  const VisitedSite& site_;
  const std::vector<CampusObject>& objects_;
  unsigned threads_;
  std::map<std::int32_t, std::vector<Shape>> shapes_;  ///< by the visit from which they hold
  std::vector<std::unique_ptr<VisitScene>> scenes_;
};

}  // namespace

void writeVisitTruth(const VisitedSite& site, const std::filesystem::path& folder, unsigned threads) {
  const TruthTables tables(site, threads);
  writeFile(folder / "events.csv", tables.events());
  writeFile(folder / "visits.csv", tables.visits());
}

}  // namespace cluxel::simulation
