// SPDX-License-Identifier: Apache-2.0
// Facts about objects: plain numbers, and GeoSPARQL, SOSA and PROV terms. Each object is a unit of facts with its parts
// and observations; its neighbours are another.
#include "mapping/facts/object_facts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <string_view>

#include "base/parallel.hpp"
#include "base/utc_time.hpp"
#include "mapping/facts/fact_order.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {

namespace {

/// The properties of an object that follow from rays.
constexpr std::array<std::string_view, 6> kRayProperties{"firstSeen",   "lastSeen", "seenEmpty",
                                                         "seenThrough", "porosity", "rayCount"};

std::string pointText(const Eigen::Vector2d& p) {
  return decimalText(p.x(), 3) + " " + decimalText(p.y(), 3);
}

std::string boxWkt(const perception::UprightBox& box) {
  const Eigen::Vector2d along(std::cos(box.yaw_rad), std::sin(box.yaw_rad)), across(-along.y(), along.x());
  const Eigen::Vector2d half_length = 0.5 * box.size.x() * along, half_width = 0.5 * box.size.y() * across;
  const Eigen::Vector2d center = box.center.head<2>();
  const std::string first = pointText(center - half_length - half_width);
  return "POLYGON ((" + first + ", " + pointText(center + half_length - half_width) + ", " +
         pointText(center + half_length + half_width) + ", " + pointText(center - half_length + half_width) + ", " +
         first + "))";
}

void addGeometry(rdf::TermId object, const std::string& object_iri, const ObjectGeometry& geometry, FactSink& facts) {
  const std::string geo(rdf::vocabulary::kGeo);
  const auto add = [&](const char* suffix, const char* property, const std::string& wkt) {
    const rdf::TermId node = facts.iri(object_iri + suffix);
    facts.link(object, geo + property, node);
    facts.type(node, geo + "Geometry");
    facts.literal(node, geo + "asWKT", wkt, geo + "wktLiteral");
  };
  add("/centroid", "hasCentroid", "POINT (" + pointText(geometry.centroid.head<2>()) + ")");
  add("/box", "hasBoundingBox", boxWkt(geometry.box));
}

void addExtent(rdf::TermId subject, const ObjectGeometry& geometry, FactSink& facts) {
  addPosition(subject, geometry.centroid, facts);
  addBounds(subject, geometry.min, geometry.max, facts);
  facts.number(subject, "height", geometry.box.size.z());
  facts.number(subject, "length", geometry.box.size.x());
  facts.number(subject, "width", geometry.box.size.y());
  facts.number(subject, "bottom", geometry.bottom_m);
  facts.number(subject, "top", geometry.top_m);
  facts.count(subject, "pointCount", geometry.point_count);
}

/// All that the facts of an object follow from, but for those about its neighbours.
struct ObjectView {
  struct Seen {
    scan::ScanId scan;
    std::optional<double> time_s;
    Sighting sighting;
  };

  const perception::Scene& scene;
  const rules::SemanticObject& object;
  ObjectGeometry geometry;
  std::vector<std::optional<ObjectGeometry>> part_geometry;  ///< absent where a part is no resource of its own
  std::vector<Seen> seen = {};
  std::optional<perception::Presence> presence = std::nullopt;
  std::optional<perception::RayCounts> passed_rays = std::nullopt;
};

class CauseHasher {
 public:
  ContentHash hashOf(const ObjectView& view) {
    hasher_.addText(view.object.class_iri).add(view.object.confidence).addText(view.object.rule_id);
    add(view.geometry);
    for (std::size_t i = 0; i < view.object.parts.size(); ++i) addPart(view, i);
    hasher_.add(view.seen.size());
    for (const ObjectView::Seen& seen : view.seen) {
      hasher_.add(seen.scan).add(seen.sighting.point_count);
      add(seen.sighting.sum);
      add(seen.time_s);
    }
    addRays(view);
    return hasher_.finish();
  }

 private:
  void add(const Eigen::Vector3d& place) { hasher_.addBytes(place.data(), 3 * sizeof(double)); }
  void add(std::optional<double> value) { hasher_.add(value.has_value()).add(value.value_or(0)); }
  void add(const ObjectGeometry& geometry) {
    for (const Eigen::Vector3d* v :
         {&geometry.box.center, &geometry.box.size, &geometry.min, &geometry.max, &geometry.centroid})
      add(*v);
    hasher_.add(geometry.box.yaw_rad).add(geometry.bottom_m).add(geometry.top_m).add(geometry.point_count);
  }
  void addPart(const ObjectView& view, std::size_t number) {
    const rules::ObjectPart& part = view.object.parts[number];
    hasher_.addText(part.part_class).add(part.primitives.size());
    for (const perception::PrimitiveIndex primitive : part.primitives) hasher_.add(view.scene.primitives[primitive].id);
    hasher_.add(view.part_geometry[number].has_value());
    if (view.part_geometry[number]) add(*view.part_geometry[number]);
  }
  void addRays(const ObjectView& view) {
    hasher_.add(view.presence.has_value()).add(view.passed_rays.has_value());
    if (view.presence) {
      hasher_.add(view.presence->first_seen_s).add(view.presence->last_seen_s);
      add(view.presence->seen_empty_s);
      add(view.presence->seen_through_s);
    }
    if (view.passed_rays) hasher_.add(view.passed_rays->ended).add(view.passed_rays->passed);
  }

