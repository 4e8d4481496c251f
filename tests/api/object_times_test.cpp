// SPDX-License-Identifier: Apache-2.0
// When objects were there, and which are gone: the facade tells what the map states.
#include <gtest/gtest.h>

#include "api/facade_campus.hpp"
#include "tasks/box_visits.hpp"

namespace cluxel {
namespace {

TEST(ObjectTimes, AreThoseThatTheMapStates) {
  const rdf::ScratchFolder folder;
  const auto north = tasks::boxFrom({-15, 10, 0}, {15, 10.5, 5});
  const auto stays = tasks::boxFrom({-5, 4, 0.25}, {-0.8, 5.8, 1.5}),
             leaves = tasks::boxFrom({2, 4, 0.25}, {6, 5.8, 1.5});
  const std::vector<Eigen::Vector3d> sensors{{-3, 0, 1.8}, {5, 0, 1.8}};
  tasks::writeVisits({{{north, stays, leaves}, sensors}, {{north, stays}, sensors}}, folder.path() / "scans");
  const Map map = Map::build({folder.path() / "scans"}, folder.path() / "map.clx", FacadeCampus::options());
  const Answer answer = map.query(
      "PREFIX clx: <https://w3id.org/cluxel/ontology#> SELECT ?o ?first ?last ?through { ?o clx:confidence ?c "
      "OPTIONAL { ?o clx:firstSeen ?first } OPTIONAL { ?o clx:lastSeen ?last } "
      "OPTIONAL { ?o clx:seenThrough ?through } } ORDER BY ?o");
  const std::vector<Object> objects = map.objects();
  ASSERT_EQ(objects.size(), answer.size());
  std::size_t gone = 0, without = 0;
  for (const Object& object : objects) {
    const Answer::Row row = answer[object.number];
    EXPECT_EQ(row.text("o"), object.iri);
    EXPECT_EQ(row.text("first"), object.first_seen.value_or(""));
    EXPECT_EQ(row.text("last"), object.last_seen.value_or(""));
    EXPECT_EQ(row.text("through"), object.seen_through.value_or(""));
    gone += object.seen_through ? 1 : 0;
    without += object.first_seen ? 0 : 1;
    if (object.seen_through) {
      EXPECT_LT(object.last_seen, object.seen_through);
      EXPECT_GT(object.min.x, 1) << "the car that left";
    }
  }
  EXPECT_EQ(gone, 1U);
  EXPECT_EQ(without, map.objects("Ground").size());
}

}  // namespace
}  // namespace cluxel
