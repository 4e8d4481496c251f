// SPDX-License-Identifier: Apache-2.0
// Coordinates are written with millimetres, as those of objects.
#include "mapping/facts/way_facts.hpp"

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

std::string iriOf(std::string_view kind, const std::string& where) {
  return rdf::mapIri(kind, ContentHasher().addText(kind).addText(where).finish().hex());
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

void addKerb(const Kerb& kerb, FactSink& facts) {
  const std::string iri = iriOf("kerb", lineText(kerb.line));
  const rdf::TermId subject = facts.iri(iri);
  facts.type(subject, rdf::vocabulary::clx("Kerb"));
  facts.number(subject, "length", kerb.length_m);
  facts.number(subject, "height", kerb.rise_m);
  addLine(subject, iri, kerb.line, facts);
}

void addWay(const Way& way, const std::vector<rdf::TermId>& junctions, const std::vector<rdf::TermId>& regions,
            FactSink& facts) {
  const std::string line = lineText(way.line), iri = iriOf("way", line);
  const rdf::TermId subject = facts.iri(iri);
  facts.type(subject, rdf::vocabulary::clx("Way"));
  facts.number(subject, "length", way.length_m);
  facts.number(subject, "width", way.median_width_m);
  facts.number(subject, "leastWidth", way.least_width_m);
  facts.number(subject, "slope", way.steepest);
  facts.number(subject, "lowerBeside", way.lower_beside);
  facts.number(subject, "higherBeside", way.higher_beside);
  addLine(subject, iri, way.line, facts);
  if (way.region != kNoPlace) facts.link(subject, "inRegion", regions[way.region]);
  for (const std::size_t junction : way.junctions) facts.link(subject, "connects", junctions[junction]);
}

}  // namespace

void addWayFacts(const WayGraph& graph, FactSink& facts) {
  std::vector<rdf::TermId> junctions, regions;
  for (const Region& region : graph.regions) {
    const std::string iri = iriOf("region", placeText(region.first_centre.x(), region.first_centre.y()));
    const rdf::TermId subject = regions.emplace_back(facts.iri(iri));
    facts.type(subject, rdf::vocabulary::clx("Region"));
    facts.number(subject, "area", region.area_m2);
    addShape(subject, iri, "hasBoundingBox", boxText(region), facts);
  }
  for (const Junction& junction : graph.junctions) {
    const std::string place = placeText(junction.place.x(), junction.place.y()), iri = iriOf("junction", place);
    const rdf::TermId subject = junctions.emplace_back(facts.iri(iri));
    facts.type(subject, rdf::vocabulary::clx("Junction"));
    addPosition(subject, junction.place, facts);
    addShape(subject, iri, "hasCentroid", "POINT (" + place + ")", facts);
  }
  for (const Way& way : graph.ways) addWay(way, junctions, regions, facts);
  for (const Kerb& kerb : graph.kerbs) addKerb(kerb, facts);
}

}  // namespace cluxel::mapping
