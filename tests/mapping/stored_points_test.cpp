// SPDX-License-Identifier: Apache-2.0
// Points of scans come back bit for bit; maps of an earlier form of points and tiles are told from damaged ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <functional>
#include <nlohmann/json.hpp>
#include <random>

#include "cluxel/error.hpp"
#include "mapping/change/map_change.hpp"
#include "mapping/clouds/packed_points.hpp"
#include "mapping/clouds/scan_store.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/small_campus.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

ScanPoints randomPoints(std::size_t count, std::uint32_t seed, bool with_all) {
  std::mt19937 random(seed);
  const auto anyFloat = [&] { return std::bit_cast<float>(static_cast<std::uint32_t>(random())); };
  ScanPoints points;
  for (std::size_t i = 0; i < count; ++i) {
    points.x.push_back(anyFloat()), points.y.push_back(anyFloat()), points.z.push_back(anyFloat());
    if (!with_all) continue;
    points.intensity.push_back(anyFloat());
    points.label.push_back(static_cast<std::uint32_t>(random()));
    points.origin.emplace_back(anyFloat(), anyFloat(), anyFloat());
  }
  return points;
}

/// The bits of every array, with their lengths.
std::string bitsOf(const ScanPoints& points) {
  std::string bits;
  const auto add = [&bits](const auto& values) {
    bits += std::to_string(values.size()) + ":";
    bits.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0]));
  };
  add(points.x), add(points.y), add(points.z), add(points.intensity), add(points.label), add(points.origin);
  return bits;
}

std::string errorOf(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::StoreUnavailable);
    return error.what();
  }
  return "none";
}

TEST(PackedPoints, KeepEveryBit) {
  for (const std::size_t count : {0U, 1U, 2U, 5'000U})
    for (const bool with_all : {false, true}) {
      const ScanPoints points = randomPoints(count, 7, with_all);
      EXPECT_TRUE(bitsOf(unpackedPoints(packedPoints(points), points.size())) == bitsOf(points)) << count;
    }
}

TEST(PackedPoints, TellWhetherTheyHaveOriginsWithoutBeingUnpacked) {
  for (const std::size_t count : {1U, 2U, 5'000U})
    for (int kept = 0; kept < 8; ++kept) {
      ScanPoints points = randomPoints(count, 7, true);
      if ((kept & 1) == 0) points.intensity.clear();
      if ((kept & 2) == 0) points.label.clear();
      if ((kept & 4) == 0) points.origin.clear();
      EXPECT_EQ(haveOrigins(packedPoints(points), count), !points.origin.empty()) << count << ' ' << kept;
    }
  EXPECT_FALSE(haveOrigins("", 1));
}

TEST(PackedPoints, OfAScanTakeLessThanTwoThirds) {
  const SmallCampus campus({.seed = 3, .stops = 1, .size_m = 45, .points_per_stop = 20'000});
  const ScanPoints& points = campus.scans()[0].scan.points;
  EXPECT_LT(packedPoints(points).size() * 3, bitsOf(points).size() * 2);
}

TEST(PackedPoints, DamagedOnesAreRefused) {
  const std::string packed = packedPoints(randomPoints(300, 8, true));
  for (std::size_t size = 0; size < packed.size(); size += 1 + packed.size() / 97)
    EXPECT_NE(errorOf([&] { unpackedPoints(packed.substr(0, size), 1'000); }), "none") << size;
  EXPECT_THAT(errorOf([&] { unpackedPoints(packed + "x", 1'000); }), HasSubstr("damaged"));
  ScanPoints uneven = randomPoints(300, 9, false);
  uneven.y.pop_back();
  EXPECT_THAT(errorOf([&] { unpackedPoints(packedPoints(uneven), 1'000); }), HasSubstr("damaged"));
}

/// What the second format of maps wrote: a length before each array, and kinds with an earlier version.
TEST(StoredForms, OfEarlierVersionsAreRefusedInPlainWordsAndTheRdfIsStillRead) {
  const SmallCampus campus({.seed = 3, .stops = 2, .size_m = 45, .points_per_stop = 1'500});
  const ScratchFolder folder;
  const fs::path map = folder.path() / "map.clx";
  buildMap(scansOf(campus.files()), shippedInputs(), map, {}, silence());
  const std::string facts = canonicalText(map);
  const ScanId id = MapReader(map).clouds().at(0).id;
  const auto environment = Environment::open(map, OpenMode::ReadWrite);
  const auto replace = [&](std::string_view table, const std::string& key, std::string_view bytes) {
    WriteTransaction transaction = environment->write();
    transaction.putBlock(table, key, bytes);
    transaction.commit();
  };
  const auto retract = [&] { retractScans(map, {id}, {}, silence()); };
  replace(tables::kScanPoints, tables::keyOf(id), std::string(96, '\0'));
  EXPECT_THAT(errorOf([&] { MapReader(map).pointsOf(id); }), HasSubstr("another version of cluxel"));
  EXPECT_THAT(errorOf(retract), HasSubstr("another version of cluxel"));
  const std::string tile = tables::keyOf(*storedTiles(environment->read()).begin());
  replace(tables::kPoints, tile, std::string("PNTS\2\0\0\0", 8) + std::string(40, '\0'));
  EXPECT_THAT(errorOf([&] { MapReader(map).stagesWithPoints(); }), HasSubstr("PNTS is of another version of cluxel"));
  EXPECT_TRUE(canonicalText(map) == facts);
  EXPECT_GT(MapReader(map).summary().objects, 0U);
}

TEST(StoredTiles, ThatNameAScanWhichIsNotThereAreRefused) {
  const SmallCampus campus({.seed = 3, .stops = 2, .size_m = 45, .points_per_stop = 1'500});
  const ScratchFolder folder;
  const fs::path map = folder.path() / "map.clx";
  buildMap(scansOf(campus.files()), shippedInputs(), map, {}, silence());
  WriteTransaction transaction = Environment::open(map, OpenMode::ReadWrite)->write();
  removeScan(transaction, storedClouds(transaction).at(0).id);
  transaction.commit();
  EXPECT_THAT(errorOf([&] { MapReader(map).stagesWithPoints(); }), HasSubstr("which is not there; the map is damaged"));
}

TEST(StoredInputs, ThatLackASettingAreOfAnotherVersion) {
  const SmallCampus campus({.seed = 3, .stops = 2, .size_m = 45, .points_per_stop = 1'500});
  const ScratchFolder folder;
  const fs::path map = folder.path() / "map.clx";
  buildMap(scansOf(campus.files()), shippedInputs(), map, {}, silence());
  const ScanId id = MapReader(map).clouds().at(0).id;
  WriteTransaction transaction = Environment::open(map, OpenMode::ReadWrite)->write();
  auto inputs = nlohmann::json::from_cbor(*transaction.block(tables::kMeta, "inputs"));
  auto& params = inputs.at("params");
  const std::string setting = params.begin().key();
  params.erase(setting);
  const auto bytes = nlohmann::json::to_cbor(inputs);
  transaction.putBlock(tables::kMeta, "inputs", {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  transaction.commit();
  EXPECT_THAT(errorOf([&] { retractScans(map, {id}, {}, silence()); }),
              HasSubstr("no setting " + setting + ": another version of cluxel wrote it"));
}

}  // namespace
}  // namespace cluxel::mapping
