// SPDX-License-Identifier: Apache-2.0
// Reading a map: points find their cluxels, objects are disjoint, and the facts agree with the layers.
#include "mapping/map_reader.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "mapping/facts/fact_sink.hpp"
#include "mapping/map_state.hpp"
#include "mapping/newest_map.hpp"
#include "mapping/small_campus.hpp"
#include "perception/crf/label_model.hpp"
#include "perception/pipeline.hpp"
#include "rdf/lock_number.hpp"
#include "sparql/query_engine.hpp"

namespace cluxel::mapping {

using namespace scan;
using namespace perception;
using namespace simulation;
using namespace rdf;
using namespace sparql;
using namespace rules;
namespace {

class MapReading : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    campus = new SmallCampus({.seed = 5, .stops = 3, .size_m = 50, .points_per_stop = 12000});
    folder = new ScratchFolder;
    buildMap(scansOf(campus->files()), shippedInputs(), folder->path() / "map.clx", {.threads = 2}, silence());
    map = new MapReader(folder->path() / "map.clx");
  }
  static void TearDownTestSuite() {
    delete map;
    delete folder;
    delete campus;
  }
  static std::size_t count(const std::string& pattern) {
    return evaluateQuery(map->quads(),
                         "PREFIX clx: <https://w3id.org/cluxel/ontology#> PREFIX sosa: "
                         "<http://www.w3.org/ns/sosa/> SELECT DISTINCT * WHERE { " +
                             pattern + " }")
        .table.row_count;
  }
  static inline SmallCampus* campus = nullptr;
  static inline ScratchFolder* folder = nullptr;
  static inline MapReader* map = nullptr;
};

/// The kept point nearest to `p` in its voxel: it represents the points that thinning removed.
std::uint32_t nearestInVoxel(const TilePoints& points, const Eigen::Vector3f& p, double voxel_m) {
  const auto voxel = [&](const Eigen::Vector3f& q) {
    return std::array<double, 3>{std::floor(q.x() / voxel_m), std::floor(q.y() / voxel_m), std::floor(q.z() / voxel_m)};
  };
  std::uint32_t best = 0xffffffffU;
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (voxel(points.at(i)) != voxel(p)) continue;
    const double distance = (points.at(i) - p).cast<double>().squaredNorm();
    if (distance < least) least = distance, best = i;
  }
  return best;
}

TEST_F(MapReading, AnswersEveryPointAsBruteForceDoes) {
  const LabelModel model = parseModel(map->inputs().model.text, "model.json");
  std::vector<Scan> scans;
  for (const Cloud& cloud : map->clouds()) {
    Scan scan;
    scan.points = map->pointsOf(cloud.id);
    scan.T_map_sensor = cloud.T_map_sensor, scan.has_pose = cloud.has_pose, scan.id = cloud.id;
    scans.push_back(std::move(scan));
  }
  const TileOutputs tiles = perceive(scans, model.perception, 2);
  const Scene& scene = map->scene();
  std::map<CluxelName, std::uint32_t> number;
  for (std::uint32_t c = 0; c < scene.cluxels.size(); ++c) number[scene.cluxels.name[c]] = c;
  const std::vector<Cloud> clouds = map->clouds();
  for (std::size_t s = 0; s < scans.size(); ++s) {
    const PointAnswers answers = map->answersFor(clouds[s]);
    ASSERT_EQ(answers.cluxel.size(), scans[s].points.size());
    for (std::size_t i = 7; i < scans[s].points.size(); i += 97) {
      const Eigen::Vector3f p(scans[s].points.x[i], scans[s].points.y[i], scans[s].points.z[i]);
      const Eigen::Vector3d p_map = toMap(scans[s].T_map_sensor, p);
      const TileKey key = TileGrid().tileOf(p_map);
      const std::uint32_t kept =
          nearestInVoxel(tiles.points.at(key), localPoint({}, key, p_map), model.perception.thin.voxel_m);
      ASSERT_NE(kept, 0xffffffffU) << "point " << i << " has no kept point in its voxel";
      EXPECT_EQ(answers.cluxel[i], number.at({key, tiles.cluxels.at(key).point_cluxel[kept]})) << "point " << i;
      EXPECT_EQ(answers.label[i], static_cast<std::uint8_t>(scene.cluxels.label[answers.cluxel[i]]));
    }
  }
}

