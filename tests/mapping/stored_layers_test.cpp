// SPDX-License-Identifier: Apache-2.0
// Layers by tile give back the objects of a scene, and a change of some tiles gives the blocks of the whole.
#include "mapping/layers/stored_layers.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "base/packing/zstd_packing.hpp"
#include "cluxel/error.hpp"
#include "mapping/facts/semantic_layer.hpp"
#include "mapping/layers/layer_update.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/small_campus.hpp"
#include "rules/decide/reason.hpp"

namespace cluxel::mapping {
namespace {

ContentHash nameHash(const std::string& text) {
  return ContentHasher().addText(text).finish();
}

/// A cluxel of a world of names.
struct NamedCluxel {
  std::uint32_t component = 0;
  std::string object, part;  ///< empty: of no object
};
struct NamedTile {
  std::vector<std::string> primitive_of;  ///< by component
  std::vector<NamedCluxel> cluxels;
};
using World = std::map<TileKey, NamedTile>;

/// A scene with what reasoning says about it.
struct Told {
  perception::Scene scene;
  std::vector<SemanticObject> objects;
  std::vector<std::uint64_t> traces, inputs;

  SceneLayers layers() const { return {.scene = scene, .objects = objects, .traces = traces, .inputs = inputs}; }
};

std::uint64_t numberOf(const std::string& text) {
  return std::hash<std::string>()(text);
}

void addObjects(const World& world, const std::map<std::string, PrimitiveIndex>& number, Told& told) {
  std::map<ContentHash, std::map<std::string, ObjectPart>> parts;
  std::uint32_t cluxel = 0;
  for (const auto& [key, tile] : world)
    for (const NamedCluxel& named : tile.cluxels) {
      const std::uint32_t here = cluxel++;
      if (named.object.empty()) continue;
      ObjectPart& part = parts[nameHash(named.object)][named.part];
      part.part_class = named.part;
      part.cluxels.push_back(here);
      part.primitives.push_back(number.at(tile.primitive_of[named.component]));
    }
  for (auto& [id, by_class] : parts) {
    SemanticObject object;
    object.id = id;
    object.class_iri = "urn:Class" + id.hex().substr(0, 1);
    object.confidence = 0.5;
    object.rule_id = "rule " + id.hex().substr(1, 1);
    object.is_class_wide = id.bytes[0] % 7 == 0;
    for (auto& [name, part] : by_class) {
      std::sort(part.primitives.begin(), part.primitives.end());
      part.primitives.erase(std::unique(part.primitives.begin(), part.primitives.end()), part.primitives.end());
      object.parts.push_back(part);
    }
    told.objects.push_back(object);
  }
}

/// The scene of the tiles of a world as assembleScene() numbers it.
Told told(const World& world) {
  Told told;
  std::map<ContentHash, std::string> names;
  for (const auto& [key, tile] : world)
    for (const std::string& name : tile.primitive_of) names.emplace(nameHash(name), name);
  std::map<std::string, PrimitiveIndex> number;
  for (const auto& [id, name] : names) {
    number.emplace(name, static_cast<PrimitiveIndex>(told.scene.primitives.size()));
    told.scene.primitives.emplace_back().id = id;
    told.traces.push_back(numberOf("trace of " + name)), told.inputs.push_back(numberOf(name));
  }
  SceneCluxels& cluxels = told.scene.cluxels;
  for (const auto& [key, tile] : world)
    for (std::uint32_t i = 0; i < tile.cluxels.size(); ++i) {
      cluxels.name.push_back({key, i});
      cluxels.component.push_back(tile.cluxels[i].component);
      cluxels.primitive.push_back(number.at(tile.primitive_of[tile.cluxels[i].component]));
      cluxels.low_corner.push_back(TileGrid().cornerOf(key) + Eigen::Vector3d(0.5 * i, 1, 2));
      cluxels.extent.emplace_back(0.25F, 0.5F, 0.75F);
    }
  addObjects(world, number, told);
  return told;
}

NamedTile randomTile(const TileKey& key, std::mt19937& random) {
  const auto below = [&](unsigned bound) { return std::to_string(random() % bound); };
  NamedTile tile;
  const unsigned components = 1 + random() % 4;
  for (unsigned c = 0; c < components; ++c)
    tile.primitive_of.push_back(random() % 3 == 0 ? "long " + below(4)
                                                  : "short " + std::to_string(key.x * 100 + key.y) + " " + below(3));
  for (unsigned i = 0; i < components + random() % 6; ++i) {
    NamedCluxel& cluxel = tile.cluxels.emplace_back();
    cluxel.component = i < components ? i : static_cast<std::uint32_t>(random() % components);
    if (random() % 4 == 0) continue;
    cluxel.object = "object " + below(9);
    cluxel.part = "urn:Part" + below(3);
  }
  return tile;
}

using Blocks = std::map<std::string, std::string>;

Blocks blocksOf(const rdf::ReadTransaction& transaction) {
  Blocks blocks;
  for (const std::string_view table : {tables::kTileLayers, tables::kObjects})
    transaction.forEachBlock(table, "", [&](std::string_view key, std::string_view bytes) {
      blocks.emplace(std::string(table) + " " + std::string(key), bytes);
    });
  return blocks;
}

void expectSame(const std::vector<SemanticObject>& found, const std::vector<SemanticObject>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].id, expected[i].id);
    EXPECT_EQ(found[i].class_iri, expected[i].class_iri);
    EXPECT_EQ(found[i].rule_id, expected[i].rule_id);
    EXPECT_EQ(found[i].confidence, expected[i].confidence);
    EXPECT_EQ(found[i].is_class_wide, expected[i].is_class_wide);
    ASSERT_EQ(found[i].parts.size(), expected[i].parts.size());
    for (std::size_t p = 0; p < found[i].parts.size(); ++p) {
      EXPECT_EQ(found[i].parts[p].part_class, expected[i].parts[p].part_class);
      EXPECT_EQ(found[i].parts[p].primitives, expected[i].parts[p].primitives);
      EXPECT_EQ(found[i].parts[p].cluxels, expected[i].parts[p].cluxels);
    }
  }
}

