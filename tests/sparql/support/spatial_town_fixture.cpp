// SPDX-License-Identifier: Apache-2.0
// Makes towns of points and boxes, with and without strange geometries.
#include <algorithm>
#include <cmath>

#include "rdf/vocabulary.hpp"
#include "sparql/support/spatial_query_fixture.hpp"

namespace cluxel::test {
namespace {

std::string plain(double value) {
  std::string text = std::to_string(value);
  return text.substr(0, text.find('.') + 3);
}

std::string pairOf(double x, double y) {
  return plain(x) + " " + plain(y);
}

const std::string kWkt = std::string(rdf::vocabulary::kGeo) + "wktLiteral";

class TownMaker {
 public:
  TownMaker(std::uint32_t seed, bool strange) : random_(seed), strange_(strange) {}

  Town make(int count) {
    for (int i = 0; i < count; ++i) thing(i);
    return std::move(town_);
  }

 private:
  int upTo(int limit) { return static_cast<int>(random_() % static_cast<std::uint32_t>(limit)); }
  static Term named(const std::string& name) { return Term::iri("http://example.org/" + name); }
  void add(const Term& s, const Term& p, const Term& o) { town_.quads.push_back({s, p, o, Term::iri("")}); }

  Patch patch() {
    const double x = upTo(160) * 0.25, y = upTo(160) * 0.25;
    if (upTo(3) > 0) return {x, y, x, y};
    return {x, y, x + (1 + upTo(16)) * 0.25, y + (1 + upTo(16)) * 0.25};
  }

  void thing(int i) {
    Thing made{":o" + std::to_string(i), upTo(3), {}};
    const Term self = named("o" + std::to_string(i));
    add(self, named("kind"), Term::integer(made.kind));
    for (int k = upTo(8) == 0 ? 2 : 1; k > 0; --k) {
      const bool shared = !last_.empty() && upTo(10) == 0;
      made.patches.push_back(shared ? last_[static_cast<std::size_t>(upTo(static_cast<int>(last_.size())))] : patch());
      last_.push_back(made.patches.back());
      geometry(self, Term::literal(made.patches.back().wkt(), kWkt));
    }
    // Equal patches of one thing are one triple.
    if (made.patches.size() == 2 && made.patches[0].wkt() == made.patches[1].wkt()) made.patches.pop_back();
    numbers(self, made.patches[0]);
    if (strange_ && upTo(5) == 0) geometry(self, strangeGeometry());
    if (strange_ && upTo(6) == 0) add(self, named(upTo(2) == 0 ? "minX" : "maxY"), strangeNumber());
    town_.things.push_back(std::move(made));
  }

  void geometry(const Term& self, const Term& literal) {
    add(self, Term::iri(std::string(rdf::vocabulary::kGeo) + "asWKT"), literal);
  }

  void numbers(const Term& self, const Patch& patch) {
    constexpr const char* kTypes[] = {"decimal", "double", "float"};
    const std::string type = rdf::vocabulary::xsd(kTypes[upTo(3)]);
    add(self, named("minX"), Term::literal(plain(patch.min_x), type));
    add(self, named("minY"), Term::literal(plain(patch.min_y), type));
    add(self, named("maxX"), Term::literal(plain(patch.max_x), type));
    add(self, named("maxY"), Term::literal(plain(patch.max_y), type));
  }

  Term strangeGeometry() {
    const std::string at = pairOf(upTo(40), upTo(40)), then = pairOf(upTo(40), upTo(40));
    const std::string texts[] = {"POINT EMPTY",
                                 "POINT(" + at,
                                 "<http://www.opengis.net/def/crs/OGC/1.3/CRS84> POINT(" + at + ")",
                                 "<http://www.opengis.net/def/crs/EPSG/0/25832> POINT(" + at + ")",
                                 "LINESTRING(" + at + ", " + then + ")",
                                 "POINT Z (" + at + " 7)",
                                 "MULTIPOINT((" + at + "), (" + then + "))",
                                 "GEOMETRYCOLLECTION(POINT(" + at + "), LINESTRING(" + at + ", " + then + "))",
                                 "POLYGON((0 0, 40 0, 40 40, 0 40, 0 0), (5 5, 35 5, 35 35, 5 35, 5 5))",
                                 "POLYGON((0 0, 1 1))"};
    const int which = upTo(12);
    if (which == 10) return named("nowhere");
    if (which == 11) return Term::literal("POINT(" + at + ")");
    return Term::literal(texts[which], kWkt);
  }

  Term strangeNumber() {
    switch (upTo(6)) {
      case 0:
        return Term::literal("NaN", rdf::vocabulary::xsd("double"));
      case 1:
        return Term::literal("INF", rdf::vocabulary::xsd("double"));
      case 2:
        return Term::literal("many");
      case 3:
        return Term::literal("12345678901234567890123", rdf::vocabulary::xsd("integer"));
      case 4:
        return named("none");
      default:
        return Term::literal("2020-01-01T00:00:00Z", rdf::vocabulary::xsd("dateTime"));
    }
  }

  std::mt19937 random_;
  bool strange_;
  Town town_;
  std::vector<Patch> last_;
};

}  // namespace

std::string Patch::wkt() const {
  if (min_x == max_x && min_y == max_y) return "POINT(" + pairOf(min_x, min_y) + ")";
  return "POLYGON((" + pairOf(min_x, min_y) + ", " + pairOf(max_x, min_y) + ", " + pairOf(max_x, max_y) + ", " +
         pairOf(min_x, max_y) + ", " + pairOf(min_x, min_y) + "))";
}

double Patch::distanceTo(const Patch& other) const {
  const double dx = std::max({0.0, min_x - other.max_x, other.min_x - max_x});
  const double dy = std::max({0.0, min_y - other.max_y, other.min_y - max_y});
  return std::sqrt(dx * dx + dy * dy);
}

Town madeTown(std::uint32_t seed, int count, bool strange) {
  return TownMaker(seed, strange).make(count);
}

}  // namespace cluxel::test
