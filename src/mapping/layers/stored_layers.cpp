// SPDX-License-Identifier: Apache-2.0
// Composes the objects of the map from the shares of all tiles.
#include "mapping/layers/stored_layers.hpp"

#include <algorithm>
#include <map>
#include <unordered_map>

#include "cluxel/error.hpp"
#include "mapping/damaged_map.hpp"
#include "mapping/map_tables.hpp"

namespace cluxel::mapping {

namespace {

[[noreturn]] void failUnfit(const char* what) {
  refuseDamaged(std::string("the map's objects cannot be read: ") + what);
}

/// Maps of earlier versions hold all objects in one block.
void refuseEarlierForm(const rdf::ReadTransaction& transaction) {
  if (transaction.block(tables::kMeta, "objects"))
    throw Error(ErrorKind::StoreUnavailable,
                "the map's objects are stored in the form of another version of cluxel; build the map anew");
}

TileLayer checkedLayer(const perception::TileKey& tile, std::string_view bytes) {
  TileLayer layer = tileLayerFromBytes(bytes);
  if (layer.key != tile) failUnfit("a tile has the layers of another");
  return layer;
}

class Composition {
 public:
  explicit Composition(const rdf::ReadTransaction& transaction) : transaction_(transaction) {}

  std::vector<rules::SemanticObject> run() {
    readRecords();
    forEachStoredLayer(transaction_, [this](const TileLayer& layer) { add(layer); });
    rankPrimitives();
    return std::move(objects_);
  }

 private:
  void readRecords() {
    forEachRecord(transaction_, [this](const ContentHash& id, const ObjectRecord& record) {
      rules::SemanticObject& object = objects_.emplace_back();
      object.id = id;
      object.class_iri = record.class_iri;
      object.rule_id = record.rule_id;
      object.confidence = record.confidence;
      object.is_class_wide = record.is_class_wide;
      number_of_.emplace(object.id, objects_.size() - 1);
    });
  }

  std::vector<rules::ObjectPart>& partsOf(const ContentHash& object) {
    const auto found = number_of_.find(object);
    if (found == number_of_.end()) failUnfit("a tile names an object that is not there");
    return objects_[found->second].parts;
  }

  /// Adds the parts of objects that a tile holds. Primitives are numbered as they arrive; rankPrimitives() sorts them.
  void add(const TileLayer& layer) {
    std::vector<std::uint32_t> primitive_of;
    for (const TileLayer::PrimitiveHere& primitive : layer.primitives)
      primitive_of.push_back(
          arrival_.try_emplace(primitive.id, static_cast<std::uint32_t>(arrival_.size())).first->second);
    std::vector<std::vector<std::uint32_t>> cluxels(layer.shares.size());
    for (std::size_t i = 0; i < layer.size(); ++i)
      if (layer.share_of_cluxel[i] != kNoShare)
        cluxels[layer.share_of_cluxel[i]].push_back(first_cluxel_ + static_cast<std::uint32_t>(i));
    for (std::size_t s = 0; s < layer.shares.size(); ++s) {
      rules::ObjectPart& part = partNamed(layer.shares[s]);
      part.cluxels.insert(part.cluxels.end(), cluxels[s].begin(), cluxels[s].end());
      for (const std::uint32_t component : layer.shares[s].components)
        part.primitives.push_back(primitive_of[component]);
    }
    first_cluxel_ += static_cast<std::uint32_t>(layer.size());
  }

  rules::ObjectPart& partNamed(const TileLayer::Share& share) {
    std::vector<rules::ObjectPart>& parts = partsOf(share.object);
    const auto place =
        std::lower_bound(parts.begin(), parts.end(), share.part_class,
                         [](const auto& part, const std::string& name) { return part.part_class < name; });
    if (place != parts.end() && place->part_class == share.part_class) return *place;
    return *parts.insert(place, {share.part_class, {}, {}});
  }

