// SPDX-License-Identifier: Apache-2.0
// A CBOR object; tiles as planes of the differences of their coordinates.
#include "mapping/layers/object_record.hpp"

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>

#include "base/packing/zstd_packing.hpp"
#include "mapping/damaged_map.hpp"

namespace cluxel::mapping {

namespace {

using Json = nlohmann::json;
using perception::TileKey;
/// The tiles of 100 million square kilometres.
constexpr std::uint64_t kMaxTileBytes = std::uint64_t{1} << 32U;

Json tilesJson(const std::vector<TileKey>& tiles) {
  std::vector<std::uint32_t> x, y;
  for (const TileKey& tile : tiles) {
    x.push_back(static_cast<std::uint32_t>(tile.x));
    y.push_back(static_cast<std::uint32_t>(tile.y));
  }
  std::string planes;
  appendArray(planes, differencesOf(x));
  appendArray(planes, differencesOf(y));
  const std::string packed = packedBytes(planes);
  return Json::binary({packed.begin(), packed.end()});
}

std::vector<TileKey> tilesFrom(const Json& json) {
  const auto& packed = json.get_binary();
  const auto unpacked = unpackedBytes({reinterpret_cast<const char*>(packed.data()), packed.size()}, kMaxTileBytes);
  if (!unpacked) throw std::invalid_argument("its tiles cannot be unpacked");
  std::string_view planes = unpacked->view();
  auto x = takeArray<std::uint32_t>(planes), y = takeArray<std::uint32_t>(planes);
  if (!x || !y || x->size() != y->size() || !planes.empty()) throw std::invalid_argument("its tiles are cut short");
  sumUp(*x), sumUp(*y);
  std::vector<TileKey> tiles;
  for (std::size_t i = 0; i < x->size(); ++i)
    tiles.push_back({static_cast<std::int32_t>((*x)[i]), static_cast<std::int32_t>((*y)[i])});
  if (std::adjacent_find(tiles.begin(), tiles.end(), std::greater_equal<>()) != tiles.end())
    throw std::invalid_argument("its tiles are out of order");
  return tiles;
}

}  // namespace

std::string toBytes(const ObjectRecord& record) {
  const Json json{{"class", record.class_iri},
                  {"rule", record.rule_id},
                  {"confidence", record.confidence},
                  {"class_wide", record.is_class_wide},
                  {"tiles", tilesJson(record.tiles)}};
  const auto bytes = Json::to_cbor(json);
  return {bytes.begin(), bytes.end()};
}

ObjectRecord objectRecordFromBytes(std::string_view bytes) {
  try {
    const Json json = Json::from_cbor(bytes);
    return {json.at("class"), json.at("rule"), json.at("confidence"), json.at("class_wide"),
            tilesFrom(json.at("tiles"))};
  } catch (const std::exception& fault) {
    refuseDamaged(std::string("a stored object cannot be read (") + fault.what() + ")");
  }
}

}  // namespace cluxel::mapping