TEST_F(MapReading, ObjectsShareNoCluxelAndPointsFindThem) {
  std::map<std::uint32_t, std::uint32_t> owner;
  for (std::uint32_t i = 0; i < map->objects().size(); ++i)
    for (const ObjectPart& part : map->objects()[i].parts)
      for (const std::uint32_t cluxel : part.cluxels) {
        const auto [place, is_new] = owner.try_emplace(cluxel, i);
        EXPECT_TRUE(is_new) << "cluxel " << cluxel << " of objects " << place->second << " and " << i;
      }
  ASSERT_FALSE(owner.empty());
  const PointAnswers answers = map->answersFor(map->clouds()[0]);
  for (std::size_t i = 0; i < answers.cluxel.size(); ++i) {
    const auto expected = owner.find(answers.cluxel[i]);
    ASSERT_EQ(answers.object[i], expected == owner.end() ? kNoObjectOfPoint : expected->second);
  }
}

TEST_F(MapReading, TheSummaryCountsWhatIsThere) {
  const MapSummary summary = map->summary();
  EXPECT_TRUE(summary.is_finished);
  EXPECT_EQ(summary.clouds, 3U);
  std::uint64_t points = 0;
  for (const SimulatedScan& scan : campus->scans()) points += scan.scan.points.size();
  EXPECT_EQ(summary.points, points);
  EXPECT_EQ(summary.objects, map->objects().size());
  std::size_t by_class = 0;
  for (const auto& [name, objects] : summary.objects_by_class) {
    by_class += objects;
    // Counted in the observed graph, because a barrier is inferred to be a small object as well.
    EXPECT_EQ(count("GRAPH <" + std::string(vocabulary::kGraphObserved) + "> { ?o a clx:" + name + " ; clx:rule ?r }"),
              objects)
        << name;
  }
  EXPECT_EQ(by_class, summary.objects);
  EXPECT_EQ(summary.quads, map->quads().size());
  EXPECT_EQ(summary.inputs_hash, map->inputs().hash().hex());
}

TEST_F(MapReading, CloudsKeepPosePointsAndBounds) {
  for (const Cloud& cloud : map->clouds()) {
    EXPECT_TRUE(cloud.has_pose);
    const ScanPoints points = map->pointsOf(cloud.id);
    EXPECT_EQ(points.size(), cloud.point_count);
    Eigen::AlignedBox3d box;
    for (std::size_t i = 0; i < points.size(); ++i)
      box.extend(toMap(cloud.T_map_sensor, {points.x[i], points.y[i], points.z[i]}));
    EXPECT_EQ(box.min(), cloud.min);
    EXPECT_EQ(box.max(), cloud.max);
  }
}

TEST_F(MapReading, EveryObjectHasPositionSizeConfidenceRuleAndGeometry) {
  const std::size_t objects = map->objects().size();
  for (const char* property : {"x", "y", "z", "confidence", "height", "length", "width", "minX", "maxZ", "pointCount"})
    EXPECT_EQ(count("?o clx:rule ?r ; clx:" + std::string(property) + " ?v"), objects) << property;
  EXPECT_EQ(count("?o clx:rule ?r ; <http://www.opengis.net/ont/geosparql#hasBoundingBox> ?g . ?g "
                  "<http://www.opengis.net/ont/geosparql#asWKT> ?w"),
            objects);
  EXPECT_EQ(count("?o clx:rule ?r ; clx:confidence ?c FILTER(?c < 0 || ?c > 1)"), 0U);
  EXPECT_EQ(count("?o clx:rule ?r ; clx:minX ?a ; clx:x ?b ; clx:maxX ?c FILTER(?a > ?b || ?b > ?c)"), 0U);
  EXPECT_EQ(count("?o clx:rule ?r ; clx:length ?l ; clx:width ?w FILTER(?l < ?w)"), 0U);
}

TEST_F(MapReading, PartsAndObjectsNameEachOther) {
  EXPECT_GT(count("?o clx:hasPart ?p"), 0U);
  EXPECT_EQ(count("?o clx:hasPart ?p FILTER NOT EXISTS { ?p clx:partOf ?o }"), 0U);
  EXPECT_EQ(count("?p clx:partOf ?o FILTER NOT EXISTS { ?o clx:hasPart ?p }"), 0U);
  EXPECT_EQ(count("?p clx:partOf ?o, ?other FILTER(?o != ?other)"), 0U);
}

