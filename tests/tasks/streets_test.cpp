// SPDX-License-Identifier: Apache-2.0
// Files of streets: what is taken of them, and in which coordinate systems.
#include <gtest/gtest.h>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "rdf/scratch_folder.hpp"
#include "tasks/inventory/register.hpp"

namespace cluxel::tasks {
namespace {

struct ReadStreets : ProgressSink {
  void note(std::string_view text) override { notes.emplace_back(text); }
  std::vector<Street> streets;
  std::vector<std::string> notes;
  std::string fault;
};

ReadStreets streetsIn(const std::string& members, const std::string& features, const mapping::MapInputs& inputs = {}) {
  const rdf::ScratchFolder folder;
  writeFile(folder.path() / "streets.geojson", "{" + members + R"("features":[)" + features + "]}");
  ReadStreets read;
  try {
    read.streets = readStreets(folder.path() / "streets.geojson", inputs, read);
  } catch (const InputError& error) {
    read.fault = error.what();
  }
  return read;
}

std::string streetFeature(const std::string& name, const std::string& type, const std::string& coordinates) {
  return R"({"properties":{"name":)" + name + R"(},"geometry":{"type":")" + type + R"(","coordinates":)" + coordinates +
         "}}";
}

TEST(Streets, AreLinesWithANameAndTheOthersAreCounted) {
  const ReadStreets read = streetsIn(
      R"("frame":"map",)", streetFeature("\"Ring\"", "MultiLineString", "[[[0,0],[1,0]],[[5,0],[6,0],[7,1]]]") + "," +
                               streetFeature("null", "LineString", "[[0,0],[1,0]]") + "," +
                               streetFeature("\"Square\"", "Point", "[0,0]") + "," +
                               streetFeature("\"Lane\"", "LineString", "[[0,9],[1,9]]") + R"(,{"geometry":null})");
  ASSERT_EQ(read.streets.size(), 3U) << read.fault;
  EXPECT_EQ(read.streets[0].name, "Ring");
  EXPECT_EQ(read.streets[1].course.size(), 3U);
  EXPECT_EQ(read.streets[2].name, "Lane");
  ASSERT_EQ(read.notes.size(), 1U);
  EXPECT_NE(read.notes[0].find("features without a line: 2, without a name: 1"), std::string::npos) << read.notes[0];
  EXPECT_NE(streetsIn(R"("frame":"map",)", streetFeature("null", "LineString", "[[0,0],[1,0]]"))
                .fault.find("it holds no street"),
            std::string::npos);
}

TEST(Streets, InTheSystemOfTheMapAreReadAndThoseInAnotherAreRefused) {
  mapping::MapInputs inputs;
  inputs.crs = "EPSG:25832";
  inputs.map_origin = {563'000, 5'930'000, 0};
  const auto inSystem = [&](const std::string& name, const mapping::MapInputs& of_map) {
    return streetsIn(R"("crs":{"type":"name","properties":{"name":")" + name + R"("}},)",
                     streetFeature("\"Ring\"", "LineString", "[[563010,5930020],[563020,5930020]]"), of_map);
  };
  const ReadStreets own = inSystem("urn:ogc:def:crs:EPSG::25832", inputs);
  ASSERT_EQ(own.streets.size(), 1U) << own.fault;
  EXPECT_EQ(own.streets[0].course[0], Eigen::Vector2d(10, 20));
  const std::string other = inSystem("urn:ogc:def:crs:EPSG::25833", inputs).fault;
  EXPECT_NE(other.find("its coordinate system (crs) is 'EPSG:25833'"), std::string::npos) << other;
  EXPECT_NE(inSystem("urn:ogc:def:crs:EPSG::25832", {}).fault.find("that of the map, which has none"),
            std::string::npos);
  const std::string metres = inSystem("urn:ogc:def:crs:OGC:1.3:CRS84", inputs).fault;
  EXPECT_NE(metres.find("is no longitude and latitude"), std::string::npos) << metres;
  EXPECT_NE(metres.find("\"frame\": \"map\""), std::string::npos) << metres;
  const ReadStreets degrees =
      streetsIn("", streetFeature("\"Ring\"", "LineString", "[[9.953,53.517],[9.954,53.517]]"), inputs);
  ASSERT_EQ(degrees.streets.size(), 1U) << degrees.fault;
  EXPECT_LT(degrees.streets[0].course[0].norm(), 3000);
}

}  // namespace
}  // namespace cluxel::tasks
