// SPDX-License-Identifier: Apache-2.0
// Events are drawn object by object, each from a stream of its own, so that one event does not shift the others.
#include "simulation/site/site_visits.hpp"

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "simulation/site/campus_random.hpp"
#include "simulation/site/campus_site.hpp"
#include "simulation/site/occluders.hpp"
#include "simulation/site/stop_room.hpp"

namespace cluxel::simulation {

namespace {

using Eigen::AlignedBox3d, Eigen::Vector2d, Eigen::Vector3d, Eigen::Vector3f;

/// How often a visit finds something changed about an object.
struct Chances {
  double arrives_later = 0, leaves = 0, moves = 0, is_replaced = 0, is_cut = 0;
};

/// The chance that a van stands before a thing that can be hidden.
constexpr double kIsHidden = 0.2;

bool isOf(const CampusObject& object, ObjectClass object_class) {
  return object.class_number == static_cast<int>(object_class);
}

Chances chancesOf(const CampusObject& object) {
  if (isOf(object, ObjectClass::Vehicle)) return {.arrives_later = 0.2, .leaves = 0.25, .moves = 0.15};
  if (isOf(object, ObjectClass::StreetSign)) return {.leaves = 0.12};
  if (isOf(object, ObjectClass::StreetLamp)) return {.is_replaced = 0.15};
  constexpr double kTall_m = 1.2;  // lower bushes are left alone
  if (isOf(object, ObjectClass::Bush)) return {.is_cut = object.box.sizes().z() >= kTall_m ? 0.3 : 0};
  const bool can_move = isOf(object, ObjectClass::SmallObject) && object.kind != "fence" && object.kind != "bollard" &&
                        object.kind != "hydrant" && object.kind != "bench";
  return can_move ? Chances{.arrives_later = 0.1, .leaves = 0.2, .moves = 0.25} : Chances{};
}

class Visits {
 public:
  Visits(const Campus& campus, std::size_t count) : seed_(campus.params.seed), terrain_(campus.terrain) {
    site_.visits.push_back(campus);
    for (std::size_t i = 0; i < campus.objects.size(); ++i) drawArrival(campus, i, count);
    Campus& first = site_.visits.front();
    std::erase_if(first.meshes, [this](const CampusMesh& mesh) { return arrivalOf(mesh.instance) > 0; });
    stops_.push_back(campus.stops);
    for (std::size_t visit = 1; visit < count; ++visit) stops_.push_back(stopsOf(campus, visit));
    for (std::size_t visit = 1; visit < count; ++visit) addVisit(campus, visit);
    for (Campus& each : site_.visits) each.objects = site_.visits.back().objects;
  }

  VisitedSite result() && { return std::move(site_); }

 private:
  CampusRandom stream(std::size_t object, std::size_t visit) const {
    return CampusRandom{seed_, static_cast<std::uint64_t>(RandomUse::Visit), visit, object};
  }

  void drawArrival(const Campus& campus, std::size_t object, std::size_t count) {
    CampusRandom random = stream(object, 0);
    const bool is_late = count > 1 && random.chance(chancesOf(campus.objects[object]).arrives_later);
    arrival_.push_back(is_late ? 1 + static_cast<std::size_t>(random.below(static_cast<int>(count) - 1)) : 0);
  }

  std::size_t arrivalOf(std::int32_t instance) const {
    return instance < 0 || static_cast<std::size_t>(instance) >= arrival_.size()
               ? 0
               : arrival_[static_cast<std::size_t>(instance)];
  }

  void addVisit(const Campus& base, std::size_t visit) {
    Campus next = site_.visits.back();
    next.params.seed = mixedBits(seed_ + visit);  // other noise than on the visits before
    next.stops = stops_[visit];
    const std::size_t known = next.objects.size();
    for (const std::int32_t van : std::exchange(vans_, {})) leave(next, van, visit);
    for (std::size_t i = 0; i < known; ++i) {
      const auto instance = static_cast<std::int32_t>(i);
      if (arrivalOf(instance) == visit)
        arrive(base, next, instance, visit);
      else if (isThere(next, instance))
        change(next, instance, visit);
    }
    hideThings(base, next, visit);
    site_.visits.push_back(std::move(next));
  }

