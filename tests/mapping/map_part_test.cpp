// SPDX-License-Identifier: Apache-2.0
// The part of a map that is read alone says what the whole map says of it.
#include "mapping/map_part.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "mapping/facts/object_geometry.hpp"
#include "mapping/small_campus.hpp"
#include "rules/explain/explain.hpp"

namespace cluxel::mapping {
namespace {

struct Whole {
  std::map<ContentHash, std::uint64_t> trace_of;
  std::map<ContentHash, const SemanticObject*> object_of;

  explicit Whole(const MapReader& map) {
    const std::vector<std::uint64_t> traces = map.decisionTraces();
    for (std::size_t i = 0; i < traces.size(); ++i) trace_of[map.scene().primitives[i].id] = traces[i];
    for (const SemanticObject& object : map.objects()) object_of[object.id] = &object;
  }
};

/// Seeds of an object's cluxels by part class: numbers differ between scenes, seeds do not.
std::map<std::string, std::multiset<std::pair<ContentHash, std::uint32_t>>> seedsOf(const Scene& scene,
                                                                                    const SemanticObject& object) {
  std::map<std::string, std::multiset<std::pair<ContentHash, std::uint32_t>>> seeds;
  for (const ObjectPart& part : object.parts)
    for (const std::uint32_t cluxel : part.cluxels) {
      const auto [scan, point] = scene.cluxels.seed[cluxel];
      seeds[part.part_class].emplace(scene.cluxels.scans[scan], point);
    }
  return seeds;
}

/// The file of a map of a street, in the folder.
std::filesystem::path builtStreet(const ScratchFolder& folder, double points_per_stop, double max_range_m) {
  const SmallCampus campus(
      {.seed = 5, .stops = 12, .size_m = 150, .points_per_stop = points_per_stop, .max_range_m = max_range_m});
  std::filesystem::path file = folder.path() / "street.clx";
  buildMap(scansOf(campus.files()), shippedInputs(), file, {}, silence());
  return file;
}

TEST(MapPart, HoldsWhatTheMapSaysOfItsTiles) {
  const ScratchFolder folder;
  const MapReader map(builtStreet(folder, 7000, 16));
  const Whole whole(map);
  std::size_t parts = 0, primitives = 0;
  for (std::size_t i = 0; i < map.objects().size(); i += 5) {
    const SemanticObject& object = map.objects()[i];
    const auto part = map.partAroundObject(object.id, {1, 5});
    if (!part) continue;
    ++parts;
    EXPECT_LT(part->scene.cluxels.size(), map.scene().cluxels.size());
    ASSERT_EQ(part->traces.size(), part->scene.primitives.size());
    for (std::size_t k = 0; k < part->traces.size(); ++k) {
      if (part->traces[k] == 0) continue;
      EXPECT_EQ(part->traces[k], whole.trace_of.at(part->scene.primitives[k].id));
      ++primitives;
    }
    const auto own = std::find_if(part->objects.begin(), part->objects.end(),
                                  [&](const SemanticObject& here) { return here.id == object.id; });
    ASSERT_NE(own, part->objects.end());
    EXPECT_EQ(own->class_iri, object.class_iri);
    EXPECT_EQ(own->rule_id, object.rule_id);
    EXPECT_EQ(own->confidence, object.confidence);
    EXPECT_EQ(seedsOf(part->scene, *own), seedsOf(map.scene(), object));
  }
  EXPECT_GE(parts, 8U);
  EXPECT_GE(primitives, 100U);
}

TEST(MapPart, IsAbsentWhenItWouldBeTooLarge) {
  const ScratchFolder folder;
  const MapReader map(builtStreet(folder, 7000, 25));
  std::size_t parts = 0;
  for (const SemanticObject& object : map.objects()) {
    const auto part = map.isClassWide(object.id) ? std::nullopt : map.partAroundObject(object.id, {1, 5});
    if (!part) continue;
    ++parts;
    const std::size_t cluxels = part->scene.cluxels.size();
    EXPECT_TRUE(map.partAroundObject(object.id, {1, 5, cluxels})) << object.id.hex();
    EXPECT_FALSE(map.partAroundObject(object.id, {1, 5, cluxels - 1})) << object.id.hex();
  }
  EXPECT_GE(parts, 10U);
}

/// Trees share crowns that go on beyond the tiles of one tree. A run over a cut crown would decide otherwise.
TEST(MapPart, CutsNoPrimitiveOfTheObjectThatItIsAround) {
  const ScratchFolder folder;
  const MapReader map(builtStreet(folder, 20000, 25));
  std::size_t parts = 0;
  for (const SemanticObject& object : map.objects()) {
    const auto part = map.isClassWide(object.id) ? std::nullopt : map.partAroundObject(object.id, {1, 5});
    if (!part) continue;
    ++parts;
    std::set<ContentHash> whole;
    for (std::size_t i = 0; i < part->traces.size(); ++i)
      if (part->traces[i] != 0) whole.insert(part->scene.primitives[i].id);
    for (const PrimitiveIndex primitive : rules::primitivesOf(object))
      EXPECT_TRUE(whole.contains(map.scene().primitives[primitive].id)) << object.id.hex();
  }
  EXPECT_GE(parts, 20U);
}

/// A run over a part cuts what goes on outside, and decides otherwise about it.
TEST(MapPart, HoldsAllOfTheObjectsThatAreNear) {
  const ScratchFolder folder;
  const MapReader map(builtStreet(folder, 7000, 25));
  const auto box_of = [&](const SemanticObject& object) {
    Eigen::AlignedBox2d box;
    for (const PrimitiveIndex i : rules::primitivesOf(object)) {
      const Primitive& primitive = map.scene().primitives[i];
      box.extend(Eigen::AlignedBox2d(primitive.min.head<2>().eval(), primitive.max.head<2>().eval()));
    }
    return box;
  };
  const SceneCluxels& all = map.scene().cluxels;
  const auto near_objects = [&](const SemanticObject& object) {
    const Eigen::AlignedBox2d around = box_of(object);
    std::vector<const SemanticObject*> near;
    for (const SemanticObject& other : map.objects()) {
      const auto cluxels = cluxelsOf(other);
      if (!other.is_class_wide && std::any_of(cluxels.begin(), cluxels.end(), [&](const std::uint32_t cluxel) {
            return around.exteriorDistance(all.center[cluxel].head<2>().eval()) <= 5;
          }))
        near.push_back(&other);
    }
    return near;
  };
  TileSet map_tiles;
  for (const CluxelName& name : all.name) map_tiles.insert(name.tile);
  std::size_t looked_at = 0, beyond_the_ring = 0;
  for (std::size_t i = 0; i < map.objects().size(); i += 2) {
    const SemanticObject& object = map.objects()[i];
    if (object.is_class_wide) continue;
    const auto part = map.partAroundObject(object.id, {1, 5.1}), ring = map.partAroundObject(object.id, {1, -1});
    if (!part || !ring) continue;
    const std::vector<const SemanticObject*> near = near_objects(object);
    TileSet tiles;
    for (const CluxelName& name : ring->scene.cluxels.name) tiles.insert(name.tile);
    for (const SemanticObject* other : near)
      for (const std::uint32_t cluxel : cluxelsOf(*other)) tiles.insert(all.name[cluxel].tile);
    if (tiles.size() > map_tiles.size() / 2) continue;  // then the part may do without them
    for (const SemanticObject* other : near) {
      const auto is_whole_in = [&](const MapPart& some) {
        const auto here = std::find_if(some.objects.begin(), some.objects.end(),
                                       [&](const SemanticObject& one) { return one.id == other->id; });
        return here != some.objects.end() && seedsOf(some.scene, *here) == seedsOf(map.scene(), *other);
      };
      EXPECT_TRUE(is_whole_in(*part)) << other->class_iri << " near " << object.class_iri;
      ++looked_at;
      beyond_the_ring += is_whole_in(*ring) ? 0 : 1;
    }
  }
  EXPECT_GE(looked_at, 50U);
  EXPECT_GE(beyond_the_ring, 3U) << "the ring alone would do: the test shows nothing";
}

TEST(MapPart, NamesObjectsAndPrimitivesAsTheMapDoes) {
  const SmallCampus campus({.seed = 5, .stops = 3, .size_m = 60, .points_per_stop = 4000, .max_range_m = 16});
  const ScratchFolder folder;
  buildMap(scansOf(campus.files()), shippedInputs(), folder.path() / "street.clx", {}, silence());
  const MapReader map(folder.path() / "street.clx");
  ASSERT_EQ(map.objectIds().size(), map.objects().size());
  for (std::size_t i = 0; i < map.objects().size(); ++i) EXPECT_EQ(map.objectIds()[i], map.objects()[i].id);
  ASSERT_EQ(map.primitiveIds().size(), map.scene().primitives.size());
  for (std::size_t i = 0; i < map.primitiveIds().size(); ++i)
    EXPECT_EQ(map.primitiveIds()[i], map.scene().primitives[i].id);
  EXPECT_EQ(map.summary().objects, map.objects().size());
  EXPECT_FALSE(map.partAroundObject(ContentHash{}, {1, 5})) << "there is no such object";
}

}  // namespace
}  // namespace cluxel::mapping