  /// Numbers primitives as the scene does, which sorts them by id.
  void rankPrimitives() {
    std::vector<std::pair<ContentHash, std::uint32_t>> order(arrival_.begin(), arrival_.end());
    std::sort(order.begin(), order.end());
    std::vector<std::uint32_t> rank(order.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) rank[order[i].second] = i;
    for (rules::SemanticObject& object : objects_) {
      if (object.parts.empty()) failUnfit("an object has no cluxels");
      for (rules::ObjectPart& part : object.parts) {
        for (perception::PrimitiveIndex& primitive : part.primitives) primitive = rank[primitive];
        std::sort(part.primitives.begin(), part.primitives.end());
        part.primitives.erase(std::unique(part.primitives.begin(), part.primitives.end()), part.primitives.end());
      }
    }
  }

  const rdf::ReadTransaction& transaction_;
  std::vector<rules::SemanticObject> objects_;
  std::unordered_map<ContentHash, std::size_t> number_of_;
  std::unordered_map<ContentHash, std::uint32_t> arrival_;
  std::uint32_t first_cluxel_ = 0;
};

}  // namespace

std::optional<TileLayer> storedLayer(const rdf::ReadTransaction& transaction, const perception::TileKey& tile) {
  const auto bytes = transaction.block(tables::kTileLayers, tables::keyOf(tile));
  return bytes ? std::optional(checkedLayer(tile, *bytes)) : std::nullopt;
}

std::optional<ObjectRecord> storedRecord(const rdf::ReadTransaction& transaction, const ContentHash& object) {
  const auto bytes = transaction.block(tables::kObjects, tables::keyOf(object));
  return bytes ? std::optional(objectRecordFromBytes(*bytes)) : std::nullopt;
}

void forEachStoredLayer(const rdf::ReadTransaction& transaction, const std::function<void(const TileLayer&)>& visit) {
  refuseEarlierForm(transaction);
  transaction.forEachBlock(tables::kTileLayers, "", [&](std::string_view key, std::string_view bytes) {
    visit(checkedLayer(tables::tileOfKey(key), bytes));
  });
}

std::vector<ContentHash> storedObjectIds(const rdf::ReadTransaction& transaction) {
  refuseEarlierForm(transaction);
  std::vector<ContentHash> ids;
  transaction.forEachBlock(tables::kObjects, "", [&](std::string_view key, std::string_view /*bytes*/) {
    ids.push_back(tables::hashOfKey(key));
  });
  return ids;
}

void forEachRecord(const rdf::ReadTransaction& transaction,
                   const std::function<void(const ContentHash&, const ObjectRecord&)>& visit) {
  refuseEarlierForm(transaction);
  transaction.forEachBlock(tables::kObjects, "", [&](std::string_view key, std::string_view bytes) {
    visit(tables::hashOfKey(key), objectRecordFromBytes(bytes));
  });
}

std::vector<rules::SemanticObject> storedObjects(const rdf::ReadTransaction& transaction) {
  return Composition(transaction).run();
}

std::vector<ContentHash> storedPrimitives(const rdf::ReadTransaction& transaction) {
  std::vector<ContentHash> ids;
  forEachStoredLayer(transaction, [&](const TileLayer& layer) {
    for (const TileLayer::PrimitiveHere& primitive : layer.primitives) ids.push_back(primitive.id);
  });
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

std::vector<std::uint64_t> storedTraces(const rdf::ReadTransaction& transaction) {
  std::map<ContentHash, std::uint64_t> traces;
  forEachStoredLayer(transaction, [&](const TileLayer& layer) {
    for (const TileLayer::PrimitiveHere& primitive : layer.primitives) traces.emplace(primitive.id, primitive.trace);
  });
  std::vector<std::uint64_t> in_order;
  for (const auto& [id, trace] : traces) in_order.push_back(trace);
  return in_order;
}

}  // namespace cluxel::mapping