  static bool isThere(const Campus& campus, std::int32_t instance) {
    return std::any_of(campus.meshes.begin(), campus.meshes.end(),
                       [instance](const CampusMesh& mesh) { return mesh.instance == instance; });
  }

  void arrive(const Campus& base, Campus& next, std::int32_t instance, std::size_t visit) {
    for (const CampusMesh& mesh : base.meshes)
      if (mesh.instance == instance) next.meshes.push_back(mesh);
    site_.events.push_back({SiteEventKind::Arrived, visit, -1, instance, {}, {}});
  }

  void change(Campus& next, std::int32_t instance, std::size_t visit) {
    const auto i = static_cast<std::size_t>(instance);
    const Chances chances = chancesOf(next.objects[i]);
    CampusRandom random = stream(i, visit);
    const double draw = random.uniform();
    double bound = chances.leaves;
    if (draw < bound) return leave(next, instance, visit);
    if (draw < (bound += chances.moves)) return move(next, instance, visit, random);
    if (draw < (bound += chances.is_replaced)) return replace(next, instance, visit);
    if (draw < bound + chances.is_cut) cut(next, instance, visit);
  }

  void leave(Campus& next, std::int32_t instance, std::size_t visit) {
    erase(next, instance);
    site_.events.push_back({SiteEventKind::Left, visit, instance, -1, {}, {}});
  }

  static void erase(Campus& campus, std::int32_t instance) {
    std::erase_if(campus.meshes, [instance](const CampusMesh& mesh) { return mesh.instance == instance; });
  }

  /// A place 1.5 to 6 m away where nothing stands and no stop lies; none when ten attempts fail.
  void move(Campus& next, std::int32_t instance, std::size_t visit, CampusRandom& random) {
    const CampusObject& object = next.objects[static_cast<std::size_t>(instance)];
    for (int attempt = 0; attempt < 10; ++attempt) {
      const double angle = random.uniform(0, 2 * std::numbers::pi), far_m = random.uniform(1.5, 6);
      const Vector3d shift = alongGround(object.position, far_m * Vector2d(std::cos(angle), std::sin(angle)));
      AlignedBox3d place = object.box;
      place.translate(shift);
      if (!isFree(next, place, instance, visit) || !leavesStopsFree(next, instance, shift, visit)) continue;
      const std::int32_t moved = copyOf(next, instance, instance, shift);
      erase(next, instance);
      site_.events.push_back({SiteEventKind::Moved, visit, instance, moved, {}, {}});
      return;
    }
  }

  Vector3d alongGround(const Vector3d& from, const Vector2d& step) const {
    const Vector2d to = from.head<2>() + step;
    return {step.x(), step.y(), terrain_.heightAt(to.x(), to.y()) - terrain_.heightAt(from.x(), from.y())};
  }

  /// Whether nothing stands in the place, and nothing arrives there on this visit or later.
  bool isFree(const Campus& campus, const AlignedBox3d& place, std::int32_t mover, std::size_t visit) const {
    const AlignedBox3d roomy(place.min() - Vector3d::Constant(0.5), place.max() + Vector3d::Constant(0.5));
    const auto isTaken = [&](std::size_t object) { return roomy.intersects(campus.objects[object].box); };
    for (const CampusMesh& mesh : campus.meshes)
      if (mesh.instance != mover && mesh.instance > 0 && isTaken(static_cast<std::size_t>(mesh.instance)))  // 0: ground
        return false;
    for (std::size_t object = 0; object < arrival_.size(); ++object)
      if (arrival_[object] >= visit && isTaken(object)) return false;
    return true;
  }