  ContentHasher hasher_;
};

void addPart(const ObjectView& view, std::size_t number, rdf::TermId owner, FactSink& facts) {
  const rules::ObjectPart& part = view.object.parts[number];
  for (const perception::PrimitiveIndex primitive : part.primitives)
    facts.link(owner, "hasPrimitive", facts.iri(rdf::iriOfPrimitive(view.scene.primitives[primitive].id)));
  if (!view.part_geometry[number]) return;
  const ContentHash id = ContentHasher().add(view.object.id).addText(part.part_class).finish();
  const rdf::TermId subject = facts.iri(rdf::iriOfPart(id));
  facts.link(owner, "hasPart", subject);
  facts.link(subject, "partOf", owner);
  facts.type(subject, part.part_class);
  addExtent(subject, *view.part_geometry[number], facts);
  for (const perception::PrimitiveIndex primitive : part.primitives)
    facts.link(subject, "hasPrimitive", facts.iri(rdf::iriOfPrimitive(view.scene.primitives[primitive].id)));
}

void addTime(rdf::TermId subject, const std::string& property, double time_s, FactSink& facts) {
  facts.literal(subject, property, dateTimeText(time_s), rdf::vocabulary::xsd("dateTime"));
}

/// One object as seen in one cloud: where, when, how much.
void addObservation(const ObjectView& view, const ObjectView::Seen& seen, rdf::TermId object, FactSink& facts) {
  const std::string sosa(rdf::vocabulary::kSosa);
  const ContentHash id = ContentHasher().add(view.object.id).add(seen.scan).finish();
  const rdf::TermId subject = facts.iri(rdf::iriOfObservation(id));
  facts.type(subject, rdf::vocabulary::clx("Observation"));
  facts.link(subject, sosa + "hasFeatureOfInterest", object);
  facts.link(subject, "inCloud", facts.iri(rdf::iriOfCloud(seen.scan)));
  facts.count(subject, "pointCount", seen.sighting.point_count);
  addPosition(subject, seen.sighting.sum / static_cast<double>(seen.sighting.point_count), facts);
  if (seen.time_s) addTime(subject, sosa + "resultTime", *seen.time_s, facts);
}

/// When rays first and last ended at an object, and when others saw through its place.
void addPresence(const perception::Presence& presence, rdf::TermId subject, FactSink& facts) {
  addTime(subject, "firstSeen", presence.first_seen_s, facts);
  addTime(subject, "lastSeen", presence.last_seen_s, facts);
  if (presence.seen_empty_s) addTime(subject, "seenEmpty", *presence.seen_empty_s, facts);
  if (presence.seen_through_s) addTime(subject, "seenThrough", *presence.seen_through_s, facts);
}

/// The share of rays that went through an object.
void addPassedRays(const perception::RayCounts& rays, rdf::TermId subject, FactSink& facts) {
  const auto& [ended, passed] = rays;
  facts.number(subject, "porosity", static_cast<double>(passed) / static_cast<double>(ended + passed));
  facts.count(subject, "rayCount", ended + passed);
}

void addObject(const ObjectView& view, FactSink& facts) {
  const rules::SemanticObject& object = view.object;
  if (!facts.beginUnit({object.id, Facet::Self}, CauseHasher().hashOf(view))) return;
  const std::string iri = rdf::iriOfObject(object.id);
  const rdf::TermId subject = facts.iri(iri);
  facts.type(subject, object.class_iri);
  facts.number(subject, "confidence", object.confidence);
  facts.text(subject, "rule", object.rule_id);
  addExtent(subject, view.geometry, facts);
  facts.number(subject, "heading", view.geometry.box.yaw_rad);
  addGeometry(subject, iri, view.geometry, facts);
  for (std::size_t i = 0; i < object.parts.size(); ++i) addPart(view, i, subject, facts);
  for (const ObjectView::Seen& seen : view.seen) addObservation(view, seen, subject, facts);
  facts.count(subject, "viewCount", view.seen.size());
  addRayFacts(subject, view.presence, view.passed_rays, facts);
  facts.endUnit();
}

/// Apart from the object's own facts, which then do not follow from the names of its neighbours.
void addNear(const rules::SemanticObject& object, std::vector<ContentHash> near, FactSink& facts) {
  const FactUnitKey key{object.id, Facet::Relations};
  if (near.empty()) return facts.removeUnit(key);
  std::sort(near.begin(), near.end());
  if (!facts.beginUnit(key, ContentHasher().addSpan(std::span<const ContentHash>(near)).finish())) return;
  const rdf::TermId subject = facts.iri(rdf::iriOfObject(object.id));
  for (const ContentHash& other : near) facts.link(subject, "near", facts.iri(rdf::iriOfObject(other)));
  facts.endUnit();
}

/// Of a class-wide object the parts that `wide` has.
std::vector<const WidePart*> widePartsOf(const ContentHash& object, const std::vector<WidePart>& wide) {
  std::vector<const WidePart*> parts;
  for (const WidePart& part : wide)
    if (part.object == object) parts.push_back(&part);
  return parts;
}

ObjectView wideViewOf(const ObservedMap& map, const rules::SemanticObject& object) {
  WidePart whole;
  std::map<std::string, ObjectGeometry> geometry;
  for (const WidePart* part : widePartsOf(object.id, map.wide)) {
    whole.add(*part);
    geometry.emplace(part->part_class, geometryOf(part->sums));
  }
  ObjectView view{map.scene, object, geometryOf(std::move(whole.sums)), {}};
  for (const rules::ObjectPart& part : object.parts) {
    const auto own = geometry.find(part.part_class);
    const bool is_resource = part.part_class != object.class_iri && own != geometry.end();
    view.part_geometry.push_back(is_resource ? std::optional(own->second) : std::nullopt);
  }
  for (const auto& [scan, sighting] : whole.seen) view.seen.push_back({scan, std::nullopt, sighting});
  return view;
}

ObjectView viewOf(const ObservedMap& map, const rules::SemanticObject& object) {
  if (object.is_class_wide) return wideViewOf(map, object);
  const perception::SceneCluxels& cluxels = map.scene.cluxels;
  ObjectView view{map.scene, object, geometryOf(cluxels, cluxelsOf(object)), {}};
  for (const rules::ObjectPart& part : object.parts) {
    const bool is_resource = part.part_class != object.class_iri && !part.cluxels.empty();
    view.part_geometry.push_back(is_resource ? std::optional(geometryOf(cluxels, part.cluxels)) : std::nullopt);
  }
  return view;
}

void addSightings(const ObservedMap& map, std::vector<ObjectView>& views) {
  std::map<scan::ScanId, std::optional<double>> times;
  for (const Cloud& cloud : map.clouds) times.emplace(cloud.id, cloud.time_s);
  for (const auto& [pair, sighting] : map.sightings)
    if (!views[pair.first].object.is_class_wide) views[pair.first].seen.push_back({pair.second, {}, sighting});
  for (ObjectView& view : views)
    for (ObjectView::Seen& seen : view.seen)
      if (const auto time = times.find(seen.scan); time != times.end()) seen.time_s = time->second;
}

}  // namespace

