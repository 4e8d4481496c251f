// SPDX-License-Identifier: Apache-2.0
// Coordinates are written with millimetres, as those of objects.
#include "mapping/facts/way_facts.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <unordered_map>
#include <unordered_set>

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

std::string_view textOf(WayKind kind) {
  switch (kind) {
    case WayKind::Region:
      return "region";
    case WayKind::Junction:
      return "junction";
    case WayKind::Way:
      return "way";
    case WayKind::Kerb:
      return "kerb";
  }
  throw std::logic_error("unknown kind of ways");
}

/// The name of a resource: a hash of its kind and of where it lies.
ContentHash nameOf(WayKind kind, const std::string& where) {
  return ContentHasher().addText(textOf(kind)).addText(where).finish();
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
  const auto link = [&](std::string_view property, WayKind kind, const std::string& where) {
    facts.link(subject, property, facts.iri(rdf::mapIri(textOf(kind), nameOf(kind, where).hex())));
  };
  if (way.region != kNoPlace) link("inRegion", WayKind::Region, regionPlace(graph.regions[way.region]));
  for (const std::size_t junction : way.junctions)
    link("connects", WayKind::Junction, junctionPlace(graph.junctions[junction]));
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

/// Adds the facts of what has another cause than before, or shares its name with something that has. Two resources can
/// lie at the same place, as lines do around a small thing: then they have one name and are one unit of facts.
class WayTelling {
 public:
  WayTelling(const WayGraph& graph, FactSink& facts) : graph_(graph), facts_(facts) {}

  ToldWays run(const std::vector<ToldWay>& before) {
    collect(WayKind::Region, graph_.regions);
    collect(WayKind::Junction, graph_.junctions);
    collect(WayKind::Way, graph_.ways);
    collect(WayKind::Kerb, graph_.kerbs);
    findNames(before);
    tell();
    std::sort(told_.now.begin(), told_.now.end());
    return std::move(told_);
  }

 private:
  using Name = std::pair<WayKind, ContentHash>;

  template <typename Resource>
  void collect(WayKind kind, const std::vector<Resource>& resources) {
    for (std::size_t i = 0; i < resources.size(); ++i) {
      ContentHasher cause;
      cause.add(kind);
      addCause(resources[i], graph_, cause);
      told_.now.push_back({cause.finish(), {}, kind});
      numbers_.push_back(i);
    }
  }

  void findNames(const std::vector<ToldWay>& before) {
    std::unordered_map<ContentHash, ContentHash> known;  // names by cause
    for (const ToldWay& way : before) known.emplace(way.cause, way.name);
    std::unordered_set<ContentHash> causes;
    for (std::size_t i = 0; i < told_.now.size(); ++i) {
      ToldWay& way = told_.now[i];
      causes.insert(way.cause);
      const auto found = known.find(way.cause);
      way.name = found != known.end() ? found->second : nameOf(way.kind, placeOf(way.kind, numbers_[i]));
      if (found == known.end()) told_.exchanged.emplace(way.kind, way.name);
    }
    for (const ToldWay& way : before)
      if (!causes.contains(way.cause)) told_.exchanged.emplace(way.kind, way.name);
  }

  std::string placeOf(WayKind kind, std::size_t number) const {
    switch (kind) {
      case WayKind::Region:
        return regionPlace(graph_.regions[number]);
      case WayKind::Junction:
        return junctionPlace(graph_.junctions[number]);
      case WayKind::Way:
        return lineText(graph_.ways[number].line);
      case WayKind::Kerb:
        return lineText(graph_.kerbs[number].line);
    }
    throw std::logic_error("unknown kind of ways");
  }

  void tell() {
    std::map<Name, std::vector<std::size_t>> of_name;
    for (std::size_t i = 0; i < told_.now.size(); ++i)
      if (const Name name{told_.now[i].kind, told_.now[i].name}; told_.exchanged.contains(name))
        of_name[name].push_back(i);
    for (const auto& [name, members] : of_name) {
      ContentHasher cause;
      for (const std::size_t i : members) cause.add(told_.now[i].cause);
      if (!facts_.beginUnit({name.second, Facet::Self}, cause.finish())) continue;
      for (const std::size_t i : members) add(name.first, numbers_[i], iriOfWay(name.first, name.second));
      facts_.endUnit();
    }
  }

  void add(WayKind kind, std::size_t number, const std::string& iri) {
    switch (kind) {
      case WayKind::Region:
        return addRegion(graph_.regions[number], iri, facts_);
      case WayKind::Junction:
        return addJunction(graph_.junctions[number], iri, facts_);
      case WayKind::Way:
        return addWay(graph_.ways[number], iri, graph_, facts_);
      case WayKind::Kerb:
        return addKerb(graph_.kerbs[number], iri, facts_);
    }
  }

  const WayGraph& graph_;
  FactSink& facts_;
  ToldWays told_;
  std::vector<std::size_t> numbers_;  ///< of those in `told_.now`, in the lists of the graph
};

}  // namespace

std::string iriOfWay(WayKind kind, const ContentHash& name) {
  return rdf::mapIri(textOf(kind), name.hex());
}

std::string iriOfWays(WayKind kind) {
  return rdf::mapIri(textOf(kind), "");
}

ToldWays addWayFacts(const WayGraph& graph, const std::vector<ToldWay>& before, FactSink& facts) {
  return WayTelling(graph, facts).run(before);
}

}  // namespace cluxel::mapping
