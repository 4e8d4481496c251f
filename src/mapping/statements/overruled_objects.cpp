// SPDX-License-Identifier: Apache-2.0
// A CBOR object for each.
#include "mapping/statements/overruled_objects.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "cluxel/error.hpp"
#include "mapping/damaged_map.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/map_tables.hpp"

namespace cluxel::mapping {

namespace {

using Json = nlohmann::json;
using perception::TileKey;

Json partJson(const OverruledRecord::Part& part) {
  Json json{{"class", part.part_class}, {"primitives", Json::array()}, {"tiles", Json::array()}};
  for (const ContentHash& primitive : part.primitives) json["primitives"].push_back(primitive.hex());
  for (const auto& [tile, numbers] : part.cluxels) json["tiles"].push_back({tile.x, tile.y, numbers});
  return json;
}

OverruledRecord::Part partFrom(const Json& json) {
  OverruledRecord::Part part{json.at("class"), {}, {}};
  for (const Json& primitive : json.at("primitives"))
    part.primitives.push_back(ContentHash::fromHex(primitive.get<std::string>()));
  for (const Json& tile : json.at("tiles"))
    part.cluxels[{tile.at(0), tile.at(1)}] = tile.at(2).get<std::vector<std::uint32_t>>();
  return part;
}

std::string bytesOf(const OverruledRecord& record) {
  Json json{{"now", record.now.value_or(ContentHash{}).hex()},
            {"class", record.class_iri},
            {"rule", record.rule_id},
            {"confidence", record.confidence},
            {"class_wide", record.is_class_wide},
            {"parts", Json::array()}};
  for (const OverruledRecord::Part& part : record.parts) json["parts"].push_back(partJson(part));
  const auto bytes = Json::to_cbor(json);
  return {bytes.begin(), bytes.end()};
}

OverruledRecord recordFrom(std::string_view key, std::string_view bytes) {
  try {
    const Json json = Json::from_cbor(bytes);
    const ContentHash now = ContentHash::fromHex(json.at("now").get<std::string>());
    OverruledRecord record{tables::hashOfKey(key),
                           now.isZero() ? std::nullopt : std::optional(now),
                           json.at("class"),
                           json.at("rule"),
                           json.at("confidence"),
                           json.at("class_wide"),
                           {}};
    for (const Json& part : json.at("parts")) record.parts.push_back(partFrom(part));
    return record;
  } catch (const std::exception& fault) {
    throw Error(ErrorKind::StoreUnavailable, std::string("the map's objects that statements changed cannot be read (") +
                                                 fault.what() + "); build the map anew");
  }
}

/// The numbers that the scene of the whole map gives to cluxels and primitives.
class SceneNumbers {
 public:
  explicit SceneNumbers(const rdf::ReadTransaction& transaction) : primitives_(storedPrimitives(transaction)) {
    std::uint32_t first = 0;
    forEachStoredLayer(transaction, [&](const TileLayer& layer) {
      tiles_.emplace(layer.key, Range{first, static_cast<std::uint32_t>(layer.size())});
      first += static_cast<std::uint32_t>(layer.size());
    });
  }

  rules::ObjectPart of(const OverruledRecord::Part& stored) const {
    rules::ObjectPart part{stored.part_class, {}, {}};
    for (const ContentHash& id : stored.primitives) {
      const auto place = std::lower_bound(primitives_.begin(), primitives_.end(), id);
      require(place != primitives_.end() && *place == id);
      part.primitives.push_back(static_cast<perception::PrimitiveIndex>(place - primitives_.begin()));
    }
    std::sort(part.primitives.begin(), part.primitives.end());
    for (const auto& [tile, numbers] : stored.cluxels) {
      const auto range = tiles_.find(tile);
      require(range != tiles_.end());
      for (const std::uint32_t number : numbers) {
        require(number < range->second.count);
        part.cluxels.push_back(range->second.first + number);
      }
    }
    return part;
  }

 private:
  struct Range {
    std::uint32_t first = 0, count = 0;
  };

  static void require(bool holds) {
    if (!holds) refuseDamaged("an object that a statement changed is of tiles that are not there");
  }

  std::vector<ContentHash> primitives_;  ///< ascending
  std::map<TileKey, Range> tiles_;
};

}  // namespace

perception::TileSet tilesOf(const OverruledRecord& record) {
  perception::TileSet tiles;
  for (const OverruledRecord::Part& part : record.parts)
    for (const auto& [tile, numbers] : part.cluxels) tiles.insert(tile);
  return tiles;
}

OverruledRecord recordOf(const OverruledObject& object, const perception::Scene& scene) {
  const rules::SemanticObject& made = object.by_rules;
  OverruledRecord record{made.id, object.now, made.class_iri, made.rule_id, made.confidence, made.is_class_wide, {}};
  for (const rules::ObjectPart& part : made.parts) {
    OverruledRecord::Part& stored = record.parts.emplace_back();
    stored.part_class = part.part_class;
    for (const perception::PrimitiveIndex primitive : part.primitives)
      stored.primitives.push_back(scene.primitives[primitive].id);
    std::sort(stored.primitives.begin(), stored.primitives.end());
    for (const std::uint32_t cluxel : part.cluxels) {
      const perception::CluxelName& name = scene.cluxels.name[cluxel];
      stored.cluxels[name.tile].push_back(name.index);
    }
    for (auto& [tile, numbers] : stored.cluxels) std::sort(numbers.begin(), numbers.end());
  }
  return record;
}

std::vector<OverruledRecord> overruledRecords(const rdf::ReadTransaction& transaction) {
  std::vector<OverruledRecord> records;
  transaction.forEachBlock(tables::kOverruled, "", [&](std::string_view key, std::string_view bytes) {
    records.push_back(recordFrom(key, bytes));
  });
  return records;
}

void putOverruled(rdf::WriteTransaction& transaction, const OverruledRecord& record) {
  transaction.putBlock(tables::kOverruled, tables::keyOf(record.by_rules), bytesOf(record));
}

void eraseOverruled(rdf::WriteTransaction& transaction, const ContentHash& by_rules) {
  transaction.eraseBlock(tables::kOverruled, tables::keyOf(by_rules));
}

void storeOverruled(rdf::WriteTransaction& transaction, const std::vector<OverruledObject>& overruled,
                    const perception::Scene& scene) {
  for (const OverruledRecord& record : overruledRecords(transaction)) eraseOverruled(transaction, record.by_rules);
  for (const OverruledObject& object : overruled) putOverruled(transaction, recordOf(object, scene));
}

std::vector<OverruledObject> storedOverruled(const rdf::ReadTransaction& transaction) {
  const std::vector<OverruledRecord> records = overruledRecords(transaction);
  if (records.empty()) return {};
  const SceneNumbers numbers(transaction);
  std::vector<OverruledObject> overruled;
  for (const OverruledRecord& record : records) {
    rules::SemanticObject made;
    made.id = record.by_rules, made.class_iri = record.class_iri, made.rule_id = record.rule_id;
    made.confidence = record.confidence, made.is_class_wide = record.is_class_wide;
    for (const OverruledRecord::Part& part : record.parts) made.parts.push_back(numbers.of(part));
    overruled.push_back({std::move(made), record.now});
  }
  return overruled;
}

}  // namespace cluxel::mapping