  /// Whether the object, moved by `shift`, leaves the robot its room at the stops of this visit and of those to come.
  bool leavesStopsFree(const Campus& campus, std::int32_t instance, const Vector3d& shift, std::size_t visit) const {
    for (std::size_t later = visit; later < stops_.size(); ++later)
      for (const Eigen::Isometry3d& stop : stops_[later])
        if (!leavesRoom(campus, instance, shift, stop.translation())) return false;
    return true;
  }

  /// Adds an object with the surfaces of `model`, moved by `shift`, and returns its number.
  static std::int32_t copyOf(Campus& campus, std::int32_t model, std::int32_t named_after, const Vector3d& shift) {
    CampusObject object = campus.objects[static_cast<std::size_t>(model)];
    object.traits = campus.objects[static_cast<std::size_t>(named_after)].traits;
    object.position += shift;
    object.box.translate(shift);
    const auto made = static_cast<std::int32_t>(campus.objects.size());
    campus.objects.push_back(std::move(object));
    const std::size_t count = campus.meshes.size();
    for (std::size_t i = 0; i < count; ++i) {
      if (campus.meshes[i].instance != model) continue;
      CampusMesh mesh = campus.meshes[i];
      mesh.instance = made;
      for (Vector3f& vertex : mesh.vertices) vertex = (vertex.cast<double>() + shift).cast<float>();
      campus.meshes.push_back(std::move(mesh));
    }
    return made;
  }

  /// Replaces a lamp by a copy of the nearest lamp of another kind. Both poles look alike up to the head of the lower
  /// one, so the event states from which height they differ.
  void replace(Campus& next, std::int32_t instance, std::size_t visit) {
    const CampusObject old = next.objects[static_cast<std::size_t>(instance)];
    std::optional<std::int32_t> model;
    double nearest = 1e300;
    for (std::size_t i = 0; i < next.objects.size(); ++i) {
      const CampusObject& other = next.objects[i];
      const double distance = (other.position - old.position).norm();
      const bool is_model = other.class_number == old.class_number && other.kind != old.kind &&
                            isThere(next, static_cast<std::int32_t>(i));
      if (is_model && distance < nearest) nearest = distance, model = static_cast<std::int32_t>(i);
    }
    if (!model) return;
    const Vector3d shift = old.position - next.objects[static_cast<std::size_t>(*model)].position;
    if (!leavesStopsFree(next, *model, shift, visit)) return;
    const std::int32_t made = copyOf(next, *model, instance, shift);
    const AlignedBox3d now = next.objects[static_cast<std::size_t>(made)].box;
    const double differs_from = endOfPole(next, old.box.max().z() < now.max().z() ? instance : made);
    erase(next, instance);
    site_.events.push_back(
        {SiteEventKind::Replaced, visit, instance, made, above(old.box, differs_from), above(now, differs_from)});
  }

  /// The height at which the head or the arm of a lamp begins; its top when it has neither.
  static double endOfPole(const Campus& campus, std::int32_t lamp) {
    double lowest = campus.objects[static_cast<std::size_t>(lamp)].box.max().z();
    for (const CampusMesh& mesh : campus.meshes)
      if (mesh.instance == lamp && mesh.label != SurfaceLabel::LampPole)
        for (const Vector3f& vertex : mesh.vertices) lowest = std::min(lowest, static_cast<double>(vertex.z()));
    return lowest;
  }

  static AlignedBox3d above(AlignedBox3d box, double height) {
    box.min().z() = std::max(box.min().z(), height);
    return box;
  }

  /// Takes the upper 45 % off a bush or hedge, once.
  void cut(Campus& next, std::int32_t instance, std::size_t visit) {
    if (!cut_.insert(instance).second) return;
    const AlignedBox3d box = next.objects[static_cast<std::size_t>(instance)].box;
    constexpr double kLeft = 0.55;
    for (CampusMesh& mesh : next.meshes) {
      if (mesh.instance != instance) continue;
      for (Vector3f& vertex : mesh.vertices) {
        const double ground = terrain_.heightAt(vertex.x(), vertex.y());
        vertex.z() = static_cast<float>(ground + kLeft * (vertex.z() - ground));
      }
    }
    AlignedBox3d gone = box;
    gone.min().z() += kLeft * box.sizes().z();
    site_.events.push_back({SiteEventKind::Cut, visit, instance, instance, gone, {}});
  }

