// SPDX-License-Identifier: Apache-2.0
// Where the map's origin lies in the outer frame changes what a map holds by rounding alone: the same things are made
// of the same cluxels, and lie in the same places of the outer frame.
#include <gtest/gtest.h>

#include <iomanip>
#include <map>
#include <set>
#include <sstream>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "mapping/change/map_change.hpp"
#include "mapping/change/map_merge.hpp"
#include "mapping/facts/object_geometry.hpp"
#include "mapping/map_state.hpp"
#include "mapping/origin_text.hpp"
#include "mapping/small_campus.hpp"
#include "mapping/stored_grid.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;

/// Where the campus lies.
const Eigen::Vector3d kSite_m(563'012.3, 5'932'007.7, 31.4);
/// Whole tiles.
const Eigen::Vector3d kReference_m(563'008, 5'932'000, 16);
/// Properties whose values are heights in the map frame.
const std::vector<std::string> kHeights = {"z", "minZ", "maxZ"};

std::string textOf(const Eigen::Vector3d& v) {
  std::ostringstream text;
  text << std::setprecision(17) << "[" << v.x() << ", " << v.y() << ", " << v.z() << "]";
  return text.str();
}

class MapOrigin : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    campus = new SmallCampus({.seed = 3, .stops = 3, .size_m = 50, .points_per_stop = 12'000});
    inputs = new MapInputs(shippedInputs());
  }
  static void TearDownTestSuite() {
    delete campus;
    delete inputs;
  }

  /// The scans of the campus with times and with poses in the outer frame.
  ScanSet scansWith(const Eigen::Vector3d& map_origin, const std::vector<std::size_t>& which = {0, 1, 2}) const {
    std::ostringstream text;
    text << std::setprecision(17) << "frame: outer\nmap_origin: " << textOf(map_origin) << "\nscans:\n";
    for (const std::size_t i : which) {
      const Eigen::Isometry3d pose = Eigen::Translation3d(kSite_m) * campus->scans()[i].scan.T_map_sensor;
      text << "  - path: " << campus->files()[i].string() << "\n    time_s: " << 1e9 + double(i)
           << "\n    pose: {matrix: [";
      for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) text << (row + column > 0 ? ", " : "") << pose(row, column);
      text << "]}\n";
    }
    return opened(text.str());
  }
  /// The same points as a file of the outer frame has them that rounds to centimetres: many lie on borders of voxels.
  ScanSet roundedWith(const Eigen::Vector3d& map_origin) const {
    const fs::path file = folder.path() / "rounded.xyz";
    std::ostringstream points;
    points << std::fixed << std::setprecision(2);
    for (const SimulatedScan& simulated : campus->scans())
      for (std::size_t i = 0; i < simulated.scan.points.size(); ++i) {
        const ScanPoints& all = simulated.scan.points;
        const Eigen::Vector3d p = kSite_m + toMap(simulated.scan.T_map_sensor, {all.x[i], all.y[i], all.z[i]});
        points << p.x() << " " << p.y() << " " << p.z() << "\n";
      }
    writeFile(file, points.str());
    return opened("frame: outer\nmap_origin: " + textOf(map_origin) + "\nscans: [" + file.string() + "]\n");
  }
  ScanSet opened(const std::string& manifest) const {
    const fs::path file = folder.path() / "manifest.yaml";
    writeFile(file, manifest);
    return scansOf({file});
  }
  fs::path built(const ScanSet& scans) const {
    const fs::path map = folder.path() / ("map" + std::to_string(count++) + ".clx");
    buildMap(scans, *inputs, map, {}, silence());
    return map;
  }

  ScratchFolder folder;
  mutable int count = 0;
  static inline SmallCampus* campus = nullptr;
  static inline MapInputs* inputs = nullptr;
};

/// What a map holds, by names that follow from the class and the scans' points, with places in the outer frame.
struct Holding {
  std::map<std::string, Eigen::Vector3d> objects;  ///< class and members → centroid
  std::set<ContentHash> primitives;
  std::vector<double> regions, ways;  ///< areas, lengths
  Eigen::Vector3d first_way = Eigen::Vector3d::Zero();
};

Holding holdingOf(const fs::path& file) {
  const MapReader map(file);
  const Eigen::Vector3d origin = map.inputs().map_origin;
  Holding holding;
  for (const SemanticObject& object : map.objects())
    holding.objects.emplace(object.class_iri + " " + object.id.hex(),
                            origin + geometryOf(map.scene().cluxels, cluxelsOf(object)).centroid);
  holding.primitives = {map.primitiveIds().begin(), map.primitiveIds().end()};
  const WayGraph graph = map.ways();
  for (const Region& region : graph.regions) holding.regions.push_back(region.area_m2);
  for (const Way& way : graph.ways) holding.ways.push_back(way.length_m);
  if (!graph.ways.empty()) holding.first_way = origin + graph.ways.front().line.front();
  return holding;
}

void expectSame(const Holding& here, const Holding& there) {
  EXPECT_EQ(here.primitives, there.primitives);
  EXPECT_EQ(here.objects.size(), there.objects.size());
  for (const auto& [name, centroid] : here.objects) {
    const auto same = there.objects.find(name);
    ASSERT_NE(same, there.objects.end()) << name;
    EXPECT_LT((same->second - centroid).norm(), 1e-3) << name;
  }
  EXPECT_EQ(here.regions, there.regions);
  ASSERT_EQ(here.ways.size(), there.ways.size());
  for (std::size_t i = 0; i < here.ways.size(); ++i) EXPECT_NEAR(here.ways[i], there.ways[i], 1e-2);
  EXPECT_LT((here.first_way - there.first_way).norm(), 1e-3);
}

/// Beside the reference, and so far below it that the ground lies 16 m to 3 km above the origin.
std::vector<Eigen::Vector3d> otherOrigins() {
  return {Eigen::Vector3d(0, 0, kReference_m.z()),        kReference_m + Eigen::Vector3d(1600, -3200, -304),
          kReference_m + Eigen::Vector3d(1, 0, -16),      kReference_m + Eigen::Vector3d(5.3, -2.7, 0.4),
          kReference_m + Eigen::Vector3d(0.01, 7.999, 3), kReference_m + Eigen::Vector3d(0, 0, -3000.1)};
}

TEST_F(MapOrigin, IsToldWithAllItsDigitsAlsoWhereScansOfAnotherAreRefused) {
  const Eigen::Vector3d origin = kReference_m + Eigen::Vector3d(0.5600001, 0.7800003, 0.30000001);
  const fs::path map = built(scansWith(origin, {0, 1}));
  const std::string root = rdf::iriOfMapRoot();
  const MapReader reader(map);
  for (const int axis : {0, 1, 2}) {
    QuadIds quad;
    const auto property = reader.quads().idOf(Term::iri(vocabulary::clx(std::string("origin") + "XYZ"[axis])));
    ASSERT_TRUE(
        property &&
        reader.quads().scan({.s = reader.quads().idOf(Term::iri(root)), .p = property, .o = {}, .g = {}}).next(quad));
    EXPECT_EQ(std::stod(reader.quads().termOf(quad.o).text), origin[axis]);
  }
  try {
    extendMap(map, scansWith(kReference_m, {2}), {}, silence());
    FAIL() << "the scans lie in another frame";
  } catch (const Error& error) {
    for (const Eigen::Vector3d& named : {origin, kReference_m})
      EXPECT_NE(std::string(error.what()).find(originText(named)), std::string::npos) << error.what();
  }
  EXPECT_NO_THROW(extendMap(map, scansWith(origin, {2}), {}, silence()));
}

TEST_F(MapOrigin, AndCoordinateSystemAreBothNamedWhereScansHaveOthers) {
  const ScanSet scans = opened("frame: outer\ncrs: EPSG:25833\nmap_origin: " + textOf(kReference_m) + "\nscans: [" +
                               campus->files()[0].string() + "]\n");
  MapInputs of_map = *inputs;
  of_map.crs = "EPSG:25832";
  of_map.map_origin = kSite_m;
  try {
    requireFrame(of_map, scans);
    FAIL() << "the scans lie in another frame";
  } catch (const Error& error) {
    for (const std::string& named :
         {of_map.crs, scans.crs(), originText(of_map.map_origin), originText(scans.mapOrigin())})
      EXPECT_NE(std::string(error.what()).find(named), std::string::npos) << error.what();
  }
}

TEST_F(MapOrigin, AndCoordinateSystemOfBothMapsAreNamedWhereTheyAreNotMerged) {
  MapInputs one = *inputs, other = *inputs;
  one.map_origin = kReference_m;
  other.map_origin = kSite_m;
  other.crs = "EPSG:25832";
  EXPECT_NO_THROW(requireSameFrame("b.clx", one, "a.clx", one));
  try {
    requireSameFrame("b.clx", one, "a.clx", other);
    FAIL() << "the maps lie in different frames";
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()),
              "b.clx: has another map origin or coordinate system than a.clx: map_origin " + originText(kReference_m) +
                  " and coordinate system none, there map_origin " + originText(kSite_m) +
                  " and coordinate system EPSG:25832; name the transform between the frames");
  }
}

