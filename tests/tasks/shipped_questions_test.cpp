// SPDX-License-Identifier: Apache-2.0
// The shipped questions on a generated map: columns agree with the headers, answers with the truth and with plain loops
// over the map.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "tasks/campus_map_fixture.hpp"
#include "test_paths.hpp"

namespace cluxel::tasks {

using namespace scan;
using namespace perception;
using namespace simulation;
using namespace rdf;
using namespace sparql;
using namespace rules;
using namespace mapping;
namespace {

const CampusMap& campus() {
  return CampusMap::shared();
}

Eigen::Vector2d placeAt(const ResultTable& table, std::size_t row) {
  return {numberAt(table, row, "x"), numberAt(table, row, "y")};
}

std::string classAt(const ResultTable& table, std::size_t row) {
  return localName(textAt(table, row, "class"));
}

/// How many rows lie within `within_m` of one of these objects, seen from above.
std::size_t rowsNear(const ResultTable& rows, const std::vector<TruthObject>& objects, double within_m) {
  std::size_t near = 0;
  for (std::size_t i = 0; i < rows.row_count; ++i)
    near += std::any_of(objects.begin(), objects.end(), [&](const TruthObject& object) {
      return (object.center_map_m.head<2>() - placeAt(rows, i)).norm() <= within_m;
    });
  return near;
}

/// How many of these objects have a row within `within_m`.
std::size_t foundBy(const ResultTable& rows, const std::vector<TruthObject>& objects, double within_m) {
  std::size_t found = 0;
  for (const TruthObject& object : objects) found += rowsNear(rows, {object}, within_m) > 0;
  return found;
}

void expectAscending(const ResultTable& rows, const std::string& column, double sign = 1) {
  for (std::size_t i = 1; i < rows.row_count; ++i)
    EXPECT_LE(sign * numberAt(rows, i - 1, column), sign * numberAt(rows, i, column)) << column << " of row " << i;
}

/// Every number of the column is there and within these bounds.
void expectWithin(const ResultTable& rows, const std::string& column, double min, double max) {
  for (std::size_t i = 0; i < rows.row_count; ++i) {
    EXPECT_GE(numberAt(rows, i, column), min) << column << " of row " << i;
    EXPECT_LE(numberAt(rows, i, column), max) << column << " of row " << i;
  }
}

TEST(QuestionsOfACampus, EveryColumnHoldsWhatItsUnitSays) {
  const std::set<std::string> optional{"headHeight", "trunkWidth", "seenThrough"};
  for (const Question& question : shippedQuestions(DataHome(test::sourceFolder()))) {
    const ResultTable rows = campus().answer(question.file.stem());
    EXPECT_GT(rows.row_count, 0U) << question.file << " has no answer on a campus";
    for (std::size_t i = 0; i < rows.row_count; ++i)
      for (const QueryColumn& column : question.columns) {
        const auto at = std::find(rows.variables.begin(), rows.variables.end(), column.name);
        ASSERT_NE(at, rows.variables.end()) << question.file << " lacks " << column.name;
        const Term* cell = rows.at(i, static_cast<std::size_t>(at - rows.variables.begin()));
        if (cell == nullptr) {
          EXPECT_TRUE(optional.contains(column.name)) << question.file << " " << column.name << " is unbound";
        } else if (column.unit == "IRI") {
          EXPECT_EQ(cell->kind, TermKind::Iri) << question.file << " " << column.name;
        } else if (column.unit == "time") {
          EXPECT_EQ(cell->datatype, "http://www.w3.org/2001/XMLSchema#dateTime") << question.file << " " << column.name;
        } else if (column.unit != "text") {
          EXPECT_TRUE(std::isfinite(numberAt(rows, i, column.name))) << question.file << " " << column.name;
        }
      }
  }
}

TEST(QuestionsOfACampus, TheListOfObjectsIsTheMapsList) {
  const ResultTable rows = campus().answer("objects");
  std::map<std::string, std::string> said, expected;
  for (std::size_t i = 0; i < rows.row_count; ++i) {
    const std::string iri = textAt(rows, i, "object");
    said[iri.substr(iri.rfind('/') + 1)] = textAt(rows, i, "class");
  }
  for (const SemanticObject& object : campus().map().objects()) expected[object.id.hex()] = object.class_iri;
  EXPECT_EQ(rows.row_count, expected.size());
  EXPECT_EQ(said, expected);
  expectWithin(rows, "height", 0, 60);
}

TEST(QuestionsOfACampus, CountsByClassAreThoseOfTheList) {
  const ResultTable counts = campus().answer("count_by_class"), objects = campus().answer("objects");
  std::map<std::string, std::pair<double, double>> expected;  // number, sum of heights
  for (std::size_t i = 0; i < objects.row_count; ++i) {
    auto& [number, heights] = expected[classAt(objects, i)];
    ++number, heights += numberAt(objects, i, "height");
  }
  ASSERT_EQ(counts.row_count, expected.size());
  for (std::size_t i = 0; i < counts.row_count; ++i) {
    const auto& [number, heights] = expected.at(classAt(counts, i));
    EXPECT_EQ(numberAt(counts, i, "objects"), number);
    EXPECT_NEAR(numberAt(counts, i, "meanHeight"), heights / number, 1e-6);
  }
  expectAscending(counts, "objects", -1);
}

/// A question for one class gives the list's objects of this class, no more, no fewer.
void expectAllOfClass(const ResultTable& rows, const std::string& column, const std::string& class_name) {
  const ResultTable objects = campus().answer("objects");
  std::set<std::string> expected, said;
  for (std::size_t i = 0; i < objects.row_count; ++i)
    if (classAt(objects, i) == class_name) expected.insert(textAt(objects, i, "object"));
  for (std::size_t i = 0; i < rows.row_count; ++i) said.insert(textAt(rows, i, column));
  EXPECT_EQ(said, expected);
}

TEST(QuestionsOfACampus, TreesStandWhereTreesAre) {
  const ResultTable rows = campus().answer("trees");
  expectAllOfClass(rows, "tree", "Tree");
  expectAscending(rows, "height", -1);
  expectWithin(rows, "height", 1, 30);
  const auto trees = campus().truthOf("Tree", 200);
  ASSERT_GE(trees.size(), 3U);
  EXPECT_GE(2 * foundBy(rows, trees, 2.5), trees.size()) << "half of the trees with 200 points or more";
  EXPECT_GE(2 * rowsNear(rows, campus().truthOf("Tree", 1), 4), rows.row_count) << "half of the answers are at trees";
}

TEST(QuestionsOfACampus, TrunksAreThinnerThanTreesAreTall) {
  const ResultTable rows = campus().answer("trees");
  std::size_t with_trunk = 0;
  for (std::size_t i = 0; i < rows.row_count; ++i) {
    if (textAt(rows, i, "trunkWidth").empty()) continue;
    ++with_trunk;
    EXPECT_LT(numberAt(rows, i, "trunkWidth"), numberAt(rows, i, "height")) << "row " << i;
    EXPECT_GE(numberAt(rows, i, "trunkWidth"), 0) << "row " << i;
  }
  EXPECT_GT(with_trunk, 0U);
}

TEST(QuestionsOfACampus, SignsStandWhereSignsAre) {
  const ResultTable rows = campus().answer("street_signs");
  expectAllOfClass(rows, "sign", "StreetSign");
  expectAscending(rows, "confidence", -1);
  expectWithin(rows, "confidence", 0, 1);
  expectWithin(rows, "height", 0.3, 5);
  const auto signs = campus().truthOf("StreetSign", 60);
  ASSERT_GE(signs.size(), 1U);
  EXPECT_GE(foundBy(rows, signs, 1), 1U) << "of " << signs.size() << " signs with 60 points or more";
}

TEST(QuestionsOfACampus, FreeSignsAreTheSignsWithoutANeighbouringTree) {
  const ResultTable all = campus().answer("street_signs"), free = campus().answer("signs_without_tree");
  const QueryResult near = evaluateQuery(
      campus().map().quads(),
      "PREFIX clx: <https://w3id.org/cluxel/ontology#> SELECT DISTINCT ?sign { ?sign a clx:StreetSign ; clx:near ?t . "
      "?t a clx:Tree }");
  EXPECT_EQ(all.row_count, free.row_count + near.table.row_count);
  const auto trees = campus().answer("trees");
  for (std::size_t i = 0; i < free.row_count; ++i)
    for (std::size_t j = 0; j < trees.row_count; ++j)
      EXPECT_GT((placeAt(free, i) - placeAt(trees, j)).norm(), 0.3) << "a free sign stands in a tree";
}

TEST(QuestionsOfACampus, LampsStandWhereLampsAreWithTheirHeadsOnTop) {
  const ResultTable rows = campus().answer("street_lamps");
  expectAllOfClass(rows, "lamp", "StreetLamp");
  const auto lamps = campus().truthOf("StreetLamp", 60);
  ASSERT_GE(lamps.size(), 1U);
  EXPECT_GE(foundBy(rows, lamps, 1.5), 1U) << "of " << lamps.size() << " lamps with 60 points or more";
  for (std::size_t i = 0; i < rows.row_count; ++i) {
    if (textAt(rows, i, "headHeight").empty()) continue;
    EXPECT_GT(numberAt(rows, i, "headHeight"), 2) << "row " << i;
    EXPECT_LT(numberAt(rows, i, "headHeight"), 13) << "row " << i;
  }
}

TEST(QuestionsOfACampus, VehiclesHaveTheSizeOfVehicles) {
  const ResultTable rows = campus().answer("vehicles");
  expectAllOfClass(rows, "vehicle", "Vehicle");
  expectWithin(rows, "heading", -1.5709, 1.5709);
  expectWithin(rows, "length", 0.3, 15);
  for (std::size_t i = 0; i < rows.row_count; ++i)
    EXPECT_LE(numberAt(rows, i, "width"), numberAt(rows, i, "length")) << "length is the longer side";
  const auto vehicles = campus().truthOf("Vehicle", 300);
  ASSERT_GE(vehicles.size(), 1U);
  EXPECT_GE(2 * foundBy(rows, vehicles, 2), vehicles.size()) << "half of the vehicles with 300 points or more";
}

TEST(QuestionsOfACampus, MovableObstaclesAreThoseWhoseClassIsMovable) {
  const ResultTable rows = campus().answer("movable_obstacles"), vehicles = campus().answer("vehicles");
  expectAscending(rows, "footprint", -1);
  std::set<std::string> listed;
  for (std::size_t i = 0; i < rows.row_count; ++i) listed.insert(textAt(rows, i, "object"));
  for (std::size_t i = 0; i < vehicles.row_count; ++i)
    EXPECT_TRUE(listed.contains(textAt(vehicles, i, "vehicle"))) << "a vehicle may move";
  const ResultTable trees = campus().answer("trees");
  for (std::size_t i = 0; i < trees.row_count; ++i)
    EXPECT_FALSE(listed.contains(textAt(trees, i, "tree"))) << "a tree stays";
  // A barrier is a small object, and small objects are movable; a barrier stays all the same.
  const ResultTable objects = campus().answer("objects");
  std::set<std::string> movable;
  std::size_t barriers = 0;
  for (std::size_t i = 0; i < objects.row_count; ++i) {
    const std::string name = classAt(objects, i);
    barriers += name == "Barrier";
    if (name == "Vehicle" || name == "Person" || name == "SmallObject") movable.insert(textAt(objects, i, "object"));
  }
  EXPECT_GT(barriers, 0U) << "the campus has fences";
  EXPECT_EQ(listed, movable);
}

TEST(QuestionsOfACampus, WhatIsNearAPlaceIsWhatALoopFinds) {
  const ResultTable objects = campus().answer("objects");
  ASSERT_GT(objects.row_count, 0U);
  const Eigen::Vector2d place = placeAt(objects, objects.row_count / 2);
  const auto parameters =
      std::vector<std::string>{"x=" + std::to_string(place.x()), "y=" + std::to_string(place.y()), "radius=12"};
  const ResultTable rows = campus().answer("near_point", parameters);
  expectAscending(rows, "squaredDistance");
  std::map<std::string, double> expected;
  for (std::size_t i = 0; i < objects.row_count; ++i) {
    const double squared_m2 = (placeAt(objects, i) - place).squaredNorm();
    if (squared_m2 <= 144) expected[textAt(objects, i, "object")] = squared_m2;
  }
  ASSERT_EQ(rows.row_count, expected.size());
  EXPECT_GT(rows.row_count, 1U);
  EXPECT_LT(rows.row_count, objects.row_count);
  for (std::size_t i = 0; i < rows.row_count; ++i)
    EXPECT_NEAR(numberAt(rows, i, "squaredDistance"), expected.at(textAt(rows, i, "object")), 1e-3);
}

TEST(QuestionsOfACampus, ObservationsAddUpToTheCloudsThatSawAnObject) {
  const ResultTable rows = campus().answer("seen_from");
  EXPECT_EQ(rows.row_count, campus().answer("objects").row_count) << "every object was seen";
  expectAscending(rows, "clouds", -1);
  expectWithin(rows, "clouds", 1, static_cast<double>(campus().map().summary().clouds));
  std::map<std::string, std::set<std::string>> clouds_of;  // counted from the points themselves
  for (const Cloud& cloud : campus().map().clouds())
    for (const std::uint32_t object : campus().map().answersFor(cloud).object)
      if (object != kNoObjectOfPoint) clouds_of[campus().map().objects()[object].id.hex()].insert(cloud.id.hex());
  for (std::size_t i = 0; i < rows.row_count; ++i) {
    const std::string iri = textAt(rows, i, "object");
    EXPECT_EQ(numberAt(rows, i, "clouds"), static_cast<double>(clouds_of.at(iri.substr(iri.rfind('/') + 1)).size()))
        << iri;
  }
}

TEST(QuestionsOfACampus, UncertainObjectsAreAllThoseBelowTheBar) {
  const auto& objects = campus().map().objects();
  for (const double bar : {0.5, 0.7, 0.95}) {
    const ResultTable rows = campus().answer("uncertain_objects", {"below=" + std::to_string(bar)});
    expectAscending(rows, "confidence");
    const auto below = std::count_if(objects.begin(), objects.end(), [&](const SemanticObject& object) {
      return std::round(object.confidence * 1000) / 1000 < bar;
    });
    EXPECT_EQ(rows.row_count, static_cast<std::size_t>(below)) << bar;
    for (std::size_t i = 0; i < rows.row_count; ++i) EXPECT_NE(textAt(rows, i, "rule"), "");
  }
}

}  // namespace
}  // namespace cluxel::tasks