TEST_F(MapReading, EverySightingOfAnObjectInACloudIsOneObservation) {
  std::set<std::pair<std::uint32_t, std::string>> sightings;
  std::map<std::uint32_t, std::set<std::string>> views;
  for (const Cloud& cloud : map->clouds())
    for (const std::uint32_t object : map->answersFor(cloud).object)
      if (object != kNoObjectOfPoint) sightings.insert({object, cloud.id.hex()});
  const std::size_t observations = count("?s a clx:Observation ; sosa:hasFeatureOfInterest ?o ; clx:inCloud ?c");
  // Thinning may remove all points of a cloud on an object.
  EXPECT_LE(observations, sightings.size());
  EXPECT_GE(observations, sightings.size() * 95 / 100);
  EXPECT_EQ(count("?o clx:viewCount ?n ; clx:rule ?r { SELECT ?o (COUNT(?s) AS ?seen) WHERE { ?s "
                  "sosa:hasFeatureOfInterest ?o } "
                  "GROUP BY ?o } FILTER(?n != ?seen)"),
            0U);
}

TEST_F(MapReading, NearIsSymmetricAndNeverOfItself) {
  EXPECT_EQ(count("?a clx:near ?b ; clx:rule ?r FILTER NOT EXISTS { ?b clx:near ?a }"), 0U);
  EXPECT_EQ(count("?a clx:near ?a"), 0U);
}

TEST_F(MapReading, TheScenesPrimitivesArePartitionsOfCluxelsOfOneLabel) {
  const Scene& scene = map->scene();
  std::vector<int> seen(scene.cluxels.size(), 0);
  for (PrimitiveIndex p = 0; p < scene.primitives.size(); ++p)
    for (const std::uint32_t c : scene.primitives[p].cluxels) {
      ++seen[c];
      EXPECT_EQ(scene.cluxels.primitive[c], p);
      EXPECT_EQ(scene.cluxels.label[c], scene.primitives[p].label);
    }
  EXPECT_EQ(seen, std::vector<int>(scene.cluxels.size(), 1));
}