void storeWhole(WriteTransaction& transaction, const SceneLayers& layers) {
  storeLayers(transaction, layers, layerBlocks(layers));
}

World randomWorld(std::mt19937& random) {
  World world;
  for (int x = -2; x < 3; ++x)
    for (int y = -1; y < 2; ++y)
      if (random() % 5 != 0) world.emplace(TileKey{x, y}, randomTile({x, y}, random));
  return world;
}

TEST(StoredLayers, GiveTheObjectsOfTheSceneBack) {
  std::mt19937 random(1);
  const auto environment = Environment::temporary();
  for (int round = 0; round < 20; ++round) {
    WriteTransaction transaction = environment->write();
    const Told scene = told(randomWorld(random));
    storeWhole(transaction, scene.layers());
    expectSame(storedObjects(transaction), scene.objects);
    EXPECT_EQ(storedTraces(transaction), scene.traces);
    transaction.commit();
  }
}

TEST(StoredLayers, HaveTheSameBlocksForEveryNumberOfThreads) {
  std::mt19937 random(6);
  for (int round = 0; round < 20; ++round) {
    const Told scene = told(randomWorld(random));
    const LayerBlocks expected = layerBlocks(scene.layers());
    for (const unsigned threads : {2U, 5U}) {
      const LayerBlocks blocks = layerBlocks(scene.layers(), threads);
      ASSERT_EQ(blocks.size(), expected.size());
      for (const auto& [tile, block] : blocks) {
        EXPECT_EQ(block.bytes, expected.at(tile).bytes);
        EXPECT_EQ(block.objects, expected.at(tile).objects);
      }
    }
  }
}

TEST(StoredLayers, OfSomeTilesWrittenAnewAreThoseOfTheWhole) {
  std::mt19937 random(2);
  const auto changed = Environment::temporary(), whole = Environment::temporary();
  World world = randomWorld(random);
  WriteTransaction transaction = changed->write();
  storeWhole(transaction, told(world).layers());
  for (int round = 0; round < 60; ++round) {
    TileSet tiles;
    for (unsigned i = 0; i < 1 + random() % 4; ++i) {
      const TileKey key{static_cast<int>(random() % 5) - 2, static_cast<int>(random() % 3) - 1};
      tiles.insert(key);
      world.erase(key);
      if (random() % 4 != 0) world.emplace(key, randomTile(key, random));
    }
    World window;
    for (const auto& [key, tile] : world)
      if (tiles.contains(key) || random() % 2 == 0) window.emplace(key, tile);
    replaceLayers(transaction, told(window).layers(), tiles);
    WriteTransaction from_scratch = whole->write();  // never committed
    storeWhole(from_scratch, told(world).layers());
    ASSERT_EQ(blocksOf(transaction), blocksOf(from_scratch)) << "round " << round;
    expectSame(storedObjects(transaction), told(world).objects);
  }
}

