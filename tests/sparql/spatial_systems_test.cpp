// SPDX-License-Identifier: Apache-2.0
// Random spatial queries over geometries of named coordinate systems have the answers of brute force and of plans
// without spatial steps.
#include <gtest/gtest.h>

#include <regex>

#include "rdf/vocabulary.hpp"
#include "sparql/support/spatial_query_fixture.hpp"
#include "sparql/support/store_fixture.hpp"

namespace cluxel::test {

using namespace sparql;
namespace {

const std::string kUtm = "<http://www.opengis.net/def/crs/EPSG/0/25832>";
const std::string kFeet = "<http://www.opengis.net/def/crs/EPSG/0/2229>";
const std::string kLongitudeFirst = "<http://www.opengis.net/def/crs/OGC/1.3/CRS84>";
const std::string kLatitudeFirst = "<http://www.opengis.net/def/crs/EPSG/0/4326>";

/// Where a town lies: near a place on the earth for geographic systems.
struct Site {
  std::string system;
  double x = 0, y = 0, scale = 1;
};

/// The coordinates of a WKT text or of a query's literals, moved and scaled; every geometry names the system.
std::string movedTo(const Site& site, const std::string& text) {
  static const std::regex coordinates("(\\d+\\.\\d+) (\\d+\\.\\d+)"),
      starts("(^|\")(POINT|POLYGON|LINESTRING|MULTIPOINT)");
  std::string moved;
  auto last = text.cbegin();
  for (std::sregex_iterator at(text.begin(), text.end(), coordinates), end; at != end; ++at) {
    moved.append(last, (*at)[0].first);
    double x = site.x + std::stod((*at)[1]) * site.scale, y = site.y + std::stod((*at)[2]) * site.scale;
    if (site.system == kLatitudeFirst) std::swap(x, y);
    moved += std::to_string(x) + "0 " + std::to_string(y);
    last = (*at)[0].second;
  }
  moved.append(last, text.cend());
  return std::regex_replace(moved, starts, "$1" + site.system + " $2");
}

bool isWkt(const Term& term) {
  return term.datatype == std::string(rdf::vocabulary::kGeo) + "wktLiteral" && !term.text.starts_with('<');
}

QueryOptions comparingAllPairs() {
  QueryOptions options;
  options.spatial_plans = false;
  return options;
}

bool isSpatialPlan(const SmallStore& store, const std::string& text) {
  const QuadReader reader = store.reader();
  const std::string plan = PreparedQuery(reader, kPrefixes + text).explain();
  return plan.find("range join") != std::string::npos || plan.find("nearest") != std::string::npos;
}

std::vector<std::string> notesOf(const SmallStore& store, const std::string& text) {
  const QuadReader reader = store.reader();
  PreparedQuery query(reader, kPrefixes + text);
  query.evaluate();
  std::vector<std::string> notes;
  for (const Diagnostic& note : query.notes()) notes.push_back(note.message);
  return notes;
}

TEST(SpatialSystems, MetresOfAProjectedSystemGiveTheAnswersOfBruteForce) {
  const Site site{kUtm, 500'000, 5'400'000};
  Town town = madeTown(11, 60, false);
  SmallStore store;
  for (Quad& quad : town.quads)
    if (isWkt(quad.object)) quad.object.text = movedTo(site, quad.object.text);
  store.load(town.quads);
  SpatialQueryMaker maker(town, 12);
  int spatial = 0, compared = 0;
  for (int i = 0; i < 150; ++i) {
    const SpatialQuery query = maker.next();
    if (query.is_ordered) continue;
    const std::string text = movedTo(site, query.text);
    EXPECT_EQ(store.rows(text), query.rows) << query.family << "\n" << text;
    ++compared;
    spatial += isSpatialPlan(store, text) ? 1 : 0;
  }
  EXPECT_GT(compared, 100);
  EXPECT_GT(spatial, 50);
}

/// Degrees are some metres long, so that the limits of the queries keep some pairs and drop others.
TEST(SpatialSystems, PlansOnTheEllipsoidGiveTheAnswersOfAllPairs) {
  const Site sites[] = {{kLongitudeFirst, 11, 49, 1e-5},     {kLatitudeFirst, 25, 60, 1e-5},
                        {kLongitudeFirst, 5, 89.9997, 1e-5}, {kLongitudeFirst, 179.9998, -40, 1e-5},
                        {kFeet, 2'000'000, 500'000, 1},      {kLongitudeFirst, 0, 0, 2}};
  std::uint32_t seed = 20;
  for (const Site& site : sites) {
    ++seed;
    Town town = madeTown(seed, 40, seed % 2 == 0);
    SmallStore store;
    for (Quad& quad : town.quads)
      if (isWkt(quad.object)) quad.object.text = movedTo(site, quad.object.text);
    store.load(town.quads);
    SpatialQueryMaker maker(town, seed + 10);
    int with_rows = 0, spatial = 0;
    for (int i = 0; i < 40; ++i) {
      const SpatialQuery query = maker.next();
      const std::string text = movedTo(site, query.text);
      const auto rows = store.rows(text);
      EXPECT_EQ(rows, store.rows(text, comparingAllPairs())) << query.family << "\n" << text;
      with_rows += rows.empty() ? 0 : 1;
      spatial += isSpatialPlan(store, text) ? 1 : 0;
    }
    EXPECT_GT(with_rows, 5) << site.system << " at " << site.x;
    EXPECT_GT(spatial, 10) << site.system << " at " << site.x;
  }
}

TEST(SpatialSystems, ATownOfSeveralSystemsHasTheAnswersAndTheNotesOfAllPairs) {
  const Site sites[] = {{kLongitudeFirst, 11, 49, 1e-5}, {kUtm, 500'000, 5'400'000}};
  Town town = madeTown(31, 60, false);
  SmallStore store;
  std::size_t next = 0;
  for (Quad& quad : town.quads) {
    if (!isWkt(quad.object)) continue;
    const std::size_t which = next++ % 3;
    if (which < 2) quad.object.text = movedTo(sites[which], quad.object.text);
  }
  store.load(town.quads);
  SpatialQueryMaker maker(town, 32);
  for (int i = 0; i < 100; ++i) {
    const SpatialQuery query = maker.next();
    const std::string text = i % 3 == 0 ? query.text : movedTo(sites[i % 3 - 1], query.text);
    EXPECT_EQ(store.rows(text), store.rows(text, comparingAllPairs())) << query.family << "\n" << text;
  }
  const std::vector<std::string> notes =
      notesOf(store, "SELECT ?a { ?a geo:asWKT ?ga . ?b geo:asWKT ?gb FILTER(geof:distance(?ga, ?gb) < 1) }");
  EXPECT_EQ(notes.size(), 3U) << "three pairs of systems";
  for (const std::string& note : notes) EXPECT_NE(note.find("not related"), std::string::npos) << note;
}

}  // namespace
}  // namespace cluxel::test