TEST_F(MapOrigin, ChangesNoObject) {
  const Holding here = holdingOf(built(scansWith(kReference_m)));
  EXPECT_GT(here.objects.size(), 5U);
  EXPECT_GT(here.ways.size(), 0U);
  for (const Eigen::Vector3d& origin : otherOrigins()) {
    SCOPED_TRACE(textOf(origin));
    expectSame(here, holdingOf(built(scansWith(origin))));
  }
}

/// N-Quads with heights in the map frame raised, without the height of the origin.
std::string raised(const std::string& quads, double rise_m) {
  std::istringstream lines(quads);
  std::string all;
  for (std::string line; std::getline(lines, line); all += line + "\n") {
    if (line.find(vocabulary::clx("originZ")) != std::string::npos) line.clear();
    for (const std::string& property : kHeights) {
      const std::string predicate = " <" + vocabulary::clx(property) + "> \"";
      const std::size_t begin = line.find(predicate);
      if (begin == std::string::npos) continue;
      const std::size_t value = begin + predicate.size(), end = line.find('"', value);
      std::ostringstream height;
      height << std::fixed << std::setprecision(6) << std::stod(line.substr(value, end - value)) + rise_m;
      line.replace(value, end - value, height.str());
    }
  }
  return all;
}

TEST_F(MapOrigin, LowerByWholeTilesRaisesHeightsAndChangesNothingElse) {
  const std::string here = raised(canonicalText(built(scansWith(kReference_m))), 0);
  EXPECT_NE(here, raised(here, 1));
  for (const double rise_m : {-48.0, 16.0, 3008.0}) {
    const fs::path map = built(scansWith(kReference_m - Eigen::Vector3d(0, 0, rise_m)));
    EXPECT_TRUE(raised(canonicalText(map), -rise_m) == here) << rise_m;
  }
}

