// SPDX-License-Identifier: Apache-2.0
// What counts as changed beside a primitive that goes on outside of the window.
#include "mapping/window/window_change.hpp"

#include <gmock/gmock.h>

namespace cluxel::mapping {
namespace {

using perception::PrimitiveIndex;
using perception::TileKey;
using testing::ElementsAre;

constexpr double kReach_m = 5;

/// A thing of one cluxel in tile 0, and a wall of one cluxel in tile 1 that continues in tile 2, outside of the window.
/// The map knew both; since the window cuts the wall, the thing's relations are not those that were stored.
MapWindow thingBesideACutWall() {
  MapWindow window;
  window.is_cut = {0, 1};
  perception::Scene& scene = window.scene;
  scene.primitives.resize(2);
  for (PrimitiveIndex i = 0; i < 2; ++i) {
    const TileKey tile{static_cast<std::int32_t>(i), 0};
    const Eigen::Vector3d corner = perception::TileGrid().cornerOf(tile);
    scene.cluxels.name.push_back({tile, 0});
    scene.cluxels.low_corner.push_back(corner);
    scene.cluxels.extent.emplace_back(0.2F, 0.2F, 0.2F);
    scene.cluxels.primitive.push_back(i);
    perception::Primitive& primitive = scene.primitives[i];
    primitive.id = ContentHasher().add(i).finish();
    primitive.cluxels = {i};
    primitive.min = corner;
    primitive.max = corner + Eigen::Vector3d::Constant(0.2);
    window.known.emplace(primitive.id, KnownPrimitive{7, 7});
    window.tiles.insert(tile);
    window.first_cluxel.emplace(tile, i);
    window.primitive_of_component[tile] = {i};
    TileLayer layer;
    layer.key = tile;
    layer.primitives.push_back({primitive.id, 7, 7, {}});
    window.layers.emplace(tile, layer);
  }
  window.elsewhere.insert({2, 0});
  scene.relations.push_back({});
  scene.relations.back().from = 0, scene.relations.back().to = 1;
  indexRelations(scene);
  return window;
}

std::vector<int> dirtyOf(const MapWindow& window, const OutputChanges& changes) {
  const WindowChange change = changeIn(window, changes, {}, kReach_m, [](PrimitiveIndex) { return 1; });
  return {change.is_dirty.begin(), change.is_dirty.end()};
}

TEST(WindowChange, AThingBesideACutOneStaysAsItWas) {
  EXPECT_THAT(dirtyOf(thingBesideACutWall(), {}), ElementsAre(0, 0));
}

TEST(WindowChange, AThingBesideAChangedCutOneIsDirty) {
  OutputChanges changes;
  changes.tiles.insert({1, 0});
  EXPECT_THAT(dirtyOf(thingBesideACutWall(), changes), ElementsAre(1, 1));
}

TEST(WindowChange, ANewThingBesideACutOneIsDirty) {
  MapWindow window = thingBesideACutWall();
  window.known.erase(window.scene.primitives[0].id);
  EXPECT_THAT(dirtyOf(window, {}), ElementsAre(1, 0));
}

TEST(WindowChange, AThingWithOtherInputBesideAWholeOneIsDirty) {
  MapWindow window = thingBesideACutWall();
  window.is_cut = {0, 0};
  EXPECT_THAT(dirtyOf(window, {}), ElementsAre(1, 1));
}

}  // namespace
}  // namespace cluxel::mapping
