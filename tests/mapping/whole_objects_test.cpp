// SPDX-License-Identifier: Apache-2.0
// Objects that are read region by region have the cluxels, and the measures, that the scene gives them.
#include "mapping/regions/whole_objects.hpp"

#include <gtest/gtest.h>

#include <set>
#include <utility>

#include "mapping/facts/object_geometry.hpp"
#include "mapping/street_map.hpp"

namespace cluxel::mapping {
namespace {

class WholeObjectsTest : public StreetMap {
 protected:
  /// The seeds of some cluxels, which name them whatever their numbers.
  static std::vector<std::pair<ContentHash, std::uint32_t>> seedsOf(const perception::SceneCluxels& cluxels,
                                                                    const std::vector<std::uint32_t>& members) {
    std::vector<std::pair<ContentHash, std::uint32_t>> seeds;
    for (const std::uint32_t c : members)
      seeds.emplace_back(cluxels.scans[cluxels.seed[c].scan], cluxels.seed[c].point);
    return seeds;
  }

  static void expectSame(const WholeObject& whole) {
    const rules::SemanticObject& expected = map->objects()[whole.number];
    const perception::SceneCluxels& cluxels = map->scene().cluxels;
    EXPECT_EQ(whole.object.id, expected.id);
    EXPECT_EQ(whole.object.class_iri, expected.class_iri);
    EXPECT_EQ(whole.object.confidence, expected.confidence);
    ASSERT_EQ(whole.object.parts.size(), expected.parts.size());
    for (std::size_t i = 0; i < expected.parts.size(); ++i) {
      const rules::ObjectPart &part = whole.object.parts[i], &of_scene = expected.parts[i];
      EXPECT_EQ(part.part_class, of_scene.part_class);
      EXPECT_EQ(seedsOf(whole.cluxels, part.cluxels), seedsOf(cluxels, of_scene.cluxels));
    }
    const ObjectGeometry geometry = geometryOf(whole.cluxels, cluxelsOf(whole.object));
    const ObjectGeometry of_scene = geometryOf(cluxels, cluxelsOf(expected));
    EXPECT_EQ(geometry.centroid, of_scene.centroid);
    EXPECT_EQ(geometry.top_m, of_scene.top_m);
    EXPECT_EQ(geometry.box.yaw_rad, of_scene.box.yaw_rad);
  }
};

TEST_F(WholeObjectsTest, AreThoseOfTheSceneWhateverTheRegions) {
  const std::vector<bool> all(map->objects().size(), true);
  ASSERT_GT(all.size(), 5U);
  for (const std::size_t max_cluxels : {std::size_t{1}, std::size_t{1500}, map->scene().cluxels.size()}) {
    std::vector<int> visits(all.size(), 0);
    forEachWholeObject(
        *map, all,
        [&](const WholeObject& whole) {
          ++visits.at(whole.number);
          expectSame(whole);
        },
        max_cluxels);
    EXPECT_EQ(visits, std::vector<int>(all.size(), 1));
  }
}

TEST_F(WholeObjectsTest, OnlyThoseThatAreWantedAreVisited) {
  std::vector<bool> is_wanted(map->objects().size(), false);
  is_wanted[1] = is_wanted[3] = true;
  std::set<std::uint32_t> visited;
  forEachWholeObject(*map, is_wanted, [&](const WholeObject& whole) {
    visited.insert(whole.number);
    expectSame(whole);
  });
  EXPECT_EQ(visited, (std::set<std::uint32_t>{1, 3}));
}

}  // namespace
}  // namespace cluxel::mapping
