// SPDX-License-Identifier: Apache-2.0
// Objects and points of the facade against those of the map reader.
#include "cluxel/object.hpp"

#include <gmock/gmock.h>

#include "api/facade_campus.hpp"
#include "cluxel/point_cloud.hpp"
#include "mapping/facts/object_geometry.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel {
namespace {

constexpr double kRounding = 0.00051;  ///< of numbers in RDF: three decimals [m and shares]

const Map& mapWithObjects() {
  return FacadeCampus::shared().map;
}

TEST(Objects, AreThoseOfTheMapReader) {
  const mapping::MapReader reader(mapWithObjects().file());
  const std::vector<Object> objects = mapWithObjects().objects();
  ASSERT_EQ(objects.size(), reader.objects().size());
  ASSERT_GT(objects.size(), 5U);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const rules::SemanticObject& expected = reader.objects()[i];
    const mapping::ObjectGeometry geometry = mapping::geometryOf(reader.scene().cluxels, mapping::cluxelsOf(expected));
    EXPECT_EQ(objects[i].number, i);
    EXPECT_EQ(objects[i].iri, rdf::iriOfObject(expected.id));
    EXPECT_EQ(objects[i].class_iri, expected.class_iri);
    EXPECT_EQ(objects[i].rule, expected.rule_id);
    EXPECT_NEAR(objects[i].confidence, expected.confidence, kRounding);
    EXPECT_NEAR(objects[i].centroid.x, geometry.centroid.x(), kRounding);
    EXPECT_NEAR(objects[i].min.y, geometry.min.y(), kRounding);
    EXPECT_NEAR(objects[i].max.z, geometry.max.z(), kRounding);
    EXPECT_NEAR(objects[i].top_m, geometry.top_m, kRounding);
    EXPECT_NEAR(objects[i].length_m, geometry.box.size.x(), kRounding);
    EXPECT_EQ(objects[i].point_count, geometry.point_count);
  }
}

TEST(Objects, HaveTheirPartsAndLabels) {
  const std::vector<Object> trees = mapWithObjects().objects("Tree");
  ASSERT_FALSE(trees.empty());
  std::size_t trunks = 0;
  for (const Object& tree : trees) {
    EXPECT_EQ(tree.label, "tree");
    for (const ObjectPart& part : tree.parts) {
      trunks += part.class_iri.ends_with("#TreeTrunk") ? 1 : 0;
      EXPECT_FALSE(part.iri.empty() || part.label.empty());
      EXPECT_GE(part.min.z, tree.min.z - kRounding);
      EXPECT_LE(part.max.z, tree.max.z + kRounding);
    }
  }
  EXPECT_GT(trunks, 0U);
}

TEST(Objects, AreChosenByClassAndItsSubclasses) {
  const std::vector<Object> all = mapWithObjects().objects(), trees = mapWithObjects().objects("clx:Tree"),
                            plants = mapWithObjects().objects("https://w3id.org/cluxel/ontology#Plant");
  EXPECT_EQ(trees.size(), mapWithObjects().summary().objects_by_class.at("Tree"));
  EXPECT_GE(plants.size(), trees.size());
  EXPECT_LT(plants.size(), all.size());
  for (const Object& tree : trees) EXPECT_EQ(all.at(tree.number).iri, tree.iri);
  try {
    mapWithObjects().objects("Tre");
    FAIL() << "nothing was refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::NotFound);
    EXPECT_THAT(error.what(), testing::HasSubstr("did you mean 'Tree'"));
  }
}

TEST(Objects, AreRefusedForAClassWhoseThingsAreNone) {
  for (const char* name : {"Way", "TreeTrunk", "Avenue", "Cloud", "ParkingRow"}) try {
      mapWithObjects().objects(name);
      ADD_FAILURE() << name;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::InvalidArgument);
      EXPECT_THAT(error.what(), testing::HasSubstr("is no class of objects: it is not below clx:Object"));
    }
  EXPECT_EQ(mapWithObjects().objects("Object").size(), mapWithObjects().objects().size());
  EXPECT_TRUE(mapWithObjects().objects("TrafficLight").empty()) << "there is none, but there could be";
}

TEST(Points, OfAnObjectAreThoseOfAnyOfItsNames) {
  const Object tree = mapWithObjects().objects("Tree").front();
  const std::string digits = tree.iri.substr(tree.iri.rfind('/') + 1);
  const std::size_t count = mapWithObjects().points(tree).size();
  for (const std::string& name :
       {tree.iri, "<" + tree.iri + ">", digits, "object/" + digits, "#" + std::to_string(tree.number)})
    EXPECT_EQ(mapWithObjects().points(name).size(), count) << name;
  EXPECT_THROW(mapWithObjects().points("#100000"), Error);
  EXPECT_THROW(mapWithObjects().points(mapWithObjects().clouds().front().iri), Error);
}

TEST(Points, OfACloudAreItsPointsInTheMapFrame) {
  const mapping::MapReader reader(mapWithObjects().file());
  const std::vector<Cloud> clouds = mapWithObjects().clouds();
  ASSERT_EQ(clouds.size(), 3U);
  for (std::size_t c = 0; c < clouds.size(); ++c) {
    const mapping::Cloud stored = reader.clouds()[c];
    const scan::ScanPoints expected = reader.pointsOf(stored.id);
    const mapping::PointAnswers answers = reader.answersFor(stored);
    const PointCloud points = mapWithObjects().points(clouds[c]);
    EXPECT_EQ(clouds[c].id, stored.id.hex());
    ASSERT_EQ(points.size(), clouds[c].point_count);
    EXPECT_EQ(points.intensity, expected.intensity);
    EXPECT_EQ(points.object, answers.object);
    for (std::size_t i = 0; i < points.size(); i += 97) {
      const Eigen::Vector3d p_map = scan::toMap(stored.T_map_sensor, {expected.x[i], expected.y[i], expected.z[i]});
      EXPECT_EQ(points.x[i], p_map.x());
      EXPECT_EQ(points.z[i], p_map.z());
      EXPECT_EQ(nameOf(points.label[i]), scan::nameOf(static_cast<scan::PrimitiveLabel>(answers.label[i])));
    }
  }
}

TEST(Points, OfAnObjectAreThoseOfAllCloudsThatBelongToIt) {
  const Object tree = mapWithObjects().objects("Tree").front();
  const PointCloud points = mapWithObjects().points(tree);
  std::size_t expected = 0;
  for (const Cloud& cloud : mapWithObjects().clouds())
    for (const std::uint32_t object : mapWithObjects().points(cloud).object) expected += object == tree.number ? 1 : 0;
  EXPECT_EQ(points.size(), expected);
  EXPECT_GE(points.size(), tree.point_count) << "thinning takes points away";
  for (const std::uint32_t object : points.object) EXPECT_EQ(object, tree.number);
}

TEST(Points, AreRefusedForWhatTheMapDoesNotHold) {
  Object object = mapWithObjects().objects().front();
  object.iri += "0";
  EXPECT_THROW(mapWithObjects().points(object), Error);
  Cloud cloud = mapWithObjects().clouds().front();
  cloud.id[0] = cloud.id[0] == '0' ? '1' : '0';
  EXPECT_THROW(mapWithObjects().points(cloud), Error);
}

}  // namespace
}  // namespace cluxel
