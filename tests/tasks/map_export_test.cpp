// SPDX-License-Identifier: Apache-2.0
// Every export is read back by a parser and compared with the map.
#include "tasks/export/map_export.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "base/file_bytes.hpp"
#include "rdf/ontology/ontology.hpp"
#include "scan/scan_set.hpp"
#include "tasks/campus_map_fixture.hpp"

namespace cluxel::tasks {

using namespace scan;
using namespace perception;
using namespace simulation;
using namespace rdf;
using namespace sparql;
using namespace rules;
using namespace mapping;
namespace {

using Json = nlohmann::json;
using Lines = std::multiset<std::string>;

std::string exported(ExportFormat format) {
  std::string text;
  exportMap(CampusMap::shared().map(), format, [&](std::string_view piece) { text.append(piece); });
  return text;
}

bool isHistory(const Quad& quad) {
  return quad.graph.text == vocabulary::kGraphHistory;
}

template <typename Visit>
void forEachQuad(const Visit& visit) {
  const QuadReader& reader = CampusMap::shared().map().quads();
  QuadCursor cursor = reader.scan({}, QuadOrder::Spog);
  for (QuadIds ids; cursor.next(ids);)
    visit(Quad{reader.termOf(ids.s), reader.termOf(ids.p), reader.termOf(ids.o), reader.termOf(ids.g)});
}

Lines readBack(const std::string& text, RdfFormat format) {
  Lines lines;
  parseRdf({text, "export", format, "", Term::iri("")}, [&](const Quad& quad) { lines.insert(toNQuads(quad)); });
  return lines;
}

TEST(Export, TheMapIsWorthExporting) {
  const MapSummary summary = CampusMap::shared().map().summary();
  EXPECT_GT(summary.objects, 10U);
  EXPECT_GT(summary.quads, 5'000U);
  EXPECT_EQ(summary.clouds, 4U);
}

TEST(Export, NQuadsReadBackAreTheQuadsOfAllGraphs) {
  Lines expected;
  std::set<std::string> graphs;
  forEachQuad([&](const Quad& quad) {
    expected.insert(toNQuads(quad));
    graphs.insert(quad.graph.text);
  });
  EXPECT_TRUE(graphs.contains(std::string(vocabulary::kGraphHistory)));
  EXPECT_TRUE(graphs.contains(std::string(vocabulary::kGraphInferred)));
  EXPECT_EQ(readBack(exported(ExportFormat::NQuads), RdfFormat::NQuads), expected);
}

TEST(Export, CanonicalIsSortedNQuadsWithoutHistory) {
  Lines expected;
  forEachQuad([&](const Quad& quad) {
    if (!isHistory(quad)) expected.insert(toNQuads(quad));
  });
  const std::string text = exported(ExportFormat::Canonical);
  EXPECT_EQ(readBack(text, RdfFormat::NQuads), expected);
  std::istringstream stream(text);
  std::string last;
  for (std::string line; std::getline(stream, line); last = line)
    ASSERT_LT(last, line) << "lines are sorted, each is there once";
  EXPECT_EQ(text, exported(ExportFormat::Canonical));
}

TEST(Export, CanonicalLoadedIntoAStoreGivesTheSameBytesAgain) {
  const std::string text = exported(ExportFormat::Canonical);
  const auto environment = Environment::temporary();
  {
    WriteTransaction transaction = environment->write();
    QuadWriter writer(transaction);
    loadRdf({text, "export", RdfFormat::NQuads, "", Term::iri("")}, writer);
    writer.flush();
    transaction.commit();
  }
  std::string again;
  writeSortedNQuads(QuadReader(environment->read()), [&](std::string_view piece) { again.append(piece); });
  EXPECT_TRUE(again == text);
}

TEST(Export, TurtleReadBackIsTheUnionOfAllGraphsButHistory) {
  std::set<std::string> expected;
  forEachQuad([&](const Quad& quad) {
    if (!isHistory(quad)) expected.insert(toNQuads({quad.subject, quad.predicate, quad.object, Term::iri("")}));
  });
  const Lines read = readBack(exported(ExportFormat::Turtle), RdfFormat::Turtle);
  EXPECT_EQ(read, Lines(expected.begin(), expected.end()));
}

/// A vertex of the exported cloud.
struct Vertex {
  double x, y, z;
  std::uint8_t red, green, blue;
  float primitive, object;
};

/// Reads binary little-endian PLY by its header's own list of properties.
std::vector<Vertex> parsedPly(const std::string& bytes) {
  const std::size_t body = bytes.find("end_header\n") + 11;
  std::istringstream header(bytes.substr(0, body));
  std::vector<std::pair<std::string, std::string>> properties;
  std::size_t count = 0;
  for (std::string word, type, name; header >> word;) {
    if (word == "format") {
      header >> type;
      EXPECT_EQ(type, "binary_little_endian");
    } else if (word == "element") {
      header >> name >> count;
      EXPECT_EQ(name, "vertex");
    } else if (word == "property") {
      header >> type >> name;
      properties.emplace_back(type, name);
    }
  }
  std::size_t at = body;
  const auto take = [&]<typename T>(T& value) {
    std::memcpy(&value, bytes.data() + at, sizeof value);
    at += sizeof value;
  };
  const std::map<std::string, std::size_t> sizes{{"double", 8}, {"uchar", 1}, {"float", 4}};
  std::size_t stride = 0;
  for (const auto& [type, name] : properties) stride += sizes.at(type);
  EXPECT_EQ(bytes.size(), body + count * stride);
  std::vector<Vertex> vertices(count);
  for (Vertex& v : vertices)
    for (const auto& [type, name] : properties) {
      if (name == "x") take(v.x);
      if (name == "y") take(v.y);
      if (name == "z") take(v.z);
      if (name == "red") take(v.red);
      if (name == "green") take(v.green);
      if (name == "blue") take(v.blue);
      if (name == "scalar_primitive") take(v.primitive);
      if (name == "scalar_object") take(v.object);
    }
  return vertices;
}

std::string hexColour(const Vertex& v) {
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", v.red, v.green, v.blue);
  return text;
}

TEST(Export, PlyHoldsEveryPointWhereItLiesWithTheColourOfItsClass) {
  const MapReader& map = CampusMap::shared().map();
  const std::vector<Vertex> vertices = parsedPly(exported(ExportFormat::Ply));
  const OntologyView ontology = ontologyViewOf(map.quads());
  std::size_t next = 0, coloured = 0;
  for (const Cloud& cloud : map.clouds()) {
    const ScanPoints points = map.pointsOf(cloud.id);
    const PointAnswers answers = map.answersFor(cloud);
    ASSERT_LE(next + points.size(), vertices.size());
    for (std::size_t i = 0; i < points.size(); ++i, ++next) {
      const Vertex& v = vertices[next];
      const Eigen::Vector3d p_map = cloud.T_map_sensor * Eigen::Vector3d(points.x[i], points.y[i], points.z[i]);
      ASSERT_NEAR((Eigen::Vector3d(v.x, v.y, v.z) - p_map).norm(), 0, 1e-9);
      ASSERT_EQ(v.primitive, static_cast<float>(answers.label[i]));
      ASSERT_EQ(v.object, answers.object[i] == kNoObjectOfPoint ? -1.0F : static_cast<float>(answers.object[i]));
      const std::string expected =
          v.object < 0 ? "#808080" : ontology.find(map.objects().at(answers.object[i]).class_iri)->color;
      ASSERT_EQ(hexColour(v), expected);
      coloured += v.object >= 0 ? 1 : 0;
    }
  }
  EXPECT_EQ(next, vertices.size());
  EXPECT_GT(coloured, vertices.size() / 4);
}

TEST(Export, PlyPutsTheObjectsWhereTheRdfSaysTheyAre) {
  constexpr double kTolerance_m = 0.25;  // a point may lie a cluxel's radius beside what was measured after thinning
  const auto& objects = CampusMap::shared().map().objects();
  const auto boxes = CampusMap::shared().boxesInRdf();
  ASSERT_EQ(boxes.size(), objects.size());
  std::vector<Eigen::AlignedBox3d> seen(objects.size());
  for (const Vertex& v : parsedPly(exported(ExportFormat::Ply)))
    if (v.object >= 0) seen.at(static_cast<std::size_t>(v.object)).extend(Eigen::Vector3d(v.x, v.y, v.z));
  for (std::size_t i = 0; i < objects.size(); ++i) {
    ASSERT_FALSE(seen[i].isEmpty()) << "object " << i << " has no point in the cloud";
    const Eigen::AlignedBox3d& said = boxes.at(objects[i].id.hex());
    EXPECT_LT((seen[i].min() - said.min()).cwiseAbs().maxCoeff(), kTolerance_m) << objects[i].class_iri;
    EXPECT_LT((seen[i].max() - said.max()).cwiseAbs().maxCoeff(), kTolerance_m) << objects[i].class_iri;
  }
}

TEST(Export, PlyIsReadBackByThePlyReaderOfScans) {
  const ScratchFolder folder;
  writeFile(folder.path() / "campus.ply", exported(ExportFormat::Ply));
  const Scan scan = ScanSet::open({folder.path() / "campus.ply"}, {}, silence()).load(0);
  EXPECT_EQ(scan.points.size(), CampusMap::shared().map().summary().points);
}

TEST(Export, FormatsAreKnownByNameAndByEnding) {
  EXPECT_EQ(exportFormatOf("ttl"), ExportFormat::Turtle);
  EXPECT_EQ(exportFormatOf("nq"), ExportFormat::NQuads);
  EXPECT_EQ(exportFormatOf("canonical"), ExportFormat::Canonical);
  EXPECT_EQ(exportFormatOf("ply"), ExportFormat::Ply);
  EXPECT_EQ(exportFormatOf("geojson"), ExportFormat::GeoJson);
  EXPECT_EQ(exportFormatOf("docx"), std::nullopt);
}

}  // namespace
}  // namespace cluxel::tasks
