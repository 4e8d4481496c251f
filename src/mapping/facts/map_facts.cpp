// SPDX-License-Identifier: Apache-2.0
// Facts about clouds, primitives and relations; object_facts.cpp adds those about objects.
#include "mapping/facts/map_facts.hpp"

#include <cmath>

#include "base/utc_time.hpp"
#include "mapping/facts/object_facts.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {

namespace {

void addMap(const ObservedMap& map, FactSink& facts) {
  const rdf::TermId root = facts.iri(rdf::iriOfMapRoot());
  facts.type(root, rdf::vocabulary::clx("Map"));
  facts.text(root, "frame", "map");
  if (!map.inputs.crs.empty()) facts.text(root, "crs", map.inputs.crs);
  if (!map.inputs.map_origin.isZero()) {
    facts.number(root, "originX", map.inputs.map_origin.x());
    facts.number(root, "originY", map.inputs.map_origin.y());
    facts.number(root, "originZ", map.inputs.map_origin.z());
  }
  for (const Cloud& cloud : map.clouds) facts.link(root, "hasCloud", facts.iri(rdf::iriOfCloud(cloud.id)));
}

void addCloud(const Cloud& cloud, FactSink& facts) {
  const rdf::TermId subject = facts.iri(rdf::iriOfCloud(cloud.id));
  facts.type(subject, rdf::vocabulary::clx("Cloud"));
  facts.count(subject, "pointCount", cloud.point_count);
  addBounds(subject, cloud.min, cloud.max, facts);
  if (cloud.has_pose) addPosition(subject, cloud.T_map_sensor.translation(), facts);
  if (cloud.time_s)
    facts.literal(subject, std::string(rdf::vocabulary::kSosa) + "resultTime", dateTimeText(*cloud.time_s),
                  rdf::vocabulary::xsd("dateTime"));
}

/// "horizontal_plane" → "HorizontalPlane".
std::string className(scan::PrimitiveLabel label) {
  std::string name;
  bool upper = true;
  for (const char c : nameOf(label)) {
    if (c != '_') name += upper ? static_cast<char>(c - 'a' + 'A') : c;
    upper = c == '_';
  }
  return name;
}

void addPrimitive(const perception::Primitive& primitive, FactSink& facts) {
  const rdf::TermId subject = facts.iri(rdf::iriOfPrimitive(primitive.id));
  facts.type(subject, rdf::vocabulary::clx(className(primitive.label)));
  addPosition(subject, primitive.centroid, facts);
  addBounds(subject, primitive.min, primitive.max, facts);
  for (const perception::AttributeInfo& info : perception::attributeInfos()) {
    const double value = primitive[info.attribute];
    if (info.dimension == perception::Dimension::Count)
      facts.count(subject, info.property, static_cast<std::uint64_t>(value));
    else
      facts.number(subject, info.property, value);
  }
}

/// One ground patch per tile, so that relations to the ground stay local when a distant scan is added.
rdf::TermId groundPatchUnder(const perception::Primitive& primitive, FactSink& facts) {
  const perception::TileKey tile = perception::tileOf(primitive.centroid);
  const rdf::TermId patch = facts.iri(rdf::iriOfGroundPatch(tile.x, tile.y));
  facts.type(patch, rdf::vocabulary::clx("GroundPatch"));
  return patch;
}

void addRelations(const perception::Scene& scene, FactSink& facts) {
  for (const perception::Relation& relation : scene.relations) {
    const rdf::TermId from = facts.iri(rdf::iriOfPrimitive(scene.primitives[relation.from].id));
    const std::string_view property = perception::relationInfos()[static_cast<std::size_t>(relation.kind)].property;
    if (relation.kind != perception::RelationKind::TouchesGround)
      facts.link(from, property, facts.iri(rdf::iriOfPrimitive(scene.primitives[relation.to].id)));
    else if (relation.measure <= kTouchesGround_m)
      facts.link(from, property, groundPatchUnder(scene.primitives[relation.from], facts));
  }
}

}  // namespace

void addObservedFacts(const ObservedMap& map, FactSink& facts) {
  addMap(map, facts);
  for (const Cloud& cloud : map.clouds) addCloud(cloud, facts);
  for (const perception::Primitive& primitive : map.scene.primitives) addPrimitive(primitive, facts);
  addRelations(map.scene, facts);
  addObjectFacts(map, facts);
}

}  // namespace cluxel::mapping
