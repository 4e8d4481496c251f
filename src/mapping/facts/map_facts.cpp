// SPDX-License-Identifier: Apache-2.0
// Facts about clouds, primitives and relations; object_facts.cpp adds those about objects. Each primitive is a unit of
// facts, and its relations to others are another.
#include "mapping/facts/map_facts.hpp"

#include <cmath>
#include <optional>
#include <set>
#include <span>

#include "base/utc_time.hpp"
#include "mapping/clouds/ray_starts.hpp"
#include "mapping/facts/fact_order.hpp"
#include "mapping/facts/object_facts.hpp"
#include "mapping/origin_text.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {

namespace {

ContentHash causeOf(const Cloud& cloud) {
  const std::optional<Eigen::Vector3d> place = sensorPlaceOf(cloud);
  ContentHasher hasher;
  for (const Eigen::Vector3d* corner : {&cloud.min, &cloud.max}) hasher.addBytes(corner->data(), 3 * sizeof(double));
  hasher.add(cloud.point_count).add(place.has_value());
  if (place) hasher.add(place->x()).add(place->y()).add(place->z());
  return hasher.add(cloud.time_s.has_value()).add(cloud.time_s.value_or(0)).finish();
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

void addAttributes(const perception::Primitive& primitive, rdf::TermId subject, FactSink& facts) {
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

bool isToGround(const perception::Relation& relation) {
  return relation.kind == perception::RelationKind::TouchesGround;
}

/// One ground patch per tile, so that relations to the ground stay local when a distant scan is added.
std::string groundPatchUnder(const perception::Scene& scene, perception::PrimitiveIndex primitive) {
  const perception::TileKey tile = scene.cluxels.grid.tileOf(scene.primitives[primitive].centroid);
  return rdf::iriOfGroundPatch(tile.x, tile.y);
}

void addRelation(const perception::Scene& scene, const perception::Relation& relation, rdf::TermId from,
                 FactSink& facts) {
  const std::string_view property = perception::relationInfos()[static_cast<std::size_t>(relation.kind)].property;
  const std::string to = isToGround(relation) ? groundPatchUnder(scene, relation.from)
                                              : rdf::iriOfPrimitive(scene.primitives[relation.to].id);
  facts.link(from, property, facts.iri(to));
}

/// The hash of all that the facts of a primitive itself follow from.
ContentHash causeOf(const perception::Primitive& primitive) {
  ContentHasher hasher;
  hasher.add(primitive.label).addSpan(std::span<const double>(primitive.attributes));
  for (const Eigen::Vector3d* place : {&primitive.centroid, &primitive.min, &primitive.max})
    hasher.addBytes(place->data(), 3 * sizeof(double));
  return hasher.finish();
}

/// The relations of a primitive that are facts.
std::vector<perception::Relation> statedRelations(const perception::Scene& scene, perception::PrimitiveIndex number) {
  std::vector<perception::Relation> stated;
  for (const perception::Relation& relation : scene.relationsOf(number))
    if (!isToGround(relation) || relation.measure <= kTouchesGround_m) stated.push_back(relation);
  return stated;
}

/// The hash of all that the relations of a primitive follow from.
ContentHash causeOf(const perception::Scene& scene, const std::vector<perception::Relation>& relations) {
  ContentHasher hasher;
  for (const perception::Relation& relation : relations) {
    hasher.add(relation.kind);
    if (isToGround(relation))
      hasher.addText(groundPatchUnder(scene, relation.from));
    else
      hasher.add(scene.primitives[relation.to].id);
  }
  return hasher.finish();
}

void addRelations(const perception::Scene& scene, perception::PrimitiveIndex number, FactSink& facts) {
  const FactUnitKey key{scene.primitives[number].id, Facet::Relations};
  const std::vector<perception::Relation> relations = statedRelations(scene, number);
  if (relations.empty()) return facts.removeUnit(key);
  if (!facts.beginUnit(key, causeOf(scene, relations))) return;
  const rdf::TermId subject = facts.iri(rdf::iriOfPrimitive(key.id));
  for (const perception::Relation& relation : relations) addRelation(scene, relation, subject, facts);
  facts.endUnit();
}

/// Several primitives have the same patch, so that it is a unit of its own.
void addGroundPatches(const perception::Scene& scene, FactSink& facts) {
  std::set<std::string> patches;
  for (const perception::Relation& relation : scene.relations)
    if (isToGround(relation) && relation.measure <= kTouchesGround_m)
      patches.insert(groundPatchUnder(scene, relation.from));
  for (const std::string& patch : patches) {
    if (!facts.beginUnit(unitOfGroundPatch(patch), ContentHasher().addText("ground patch").finish())) continue;
    facts.type(facts.iri(patch), rdf::vocabulary::clx("GroundPatch"));
    facts.endUnit();
  }
}

}  // namespace

void addMap(const MapInputs& inputs, const std::vector<Cloud>& clouds, FactSink& facts) {
  const rdf::TermId root = facts.iri(rdf::iriOfMapRoot());
  facts.type(root, rdf::vocabulary::clx("Map"));
  facts.text(root, "frame", "map");
  if (!inputs.crs.empty()) facts.text(root, "crs", inputs.crs);
  if (!inputs.map_origin.isZero(0))
    for (const int axis : {0, 1, 2})
      facts.term(root, std::string("origin") + "XYZ"[axis],
                 Term::literal(exactDecimalText(inputs.map_origin[axis]), rdf::vocabulary::xsd("decimal")));
  for (const Cloud& cloud : clouds) facts.link(root, "hasCloud", facts.iri(rdf::iriOfCloud(cloud.id)));
}

void addCloud(const Cloud& cloud, FactSink& facts) {
  if (!facts.beginUnit({cloud.id, Facet::Self}, causeOf(cloud))) return;
  const rdf::TermId subject = facts.iri(rdf::iriOfCloud(cloud.id));
  facts.type(subject, rdf::vocabulary::clx("Cloud"));
  facts.count(subject, "pointCount", cloud.point_count);
  addBounds(subject, cloud.min, cloud.max, facts);
  if (const auto place = sensorPlaceOf(cloud)) addPosition(subject, *place, facts);
  if (cloud.time_s)
    facts.literal(subject, std::string(rdf::vocabulary::kSosa) + "resultTime", dateTimeText(*cloud.time_s),
                  rdf::vocabulary::xsd("dateTime"));
  facts.endUnit();
}

void addPrimitive(const perception::Scene& scene, perception::PrimitiveIndex number, FactSink& facts) {
  const perception::Primitive& primitive = scene.primitives[number];
  addRelations(scene, number, facts);
  if (!facts.beginUnit({primitive.id, Facet::Self}, causeOf(primitive))) return;
  addAttributes(primitive, facts.iri(rdf::iriOfPrimitive(primitive.id)), facts);
  facts.endUnit();
}

std::optional<std::string> touchedPatch(const perception::Scene& scene, perception::PrimitiveIndex number) {
  for (const perception::Relation& relation : statedRelations(scene, number))
    if (isToGround(relation)) return groundPatchUnder(scene, number);
  return std::nullopt;
}

FactUnitKey unitOfGroundPatch(std::string_view iri) {
  return {ContentHasher().addText(iri).finish(), Facet::Self};
}

void addSceneFacts(const MapInputs& inputs, const std::vector<Cloud>& clouds, const perception::Scene& scene,
                   FactSink& facts) {
  addMap(inputs, clouds, facts);
  for (const Cloud& cloud : clouds) addCloud(cloud, facts);
  for (const perception::PrimitiveIndex primitive : primitivesByPlace(scene)) addPrimitive(scene, primitive, facts);
  addGroundPatches(scene, facts);
}

}  // namespace cluxel::mapping