TEST(StoredLayers, HoldTheBoundsOfPrimitivesInTheTile) {
  World world;
  world[{-1, 3}] = {{"a", "b"}, {{0, "", ""}, {1, "", ""}, {0, "", ""}}};
  const auto environment = Environment::temporary();
  WriteTransaction transaction = environment->write();
  storeWhole(transaction, told(world).layers());
  const auto layer = storedLayer(transaction, {-1, 3});
  ASSERT_TRUE(layer);
  ASSERT_EQ(layer->primitives.size(), 2U);
  EXPECT_EQ(layer->primitives[0].bounds.min(), Eigen::Vector3f(0, 1, 2));
  EXPECT_EQ(layer->primitives[0].bounds.max(), Eigen::Vector3f(1.25F, 1.5F, 2.75F));
  EXPECT_EQ(layer->primitives[1].id, nameHash("b"));
  EXPECT_EQ(layer->primitives[1].input, numberOf("b"));
  EXPECT_FALSE(storedLayer(transaction, {0, 0}));
}

TEST(StoredLayers, ThatAreDamagedAreRefused) {
  std::mt19937 random(3);
  const World world = randomWorld(random);
  const auto environment = Environment::temporary();
  WriteTransaction transaction = environment->write();
  storeWhole(transaction, told(world).layers());
  const std::string valid = toBytes(*storedLayer(transaction, world.begin()->first));
  for (std::size_t length = 0; length < valid.size(); ++length)
    EXPECT_THROW(tileLayerFromBytes(valid.substr(0, length)), Error) << length;
  std::size_t refused = 0;
  for (int round = 0; round < 2000; ++round) {
    std::string edited(unpackedBytes(std::string_view(valid).substr(32), 1U << 20U)->view());
    edited[random() % edited.size()] = static_cast<char>(random());
    try {
      const std::string written = toBytes(tileLayerFromBytes(valid.substr(0, 32) + packedBytes(edited)));
      ASSERT_EQ(toBytes(tileLayerFromBytes(written)), written);
    } catch (const Error& error) {
      ASSERT_EQ(error.kind(), ErrorKind::StoreUnavailable);
      ++refused;
    }
  }
  EXPECT_GT(refused, 200U);
}

TEST(StoredLayers, OfObjectsThatAreDamagedAreRefused) {
  const ObjectRecord record{"urn:Class", "rule", 0.75, true, {{-3, 5}, {-3, 6}, {2, -9}}};
  const std::string valid = toBytes(record);
  const ObjectRecord read = objectRecordFromBytes(valid);
  EXPECT_EQ(read.class_iri, record.class_iri);
  EXPECT_EQ(read.tiles, record.tiles);
  EXPECT_EQ(toBytes(read), valid);
  std::mt19937 random(4);
  for (int round = 0; round < 2000; ++round) {
    std::string edited = valid;
    edited[random() % edited.size()] = static_cast<char>(random());
    try {
      objectRecordFromBytes(edited);
    } catch (const Error& error) {
      ASSERT_EQ(error.kind(), ErrorKind::StoreUnavailable);
    }
  }
}

TEST(StoredLayers, ThatDoNotFitTheRecordsAreRefused) {
  World world;
  world[{0, 0}] = {{"a"}, {{0, "tree", "urn:Tree"}}};
  const auto environment = Environment::temporary();
  WriteTransaction transaction = environment->write();
  storeWhole(transaction, told(world).layers());
  transaction.eraseBlock(tables::kObjects, tables::keyOf(nameHash("tree")));
  EXPECT_THROW(storedObjects(transaction), Error);
  storeWhole(transaction, told(world).layers());
  transaction.eraseBlock(tables::kTileLayers, tables::keyOf(TileKey{0, 0}));
  EXPECT_THROW(storedObjects(transaction), Error);
  storeWhole(transaction, told(world).layers());
  EXPECT_EQ(storedObjects(transaction).size(), 1U);
  transaction.putBlock(tables::kMeta, "objects", "of an earlier version");
  EXPECT_THROW(storedObjects(transaction), Error);
}

TEST(StoredLayers, OfAMapAreWhatReasoningSays) {
  const SmallCampus campus({.seed = 5, .stops = 2, .size_m = 45, .points_per_stop = 1500});
  const ScratchFolder folder;
  buildMap(scansOf(campus.files()), shippedInputs(), folder.path() / "map.clx", {}, silence());
  const MapReader map(folder.path() / "map.clx");
  const ParsedInputs parsed = parseInputs(map.inputs());
  ASSERT_FALSE(parsed.rules.asks_map);
  ReasoningResult result = reason(map.scene(), parsed.rules, {});
  EXPECT_EQ(map.decisionTraces(), result.traces);
  EXPECT_GT(result.objects.size(), 5U);
  expectSame(map.objects(), result.objects);
}

}  // namespace
}  // namespace cluxel::mapping