void addRayFacts(rdf::TermId subject, const std::optional<perception::Presence>& presence,
                 const std::optional<perception::RayCounts>& passed_rays, FactSink& facts) {
  if (presence) addPresence(*presence, subject, facts);
  if (passed_rays) addPassedRays(*passed_rays, subject, facts);
}

void replaceRayFacts(rdf::TermId subject, const std::optional<perception::Presence>& presence,
                     const std::optional<perception::RayCounts>& passed_rays, FactPatch& patch, FactSink& facts) {
  for (const std::string_view property : kRayProperties) patch.replace(subject, facts.property(property));
  addRayFacts(subject, presence, passed_rays, facts);
}

void addPosition(rdf::TermId subject, const Eigen::Vector3d& p_map, FactSink& facts) {
  facts.number(subject, "x", p_map.x());
  facts.number(subject, "y", p_map.y());
  facts.number(subject, "z", p_map.z());
}

void addBounds(rdf::TermId subject, const Eigen::Vector3d& min, const Eigen::Vector3d& max, FactSink& facts) {
  facts.number(subject, "minX", min.x()), facts.number(subject, "maxX", max.x());
  facts.number(subject, "minY", min.y()), facts.number(subject, "maxY", max.y());
  facts.number(subject, "minZ", min.z()), facts.number(subject, "maxZ", max.z());
}

void addObjectFacts(const ObservedMap& map, FactSink& facts) {
  const std::vector<rules::SemanticObject>& objects = map.reasoning.objects;
  std::vector<std::optional<ObjectView>> found(objects.size());
  parallelFor(objects.size(), map.threads, [&](std::size_t i) { found[i].emplace(viewOf(map, objects[i])); });
  std::vector<ObjectView> views;
  views.reserve(objects.size());
  for (std::optional<ObjectView>& view : found) views.push_back(*std::move(view));
  addSightings(map, views);
  const std::vector<std::size_t> by_place = objectsByPlace(map.scene, objects);
  if (!map.near.empty())
    for (const std::size_t i : by_place) addNear(objects[i], map.near[i], facts);
  for (std::size_t i = 0; i < map.presence.size(); ++i) views[i].presence = map.presence[i];
  for (std::size_t i = 0; i < map.passed_rays.size(); ++i) views[i].passed_rays = map.passed_rays[i];
  for (const std::size_t i : by_place) addObject(views[i], facts);
}

}  // namespace cluxel::mapping