TEST_F(MapOrigin, ChangesNoObjectOfPointsOnBordersOfVoxels) {
  const Holding here = holdingOf(built(roundedWith(kReference_m)));
  EXPECT_GT(here.objects.size(), 5U);
  for (const Eigen::Vector3d& shift : {Eigen::Vector3d(1, 0, -16), Eigen::Vector3d(5.3, -2.7, -1000.4)})
    expectSame(here, holdingOf(built(roundedWith(kReference_m + shift))));
}

TEST_F(MapOrigin, BetweenTilesGivesTheSameMapHoweverItGrows) {
  const Eigen::Vector3d origin = kReference_m + Eigen::Vector3d(5.3, -2.7, 0.4);
  const std::string expected = canonicalText(built(scansWith(origin)));
  const fs::path grown = built(scansWith(origin, {2}));
  extendMap(grown, scansWith(origin, {0, 1}), {}, silence());
  EXPECT_TRUE(canonicalText(grown) == expected);
  const fs::path first = built(scansWith(origin, {0, 1})), second = built(scansWith(origin, {2}));
  const fs::path merged = folder.path() / "merged.clx";
  mergeMaps({{first}, {second}}, merged, {}, silence());
  EXPECT_TRUE(canonicalText(merged) == expected);
}

TEST_F(MapOrigin, OfTheFirstMapHoldsForAMapWithOtherTiles) {
  const Eigen::Vector3d origin = kReference_m + Eigen::Vector3d(5.3, -2.7, 0.4);
  // The same map frame, as if the other origin were wrong: its tiles lie elsewhere, and are not taken.
  const auto scansOf = [&](const Eigen::Vector3d& stated, const std::vector<std::size_t>& which) {
    std::ostringstream text;
    text << "map_origin: " << textOf(stated) << "\nscans:\n";
    for (const std::size_t i : which) text << "  - " << campus->files()[i].string() << "\n";
    return opened(text.str());
  };
  const std::string expected = canonicalText(built(scansOf(origin, {0, 1, 2})));
  const fs::path first = built(scansOf(origin, {0})), second = built(scansOf(kReference_m, {1, 2}));
  const fs::path merged = folder.path() / "merged.clx";
  mergeMaps({{first}, {second, Eigen::Isometry3d::Identity(), true}}, merged, {}, silence());
  EXPECT_TRUE(canonicalText(merged) == expected);
}