  /// Vans stand before some of the things of the visit before, whether they are still there or not. They leave before
  /// the next visit.
  void hideThings(const Campus& base, Campus& next, std::size_t visit) {
    const std::size_t known = site_.visits.back().objects.size();
    for (std::size_t i = 0; i < known; ++i) {
      const auto instance = static_cast<std::int32_t>(i);
      const CampusObject hidden = next.objects[i];
      if (!canBeHidden(hidden) || !isThere(site_.visits.back(), instance)) continue;
      CampusRandom random{seed_, static_cast<std::uint64_t>(RandomUse::Occluder), visit, i};
      if (!random.chance(kIsHidden)) continue;
      const auto T_map_van = placeOfVan(next, base.stops, hidden);
      if (!T_map_van) continue;
      const std::int32_t van = addVan(next, *T_map_van, random);
      vans_.push_back(van);
      site_.events.push_back({SiteEventKind::Arrived, visit, -1, van, {}, {}});
      site_.events.push_back({SiteEventKind::Hidden, visit, instance, van, {}, {}});
    }
  }

  /// The stops of a later visit lie half a stop farther along the route, up to half a metre aside. With fewer of them,
  /// each stands in the middle of an equal share of the route.
  std::vector<Eigen::Isometry3d> stopsOf(const Campus& base, std::size_t visit) const {
    std::vector<Eigen::Isometry3d> stops = base.stops;
    for (std::size_t i = 0; i + 1 < stops.size(); ++i) stops[i].translation() = stopAfter(base, i, visit);
    const auto wanted = static_cast<std::size_t>(base.params.later_stops);
    if (wanted == 0) return stops;
    std::vector<Eigen::Isometry3d> kept;
    for (std::size_t i = 0; i < wanted; ++i) kept.push_back(stops[(2 * i + 1) * stops.size() / (2 * wanted)]);
    return kept;
  }

  /// A place between a stop of the first visit and the next one, with room for the robot. The line between them cuts
  /// the corners of the route, where fences and signs may stand: when attempts fail, the stop of the first visit.
  Vector3d stopAfter(const Campus& base, std::size_t stop, std::size_t visit) const {
    CampusRandom random = stream(stop, 1000 + visit);
    const Vector3d from = base.stops[stop].translation(), step = base.stops[stop + 1].translation() - from;
    const double height = from.z() - terrain_.heightAt(from.x(), from.y());
    for (int attempt = 0; attempt < 10; ++attempt) {
      const double share = random.uniform(0.2, 0.8);
      const double north = random.uniform(-0.5, 0.5), east = random.uniform(-0.5, 0.5);
      const Vector3d to = from + share * step + Vector3d(east, north, 0);
      const Vector3d place(to.x(), to.y(), terrain_.heightAt(to.x(), to.y()) + height);
      if (hasRoom(base, place)) return place;
    }
    return from;
  }

  std::uint64_t seed_;
  const Terrain& terrain_;
  std::vector<std::size_t> arrival_;                   ///< the first visit that finds the object
  std::vector<std::vector<Eigen::Isometry3d>> stops_;  ///< by visit
  std::set<std::int32_t> cut_;
  std::vector<std::int32_t> vans_;  ///< that hide things on the newest visit
  VisitedSite site_;
};

}  // namespace

std::string_view nameOf(SiteEventKind kind) {
  constexpr std::array<std::string_view, 6> kNames{"left", "arrived", "moved", "replaced", "cut", "hidden"};
  return kNames[static_cast<std::size_t>(kind)];
}

VisitedSite visitSite(const Campus& campus, std::size_t count) {
  return Visits(campus, count).result();
}

}  // namespace cluxel::simulation
