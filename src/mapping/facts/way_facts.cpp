// SPDX-License-Identifier: Apache-2.0
// Coordinates are written with millimetres, as those of objects.
#include "mapping/facts/way_facts.hpp"

#include <map>

#include "mapping/facts/object_facts.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {

namespace {

std::string placeText(double x, double y) {
  return decimalText(x, 3) + " " + decimalText(y, 3);
}

std::string lineText(const std::vector<Eigen::Vector3d>& line) {
  std::string text = "LINESTRING (";
  for (const Eigen::Vector3d& p : line) text += (&p == line.data() ? "" : ", ") + placeText(p.x(), p.y());
  return text + ")";
}

std::string boxText(const Region& region) {
  const Eigen::Vector2d &a = region.min, &b = region.max;
  return "POLYGON ((" + placeText(a.x(), a.y()) + ", " + placeText(b.x(), a.y()) + ", " + placeText(b.x(), b.y()) +
         ", " + placeText(a.x(), b.y()) + ", " + placeText(a.x(), a.y()) + "))";
}

/// The name of a resource: a hash of its kind and of where it lies.
ContentHash nameOf(std::string_view kind, const std::string& where) {
  return ContentHasher().addText(kind).addText(where).finish();
}

std::string regionPlace(const Region& region) {
  return placeText(region.first_centre.x(), region.first_centre.y());
}

std::string junctionPlace(const Junction& junction) {
  return placeText(junction.place.x(), junction.place.y());
}

void addShape(rdf::TermId subject, const std::string& iri, std::string_view property, const std::string& wkt,
              FactSink& facts) {
  const std::string geo(rdf::vocabulary::kGeo);
  const rdf::TermId node = facts.iri(iri + "/shape");
  facts.link(subject, geo + std::string(property), node);
  facts.type(node, geo + "Geometry");
  facts.literal(node, geo + "asWKT", wkt, geo + "wktLiteral");
}

void addLine(rdf::TermId subject, const std::string& iri, const std::vector<Eigen::Vector3d>& line, FactSink& facts) {
  Eigen::Vector3d min = line.front(), max = min;
  for (const Eigen::Vector3d& p : line) min = min.cwiseMin(p), max = max.cwiseMax(p);
  addBounds(subject, min, max, facts);
  addPosition(subject, line[line.size() / 2], facts);
  addShape(subject, iri, "hasGeometry", lineText(line), facts);
}

void addRegion(const Region& region, const std::string& iri, FactSink& facts) {
  const rdf::TermId subject = facts.iri(iri);
  facts.type(subject, rdf::vocabulary::clx("Region"));
  facts.number(subject, "area", region.area_m2);
  addShape(subject, iri, "hasBoundingBox", boxText(region), facts);
}

void addJunction(const Junction& junction, const std::string& iri, FactSink& facts) {
  const rdf::TermId subject = facts.iri(iri);
  facts.type(subject, rdf::vocabulary::clx("Junction"));
  addPosition(subject, junction.place, facts);
  addShape(subject, iri, "hasCentroid", "POINT (" + junctionPlace(junction) + ")", facts);
}

void addKerb(const Kerb& kerb, const std::string& iri, FactSink& facts) {
  const rdf::TermId subject = facts.iri(iri);
  facts.type(subject, rdf::vocabulary::clx("Kerb"));
  facts.number(subject, "length", kerb.length_m);
  facts.number(subject, "height", kerb.rise_m);
  addLine(subject, iri, kerb.line, facts);
}

void addWay(const Way& way, const std::string& iri, const WayGraph& graph, FactSink& facts) {
  const rdf::TermId subject = facts.iri(iri);
  facts.type(subject, rdf::vocabulary::clx("Way"));
  facts.number(subject, "length", way.length_m);
  facts.number(subject, "width", way.median_width_m);
  facts.number(subject, "leastWidth", way.least_width_m);
  facts.number(subject, "slope", way.steepest);
  facts.number(subject, "lowerBeside", way.lower_beside);
  facts.number(subject, "higherBeside", way.higher_beside);
  addLine(subject, iri, way.line, facts);
  const auto link = [&](std::string_view property, std::string_view kind, const std::string& where) {
    facts.link(subject, property, facts.iri(rdf::mapIri(kind, nameOf(kind, where).hex())));
  };
  if (way.region != kNoPlace) link("inRegion", "region", regionPlace(graph.regions[way.region]));
  for (const std::size_t junction : way.junctions)
    link("connects", "junction", junctionPlace(graph.junctions[junction]));
}

void addPoint(const Eigen::Vector2d& point, ContentHasher& hasher) {
  hasher.add(point.x()).add(point.y());
}

void addPoint(const Eigen::Vector3d& point, ContentHasher& hasher) {
  hasher.add(point.x()).add(point.y()).add(point.z());
}

// What the facts of each resource follow from goes into a hash.

void addCause(const Region& region, const WayGraph&, ContentHasher& hasher) {
  addPoint(region.min, hasher), addPoint(region.max, hasher), addPoint(region.first_centre, hasher);
  hasher.add(region.area_m2);
}

void addCause(const Junction& junction, const WayGraph&, ContentHasher& hasher) {
  addPoint(junction.place, hasher);
}

void addCause(const Kerb& kerb, const WayGraph&, ContentHasher& hasher) {
  hasher.add(kerb.length_m).add(kerb.rise_m);
  for (const Eigen::Vector3d& point : kerb.line) addPoint(point, hasher);
}

void addCause(const Way& way, const WayGraph& graph, ContentHasher& hasher) {
  for (const double value : {way.length_m, way.median_width_m, way.least_width_m, way.steepest, way.lower_beside,
                             way.higher_beside, static_cast<double>(way.line.size())})
    hasher.add(value);
  for (const Eigen::Vector3d& point : way.line) addPoint(point, hasher);
  hasher.add(way.region == kNoPlace);
  if (way.region != kNoPlace) addPoint(graph.regions[way.region].first_centre, hasher);
  for (const std::size_t junction : way.junctions) addPoint(graph.junctions[junction].place, hasher);
}

/// The facts of some resources of a kind, each a unit. Two of them can lie at the same place, as lines do around a
/// small thing: then they have one name and are one unit.
template <typename Resource, typename Where, typename Add>
void addUnits(std::string_view kind, const std::vector<Resource>& resources, const WayGraph& graph, FactSink& facts,
              const Where& where, const Add& add) {
  std::map<ContentHash, std::vector<const Resource*>> by_name;
  for (const Resource& resource : resources) by_name[nameOf(kind, where(resource))].push_back(&resource);
  for (const auto& [name, of_name] : by_name) {
    ContentHasher cause;
    for (const Resource* resource : of_name) addCause(*resource, graph, cause);
    if (!facts.beginUnit({name, Facet::Self}, cause.finish())) continue;
    for (const Resource* resource : of_name) add(*resource, rdf::mapIri(kind, name.hex()));
    facts.endUnit();
  }
}

}  // namespace

void addWayFacts(const WayGraph& graph, FactSink& facts) {
  const auto line_of = [](const auto& resource) { return lineText(resource.line); };
  addUnits("region", graph.regions, graph, facts, regionPlace,
           [&](const Region& region, const std::string& iri) { addRegion(region, iri, facts); });
  addUnits("junction", graph.junctions, graph, facts, junctionPlace,
           [&](const Junction& junction, const std::string& iri) { addJunction(junction, iri, facts); });
  addUnits("way", graph.ways, graph, facts, line_of,
           [&](const Way& way, const std::string& iri) { addWay(way, iri, graph, facts); });
  addUnits("kerb", graph.kerbs, graph, facts, line_of,
           [&](const Kerb& kerb, const std::string& iri) { addKerb(kerb, iri, facts); });
}

}  // namespace cluxel::mapping