/// Nothing has gone, so rules that ask the map see the ways that it tells.
TEST_F(MapOrigin, BetweenTilesMovesMeasuredWaysAsWell) {
  const MapReader map(built(scansWith(kReference_m + Eigen::Vector3d(5.3, -2.7, 0.4))));
  const WayGraph told = map.ways(), measured = map.measuredWays();
  ASSERT_FALSE(told.ways.empty());
  ASSERT_EQ(measured.ways.size(), told.ways.size());
  for (std::size_t i = 0; i < told.ways.size(); ++i) EXPECT_EQ(measured.ways[i].line, told.ways[i].line);
}

TEST_F(MapOrigin, AtWholeTilesStoresNoGrid) {
  for (const auto& [origin, has_grid] :
       {std::pair(kReference_m, false), std::pair(Eigen::Vector3d(kReference_m + Eigen::Vector3d(0, 0, 1)), true)}) {
    const MapReader map(built(scansWith(origin, {0})));
    EXPECT_EQ(map.transaction().block("meta", "grid").has_value(), has_grid);
    EXPECT_EQ(storedGrid(map.transaction()), map.inputs().tileGrid());
  }
}

/// Earlier versions put the tiles of such a map elsewhere. They are read there; what follows from them cannot change.
TEST_F(MapOrigin, OfAMapOfAnEarlierVersionRefusesChangesBetweenTiles) {
  const fs::path map = built(scansWith(kReference_m + Eigen::Vector3d(1, 0, 0), {0}));
  {
    const auto environment = Environment::open(map, OpenMode::ReadWrite);
    WriteTransaction transaction = environment->write();
    storeGrid(transaction, {});
    transaction.commit();
  }
  EXPECT_EQ(storedGrid(MapReader(map).transaction()), TileGrid());
  try {
    extendMap(map, scansWith(kReference_m + Eigen::Vector3d(1, 0, 0), {1}), {}, silence());
    FAIL() << "tiles of two grids are in one map";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("another version"), std::string::npos) << error.what();
  }
}

TEST(TileGrid, KeepsPointsOnBordersWhereTheyAre) {
  for (const Eigen::Vector3d& shift : {Eigen::Vector3d(5.3, -2.7, 0.4), Eigen::Vector3d(0.01, 7.999, 3)}) {
    const Eigen::Vector3d origin = kReference_m + shift;
    const TileGrid grid(origin);
    for (int i = -200; i <= 200; ++i) {
      const Eigen::Vector3d p_outer = kReference_m + Eigen::Vector3d(0.25 * i, -0.5 * i, 0.05 * i);
      const Eigen::Vector3d p = grid.fromMap(p_outer - origin);
      const Eigen::Vector3d whole = 16 * (origin / 16).array().floor();
      EXPECT_EQ(p.x(), p_outer.x() - whole.x());
      EXPECT_EQ(p.y(), p_outer.y() - whole.y());
      EXPECT_NEAR(p.z(), p_outer.z() - whole.z(), 1e-7);
    }
  }
}

TEST(TileGrid, OfWholeTilesLeavesEveryBit) {
  for (const Eigen::Vector3d& origin : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(-16, 5'932'000, 32)}) {
    const TileGrid grid(origin);
    EXPECT_EQ(grid, TileGrid());
    EXPECT_EQ(grid.fromMap({0.1, -1e-12, 1e7}), Eigen::Vector3d(0.1, -1e-12, 1e7));
    EXPECT_EQ(grid.tileOf({-1e-12, 16, 0}), (TileKey{-1, 1}));
    EXPECT_EQ(grid.cornerOf({-1, 1}), Eigen::Vector3d(-16, 16, 0));
  }
}

}  // namespace
}  // namespace cluxel::mapping
