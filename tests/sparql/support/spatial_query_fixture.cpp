// SPDX-License-Identifier: Apache-2.0
// Makes spatial queries and finds their answers by comparing all with all.
#include "sparql/support/spatial_query_fixture.hpp"

#include <algorithm>
#include <limits>

namespace cluxel::test {
namespace {

/// The rows of a query with DISTINCT.
std::vector<std::string> distinct(std::vector<std::string> rows) {
  std::sort(rows.begin(), rows.end());
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  return rows;
}

}  // namespace

std::string SpatialQueryMaker::number(double value) const {
  std::string text = std::to_string(value);
  return text.substr(0, text.find('.') + 3);
}

std::string SpatialQueryMaker::literal(const Patch& patch) const {
  return "\"" + patch.wkt() + "\"^^geo:wktLiteral";
}

Patch SpatialQueryMaker::somewhere() {
  const double x = upTo(160) * 0.25, y = upTo(160) * 0.25;
  if (upTo(2) == 0) return {x, y, x, y};
  return {x, y, x + 0.25 * (1 + upTo(8)), y + 0.25 * (1 + upTo(8))};
}

std::string SpatialQueryMaker::shuffled(std::vector<std::string> parts) {
  std::shuffle(parts.begin(), parts.end(), random_);
  std::string text;
  for (const std::string& part : parts) text += part + " ";
  return text;
}

/// The patterns of ?name with its kind and its geometry ?gname.
std::vector<std::string> SpatialQueryMaker::thing(const std::string& name, int kind) {
  return {"?" + name + " :kind " + std::to_string(kind) + " .", "?" + name + " geo:asWKT ?g" + name + " ."};
}

std::string SpatialQueryMaker::within(const std::string& a, const std::string& b, double limit_m) {
  const std::string distance = "geof:distance(" + (upTo(2) == 0 ? a + ", " + b : b + ", " + a) + ")";
  switch (upTo(4)) {
    case 0:
      return distance + " <= " + number(limit_m);
    case 1:
      return number(limit_m) + " > " + distance;
    case 2:
      return distance + " - 1 < " + number(limit_m - 1);
    default:
      return distance + " < " + number(limit_m);
  }
}

std::vector<std::string> SpatialQueryMaker::pairs(int kind_a, int kind_b, const Pair& test) const {
  std::vector<std::string> rows;
  for (const Thing& a : town_.things) {
    for (const Thing& b : town_.things) {
      if (a.kind != kind_a || b.kind != kind_b) continue;
      for (const Patch& p : a.patches)
        for (const Patch& q : b.patches)
          if (test(a, p, b, q)) rows.push_back(a.name + " " + b.name);
    }
  }
  return distinct(std::move(rows));
}

double SpatialQueryMaker::nearestOf(const Patch& from, int kind, const std::string& but) const {
  double least = std::numeric_limits<double>::infinity();
  for (const Thing& thing : town_.things) {
    if (thing.kind != kind || thing.name == but) continue;
    for (const Patch& patch : thing.patches) least = std::min(least, from.distanceTo(patch));
  }
  return least;
}

SpatialQuery SpatialQueryMaker::pairWithin() {
  const double d = limit();
  const int i = upTo(3), k = upTo(3);
  std::vector<std::string> parts = thing("a", i);
  for (const std::string& part : thing("b", k)) parts.push_back(part);
  const bool others = upTo(2) == 0, by_bind = upTo(4) == 0;
  if (!by_bind) parts.push_back("FILTER(" + within("?ga", "?gb", d) + ")");
  if (others) parts.push_back("FILTER(?a != ?b)");
  std::string text = shuffled(parts);
  if (by_bind) text += "BIND(geof:distance(?ga, ?gb) AS ?d) FILTER(?d < " + number(d) + ")";
  return {"pair within", "SELECT DISTINCT ?a ?b { " + text + "}",
          pairs(i, k, [&](const Thing& a, const Patch& p, const Thing& b, const Patch& q) {
            return p.distanceTo(q) < d && (!others || a.name != b.name);
          })};
}

SpatialQuery SpatialQueryMaker::pairRelated() {
  const int i = upTo(3), k = upTo(3);
  std::vector<std::string> parts = thing("a", i);
  for (const std::string& part : thing("b", k)) parts.push_back(part);
  const std::string tests[] = {"geof:sfIntersects(?ga, ?gb)", "!geof:sfDisjoint(?gb, ?ga)",
                               "geof:distance(?ga, ?gb) = 0"};
  parts.push_back("FILTER(" + tests[upTo(3)] + ")");
  return {"pair related", "SELECT DISTINCT ?a ?b { " + shuffled(parts) + "}",
          pairs(i, k, [](const Thing&, const Patch& p, const Thing&, const Patch& q) { return p.meets(q); })};
}

SpatialQuery SpatialQueryMaker::boundThing() {
  const double d = limit();
  const Thing& centre = town_.things[static_cast<std::size_t>(upTo(static_cast<int>(town_.things.size())))];
  std::vector<std::string> parts = {centre.name + " geo:asWKT ?gc .", "?b geo:asWKT ?gb ."};
  parts.push_back("FILTER(" + within("?gc", "?gb", d) + ")");
  std::vector<std::string> rows;
  for (const Thing& b : town_.things)
    for (const Patch& p : centre.patches)
      for (const Patch& q : b.patches)
        if (p.distanceTo(q) < d) rows.push_back(b.name);
  return {"bound thing", "SELECT DISTINCT ?b { " + shuffled(parts) + "}", distinct(rows)};
}

SpatialQuery SpatialQueryMaker::placesOfValues() {
  const double d = limit();
  const Patch places[] = {somewhere(), somewhere(), somewhere()};
  const int k = upTo(3);
  std::vector<std::string> parts = thing("b", k);
  parts.push_back("VALUES ?p { " + literal(places[0]) + " " + literal(places[1]) + " " + literal(places[2]) + " }");
  parts.push_back("FILTER(" + within("?p", "?gb", d) + ")");
  std::vector<std::string> rows;
  for (const Thing& b : town_.things)
    for (const Patch& q : b.patches)
      for (const Patch& p : places)
        if (b.kind == k && p.distanceTo(q) < d) rows.push_back(b.name);
  return {"places of VALUES", "SELECT DISTINCT ?b { " + shuffled(parts) + "}", distinct(rows)};
}

SpatialQuery SpatialQueryMaker::oneOfPlaces() {
  const double d = limit(), e = limit();
  const Patch p = somewhere(), other = somewhere();
  const int k = upTo(3);
  std::vector<std::string> parts = thing("b", k);
  parts.push_back("FILTER(" + within("?gb", literal(p), d) + " || " + within("?gb", literal(other), e) + ")");
  std::vector<std::string> rows;
  for (const Thing& b : town_.things)
    for (const Patch& q : b.patches)
      if (b.kind == k && (p.distanceTo(q) < d || other.distanceTo(q) < e)) rows.push_back(b.name);
  return {"one of places", "SELECT DISTINCT ?b { " + shuffled(parts) + "}", distinct(rows)};
}

/// The distances of the first rows; the things of equal distances are compared with the plan without an index.
SpatialQuery SpatialQueryMaker::nearestFirst() {
  const Patch p = somewhere();
  const int k = upTo(3), limit = 1 + upTo(6), offset = upTo(2) * upTo(4);
  const std::string distance = "geof:distance(?gb, " + literal(p) + ")";
  const std::string tail = " LIMIT " + std::to_string(limit) + (offset > 0 ? " OFFSET " + std::to_string(offset) : "");
  const std::string patterns = shuffled(thing("b", k));
  const std::string texts[] = {
      "SELECT ?b { " + patterns + "} ORDER BY " + distance + tail,
      "SELECT ?b ?d { " + patterns + "BIND(" + distance + " AS ?d) } ORDER BY ?d" + tail,
      "SELECT ?b (" + distance + " AS ?d) { " + patterns + "} ORDER BY ?d ?b" + tail,
      "SELECT ?b (STR(?gb) AS ?t) { " + patterns + "} ORDER BY DESC(" + distance + ")" + tail,
      "SELECT ?b { " + patterns + "FILTER(?gb != " + literal(p) + ") } ORDER BY " + distance + tail,
      "SELECT ?b { " + patterns + town_.things[0].name + " geo:asWKT ?gc } ORDER BY geof:distance(?gc, ?gb)" + tail};
  return {"nearest first", texts[upTo(6)], {}, true};
}

SpatialQuery SpatialQueryMaker::nearestByAbsence() {
  const int i = upTo(3), k = upTo(3);
  const bool others = upTo(2) == 0;
  std::vector<std::string> parts = thing("a", i);
  for (const std::string& part : thing("b", k)) parts.push_back(part);
  std::vector<std::string> inner = {"?c :kind " + std::to_string(k) + " .", "?c geo:asWKT ?gc ."};
  const bool greater = upTo(2) == 0;
  const std::string near = "geof:distance(?ga, ?gc)", far = "geof:distance(?ga, ?gb)";
  inner.push_back("FILTER(" + (greater ? far + " > " + near : near + " < " + far) + ")");
  if (others) inner.push_back("FILTER(?c != ?b)");
  parts.push_back("FILTER NOT EXISTS { " + shuffled(inner) + "}");
  return {"nearest by absence", "SELECT DISTINCT ?a ?b { " + shuffled(parts) + "}",
          pairs(i, k, [&](const Thing&, const Patch& p, const Thing& b, const Patch& q) {
            return !(nearestOf(p, k, others ? b.name : "") < p.distanceTo(q));
          })};
}

SpatialQuery SpatialQueryMaker::nearestByMinimum() {
  const int i = upTo(3), k = upTo(3);
  std::vector<std::string> parts = thing("a", i);
  for (const std::string& part : thing("b", k)) parts.push_back(part);
  const std::string inner =
      "{ SELECT ?ga (MIN(geof:distance(?ga, ?gb)) AS ?m) { " + shuffled(parts) + "} GROUP BY ?ga } ";
  parts.push_back("FILTER(geof:distance(?ga, ?gb) = ?m)");
  parts.push_back(inner);
  return {"nearest by minimum", "SELECT DISTINCT ?a ?b { " + shuffled(parts) + "}",
          pairs(i, k, [&](const Thing&, const Patch& p, const Thing&, const Patch& q) {
            return nearestOf(p, k, "") == p.distanceTo(q);
          })};
}

/// The k nearest of each geometry: fewer than k are nearer, or at most k are as near.
SpatialQuery SpatialQueryMaker::nearestByCount() {
  const int i = upTo(3), k = upTo(3), most = 1 + upTo(4);
  std::vector<std::string> parts = thing("a", i), inner = thing("c", k);
  for (const std::string& part : thing("b", k)) parts.push_back(part);
  const bool is_optional = upTo(2) == 0;
  inner.push_back(is_optional ? "FILTER(geof:distance(?ga, ?gc) < geof:distance(?ga, ?gb))"
                              : "FILTER(geof:distance(?gb, ?ga) >= geof:distance(?ga, ?gc))");
  if (!is_optional) parts.insert(parts.end(), inner.begin(), inner.end());
  const bool is_distinct = upTo(3) == 0;
  const std::string count = is_distinct ? "COUNT(DISTINCT ?c)" : upTo(3) > 0 || is_optional ? "COUNT(?c)" : "COUNT(*)";
  const std::string number = std::to_string(most), next = std::to_string(most + 1);
  const std::string strict[] = {count + " < " + number, number + " > " + count},
                    loose[] = {count + " <= " + number, count + " < " + next};
  const std::string having = is_optional ? strict[upTo(2)] : loose[upTo(2)];
  const std::string text = shuffled(parts) + (is_optional ? "OPTIONAL { " + shuffled(inner) + "} " : "");
  const auto nearer = [&](const Patch& from, double distance) {
    int things = 0, pairs = 0;
    for (const Thing& c : town_.things) {
      const int before = pairs;
      for (const Patch& patch : c.patches)
        pairs += c.kind == k && (is_optional ? from.distanceTo(patch) < distance : from.distanceTo(patch) <= distance);
      things += pairs > before ? 1 : 0;
    }
    return is_distinct ? things : pairs;
  };
  std::vector<std::string> rows = pairs(i, k, [&](const Thing&, const Patch& p, const Thing&, const Patch& q) {
    const int pairs = nearer(p, p.distanceTo(q));
    return is_optional ? pairs < most : pairs <= most;
  });
  return {"nearest by count", "SELECT DISTINCT ?a ?b { " + text + "} GROUP BY ?a ?b ?ga ?gb HAVING(" + having + ")",
          rows};
}

SpatialQuery SpatialQueryMaker::lonely() {
  const double d = limit();
  const int i = upTo(3), k = upTo(3);
  const bool absent = upTo(2) == 0, by_minus = upTo(3) == 0;
  std::vector<std::string> parts = thing("a", i), inner = thing("b", k);
  inner.push_back("FILTER(" + within("?ga", "?gb", d) + ")");
  const std::string start = absent ? "FILTER NOT EXISTS { " : "FILTER EXISTS { ";
  std::string text = shuffled(parts) + start + shuffled(inner) + "}";
  if (by_minus) {
    for (const std::string& part : parts) inner.push_back(part);
    text = shuffled(parts) + "MINUS { " + shuffled(inner) + "}";
  }
  std::vector<std::string> rows;
  for (const Thing& a : town_.things)
    for (const Patch& p : a.patches)
      if (a.kind == i && (nearestOf(p, k, "") < d) != (absent || by_minus)) rows.push_back(a.name);
  return {"lonely", "SELECT DISTINCT ?a { " + text + "}", distinct(rows)};
}

SpatialQuery SpatialQueryMaker::optionalNeighbour() {
  const double d = limit();
  const int i = upTo(3), k = upTo(3);
  std::vector<std::string> inner = thing("b", k);
  inner.push_back("FILTER(" + within("?ga", "?gb", d) + ")");
  std::vector<std::string> rows =
      pairs(i, k, [&](const Thing&, const Patch& p, const Thing&, const Patch& q) { return p.distanceTo(q) < d; });
  for (const Thing& a : town_.things)
    for (const Patch& p : a.patches)
      if (a.kind == i && !(nearestOf(p, k, "") < d)) rows.push_back(a.name + " -");
  return {"optional neighbour",
          "SELECT DISTINCT ?a ?b { " + shuffled(thing("a", i)) + "OPTIONAL { " + shuffled(inner) + "} }",
          distinct(std::move(rows))};
}

/// Numbers are those of the first patch.
SpatialQuery SpatialQueryMaker::numberBand() {
  const double d = limit();
  const int i = upTo(3), k = upTo(3);
  std::vector<std::string> parts = {"?a :kind " + std::to_string(i) + " .", "?a :minX ?ax .", "?a :minY ?ay .",
                                    "?b :kind " + std::to_string(k) + " .", "?b :minX ?bx .", "?b :minY ?by ."};
  const std::string w = number(d);
  const int form = upTo(5);
  const std::string filters[] = {"ABS(?ax - ?bx) < " + w, "?bx > ?ax - " + w + " && ?bx < ?ax + " + w,
                                 "(?ax - ?bx) * (?ax - ?bx) + (?ay - ?by) * (?ay - ?by) < " + w + " * " + w,
                                 "?ax = ?bx", "?ax + " + w + " <= ?bx"};
  parts.push_back("FILTER(" + filters[form] + ")");
  return {"number band", "SELECT DISTINCT ?a ?b { " + shuffled(parts) + "}",
          pairs(i, k, [&](const Thing& a, const Patch&, const Thing& b, const Patch&) {
            const double dx = b.patches[0].min_x - a.patches[0].min_x, dy = b.patches[0].min_y - a.patches[0].min_y;
            if (form == 2) return dx * dx + dy * dy < d * d;
            if (form == 3) return dx == 0;
            return form == 4 ? dx >= d : dx > -d && dx < d;
          })};
}

SpatialQuery SpatialQueryMaker::boxesOfNumbers() {
  const int i = upTo(3), k = upTo(3);
  std::vector<std::string> parts;
  for (const std::string name : {"a", "b"}) {
    parts.push_back("?" + name + " :kind " + std::to_string(name == "a" ? i : k) + " .");
    for (const std::string edge : {"minX", "minY", "maxX", "maxY"})
      parts.push_back("?" + name + " :" + edge + " ?" + name + edge + " .");
  }
  const std::string last = upTo(2) == 0 ? "?bminY <= ?amaxY" : "!(?bminY > ?amaxY)";
  parts.push_back("FILTER(?aminX <= ?bmaxX && ?bminX <= ?amaxX && ?aminY <= ?bmaxY && " + last + ")");
  return {"boxes of numbers", "SELECT DISTINCT ?a ?b { " + shuffled(parts) + "}",
          pairs(i, k, [](const Thing& a, const Patch&, const Thing& b, const Patch&) {
            return a.patches[0].meets(b.patches[0]);
          })};
}

SpatialQuery SpatialQueryMaker::next() {
  using Make = SpatialQuery (SpatialQueryMaker::*)();
  constexpr Make kMakers[] = {
      &SpatialQueryMaker::pairWithin,        &SpatialQueryMaker::pairRelated,      &SpatialQueryMaker::boundThing,
      &SpatialQueryMaker::placesOfValues,    &SpatialQueryMaker::oneOfPlaces,      &SpatialQueryMaker::nearestFirst,
      &SpatialQueryMaker::nearestByAbsence,  &SpatialQueryMaker::nearestByMinimum, &SpatialQueryMaker::lonely,
      &SpatialQueryMaker::optionalNeighbour, &SpatialQueryMaker::numberBand,       &SpatialQueryMaker::boxesOfNumbers,
      &SpatialQueryMaker::nearestByCount};
  return (this->*kMakers[upTo(13)])();
}

}  // namespace cluxel::test
