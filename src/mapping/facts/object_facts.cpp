// SPDX-License-Identifier: Apache-2.0
// Facts about objects: plain numbers, and GeoSPARQL, SOSA and PROV terms.
#include "mapping/facts/object_facts.hpp"

#include <cmath>
#include <optional>

#include "base/utc_time.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {

namespace {

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

void addPart(const ObservedMap& map, const rules::SemanticObject& object, const rules::ObjectPart& part,
             rdf::TermId owner, FactSink& facts) {
  for (const perception::PrimitiveIndex primitive : part.primitives)
    facts.link(owner, "hasPrimitive", facts.iri(rdf::iriOfPrimitive(map.scene.primitives[primitive].id)));
  if (part.part_class == object.class_iri || part.cluxels.empty()) return;
  const ContentHash id = ContentHasher().add(object.id).addText(part.part_class).finish();
  const rdf::TermId subject = facts.iri(rdf::iriOfPart(id));
  facts.link(owner, "hasPart", subject);
  facts.link(subject, "partOf", owner);
  facts.type(subject, part.part_class);
  addExtent(subject, geometryOf(map.scene.cluxels, part.cluxels), facts);
  for (const perception::PrimitiveIndex primitive : part.primitives)
    facts.link(subject, "hasPrimitive", facts.iri(rdf::iriOfPrimitive(map.scene.primitives[primitive].id)));
}

void addObject(const ObservedMap& map, const rules::SemanticObject& object, FactSink& facts) {
  const std::string iri = rdf::iriOfObject(object.id);
  const rdf::TermId subject = facts.iri(iri);
  const ObjectGeometry geometry = geometryOf(map.scene.cluxels, cluxelsOf(object));
  facts.type(subject, object.class_iri);
  facts.number(subject, "confidence", object.confidence);
  facts.text(subject, "rule", object.rule_id);
  addExtent(subject, geometry, facts);
  facts.number(subject, "heading", geometry.box.yaw_rad);
  addGeometry(subject, iri, geometry, facts);
  for (const rules::ObjectPart& part : object.parts) addPart(map, object, part, subject, facts);
}

const Cloud* cloudOf(const std::vector<Cloud>& clouds, const scan::ScanId& id) {
  for (const Cloud& cloud : clouds)
    if (cloud.id == id) return &cloud;
  return nullptr;
}

void addTime(rdf::TermId subject, const std::string& property, double time_s, FactSink& facts) {
  facts.literal(subject, property, dateTimeText(time_s), rdf::vocabulary::xsd("dateTime"));
}

/// One object as seen in one cloud: where, when, how much.
void addObservation(const ObservedMap& map, std::uint32_t object, const scan::ScanId& scan, const Sighting& sighting,
                    FactSink& facts) {
  const std::string sosa(rdf::vocabulary::kSosa);
  const ContentHash& object_id = map.reasoning.objects[object].id;
  const ContentHash id = ContentHasher().add(object_id).add(scan).finish();
  const rdf::TermId subject = facts.iri(rdf::iriOfObservation(id));
  facts.type(subject, rdf::vocabulary::clx("Observation"));
  facts.link(subject, sosa + "hasFeatureOfInterest", facts.iri(rdf::iriOfObject(object_id)));
  facts.link(subject, "inCloud", facts.iri(rdf::iriOfCloud(scan)));
  facts.count(subject, "pointCount", sighting.point_count);
  addPosition(subject, sighting.sum / static_cast<double>(sighting.point_count), facts);
  const Cloud* cloud = cloudOf(map.clouds, scan);
  if (cloud != nullptr && cloud->time_s) addTime(subject, sosa + "resultTime", *cloud->time_s, facts);
}

void addObservations(const ObservedMap& map, FactSink& facts) {
  std::vector<std::uint64_t> views(map.reasoning.objects.size(), 0);
  for (const auto& [pair, sighting] : map.sightings) {
    ++views[pair.first];
    addObservation(map, pair.first, pair.second, sighting, facts);
  }
  for (std::size_t i = 0; i < views.size(); ++i)
    facts.count(facts.iri(rdf::iriOfObject(map.reasoning.objects[i].id)), "viewCount", views[i]);
}

/// When rays first and last ended at an object, and when others saw through its place.
void addPresence(const ObservedMap& map, FactSink& facts) {
  for (std::size_t i = 0; i < map.presence.size(); ++i) {
    if (!map.presence[i]) continue;
    const perception::Presence& presence = *map.presence[i];
    const rdf::TermId subject = facts.iri(rdf::iriOfObject(map.reasoning.objects[i].id));
    addTime(subject, "firstSeen", presence.first_seen_s, facts);
    addTime(subject, "lastSeen", presence.last_seen_s, facts);
    if (presence.seen_empty_s) addTime(subject, "seenEmpty", *presence.seen_empty_s, facts);
    if (presence.seen_through_s) addTime(subject, "seenThrough", *presence.seen_through_s, facts);
  }
}

/// The share of rays that went through an object.
void addPassedRays(const ObservedMap& map, FactSink& facts) {
  for (std::size_t i = 0; i < map.passed_rays.size(); ++i) {
    if (!map.passed_rays[i]) continue;
    const auto& [ended, passed] = *map.passed_rays[i];
    const rdf::TermId subject = facts.iri(rdf::iriOfObject(map.reasoning.objects[i].id));
    facts.number(subject, "porosity", static_cast<double>(passed) / static_cast<double>(ended + passed));
    facts.count(subject, "rayCount", ended + passed);
  }
}

void addNeighbours(const ObservedMap& map, FactSink& facts) {
  const auto& objects = map.reasoning.objects;
  std::vector<bool> is_ground;
  is_ground.reserve(objects.size());
  for (const rules::SemanticObject& object : objects)
    is_ground.push_back(object.class_iri == rdf::vocabulary::clx("Ground"));
  const auto object_of = objectOfCluxel(map.reasoning, map.scene.cluxels.size());
  for (const auto& [a, b] : nearObjects(map.scene.cluxels, object_of, is_ground, kNearObjects_m)) {
    const rdf::TermId first = facts.iri(rdf::iriOfObject(objects[a].id)),
                      second = facts.iri(rdf::iriOfObject(objects[b].id));
    facts.link(first, "near", second);
    facts.link(second, "near", first);
  }
}

}  // namespace

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
  for (const rules::SemanticObject& object : map.reasoning.objects) addObject(map, object, facts);
  addObservations(map, facts);
  addPresence(map, facts);
  addPassedRays(map, facts);
  addNeighbours(map, facts);
}

}  // namespace cluxel::mapping