TEST(MapReaderErrors, RefuseWhatIsNoMapNamingTheFile) {
  const ScratchFolder folder;
  const auto file = folder.path() / "no-map.clx";
  for (const std::string& bytes : {std::string("hello"), std::string(100'000, 'x')}) {
    writeFile(file, bytes);
    try {
      MapReader reader(file);
      FAIL() << "a text was taken for a map";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::StoreUnavailable);
      EXPECT_NE(std::string(error.what()).find("no-map.clx"), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(MapReader(folder.path() / "absent.clx"), Error);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "absent.clx")) << "reading makes no file";
}

TEST_F(MapReading, OfAnEarlierModelSaysToBuildAnew) {
  const auto earlier = folder->path() / "earlier.clx";
  std::filesystem::copy_file(folder->path() / "map.clx", earlier);
  {
    const auto environment = Environment::open(earlier, OpenMode::ReadWrite);
    MapInputs inputs = storedInputs(environment->read());
    const std::string version = "\"version\":" + std::to_string(kModelVersion);
    inputs.model.text.replace(inputs.model.text.find(version), version.size(), "\"version\":1");
    WriteTransaction transaction = environment->write();
    storeInputs(transaction, inputs);
    transaction.commit();
  }
  const MapReader reader(earlier);
  EXPECT_TRUE(reader.summary().is_finished) << "facts need no model";
  try {
    reader.scene();
    FAIL() << "the model was read";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::InvalidArgument);
    EXPECT_NE(std::string(error.what()).find("earlier.clx: was made by another version"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("build it anew"), std::string::npos) << error.what();
  }
}

TEST_F(MapReading, ReadersOfACommitShareWhatTheyRead) {
  const std::filesystem::path file = folder->path() / "shared.clx";
  std::filesystem::copy_file(folder->path() / "map.clx", file);
  const MapReader first(file), second(file);
  const TileStages& stages = first.stages();
  EXPECT_EQ(&first.scene(), &second.scene());
  EXPECT_EQ(&first.objects(), &second.objects());
  EXPECT_EQ(&stages, &second.stages());
  const TileStages& with_points = second.stagesWithPoints();
  EXPECT_TRUE(stages.points().empty()) << "what another reader has in hand stays as it is";
  EXPECT_FALSE(with_points.points().empty());
  EXPECT_EQ(&first.stages(), &stages);
  EXPECT_EQ(&second.stages(), &with_points);
  EXPECT_EQ(&first.stagesWithPoints(), &with_points);
  EXPECT_EQ(&MapReader(file).stages(), &with_points);
  EXPECT_EQ(stages.summaries().size(), with_points.summaries().size());
}

TEST_F(MapReading, StagesOfOneReaderGetTheirPointsInPlace) {
  const std::filesystem::path file = folder->path() / "alone.clx";
  std::filesystem::copy_file(folder->path() / "map.clx", file);
  const MapReader other(file), alone(file);
  const TileStages& stages = alone.stages();
  EXPECT_EQ(&alone.stagesWithPoints(), &stages) << "the other has nothing in hand";
}

TEST_F(MapReading, ReadersOfDifferentCommitsShareNothing) {
  const std::filesystem::path file = folder->path() / "commits.clx";
  std::filesystem::copy_file(folder->path() / "map.clx", file);
  const MapReader before(file);
  const auto& objects = before.objects();
  {
    WriteTransaction transaction = Environment::open(file, OpenMode::ReadWrite)->write();
    transaction.putBlock("test", "key", "bytes");
    transaction.commit();
  }
  const MapReader after(file);
  EXPECT_NE(&after.objects(), &objects);
  EXPECT_EQ(after.objects().size(), objects.size());
}

/// Nobody may write the map under its new name as long as it is open under the old one.
TEST_F(MapReading, AMapThatWasMovedIsClosedWhenItIsAskedFor) {
  const std::filesystem::path file = folder->path() / "asked.clx", moved = folder->path() / "moved.clx";
  std::filesystem::copy_file(folder->path() / "map.clx", file);
  NewestMap newest(file);
  const std::uint64_t quads = newest.reader().quads().size();
  std::filesystem::rename(file, moved);
  EXPECT_THROW(newest.releaseIfOld(), Error);
  EXPECT_EQ(Environment::open(moved, OpenMode::ReadOnly)->file(), moved) << "it is open under its old name";
  std::filesystem::rename(moved, file);
  EXPECT_EQ(newest.reader().quads().size(), quads);
}

TEST_F(MapReading, AMapWhoseLockFileIsOutOfDateIsOpenedAgain) {
  const std::filesystem::path file = folder->path() / "outdated.clx";
  std::filesystem::copy_file(folder->path() / "map.clx", file);
  NewestMap newest(file);
  const std::uint64_t quads = newest.reader().quads().size();
  ASSERT_TRUE(rdf::forgetNewestCommit(file, Environment::open(file, OpenMode::ReadOnly)->read().commitNumber()));
  EXPECT_EQ(newest.reader().quads().size(), quads);
  EXPECT_EQ(newest.quads().size(), quads);
}

TEST(DecimalText, IsShortAndHasAPoint) {
  EXPECT_EQ(decimalText(2.35, 3), "2.35");
  EXPECT_EQ(decimalText(2.0, 3), "2.0");
  EXPECT_EQ(decimalText(0, 3), "0.0");
  EXPECT_EQ(decimalText(-0.0001, 3), "0.0");
  EXPECT_EQ(decimalText(-1.5, 3), "-1.5");
  EXPECT_EQ(decimalText(0.0005, 3), "0.001");
  EXPECT_EQ(decimalText(1234567.8914, 3), "1234567.891");
  EXPECT_EQ(decimalText(10, 0), "10.0");
  EXPECT_EQ(decimalText(100, 3), "100.0");
}

TEST(LocalName, IsWhatFollowsTheLastHashOrSlash) {
  EXPECT_EQ(localName("https://w3id.org/cluxel/ontology#Tree"), "Tree");
  EXPECT_EQ(localName("https://example.org/a/b"), "b");
  EXPECT_EQ(localName("Tree"), "Tree");
  EXPECT_EQ(localName(""), "");
}

}  // namespace
}  // namespace cluxel::mapping
