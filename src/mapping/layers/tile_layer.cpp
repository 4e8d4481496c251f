// SPDX-License-Identifier: Apache-2.0
// Stored form of the layers of a tile. Each name of a class is stored once.
#include "mapping/layers/tile_layer.hpp"

#include <algorithm>
#include <functional>
#include <set>
#include <tuple>

#include "perception/clustering/tile_points.hpp"
#include "perception/tile_bytes.hpp"

namespace cluxel::mapping {

namespace {

using perception::TileReader;
using perception::TileWriter;
using Numbers = std::vector<std::uint32_t>;

constexpr std::string_view kLayerKind = "LAYR";
constexpr std::uint32_t kLayerVersion = 1;

void putText(TileWriter& writer, const std::string& text) {
  writer.put(std::vector<char>(text.begin(), text.end()));
}

std::string textFrom(TileReader& reader) {
  const auto characters = reader.getMany<char>();
  return {characters.begin(), characters.end()};
}

void putPrimitives(TileWriter& writer, const std::vector<TileLayer::PrimitiveHere>& primitives) {
  std::vector<ContentHash> ids;
  std::vector<std::uint64_t> inputs, traces;
  std::vector<Eigen::Vector3f> low, high;
  for (const TileLayer::PrimitiveHere& primitive : primitives) {
    ids.push_back(primitive.id);
    inputs.push_back(primitive.input), traces.push_back(primitive.trace);
    low.push_back(primitive.bounds.min()), high.push_back(primitive.bounds.max());
  }
  writer.put(ids), writer.put(inputs), writer.put(traces);
  writer.put(low), writer.put(high);
}

std::vector<TileLayer::PrimitiveHere> primitivesFrom(TileReader& reader) {
  const auto ids = reader.getMany<ContentHash>();
  const auto inputs = reader.getMany<std::uint64_t>(ids.size()), traces = reader.getMany<std::uint64_t>(ids.size());
  const auto low = reader.getMany<Eigen::Vector3f>(ids.size()), high = reader.getMany<Eigen::Vector3f>(ids.size());
  for (const auto* corners : {&low, &high})
    reader.require(perception::allWithin(*corners, perception::kMaxHeight_m + perception::kTileSize_m),
                   "has a primitive that is too far away");
  std::vector<TileLayer::PrimitiveHere> primitives;
  for (std::size_t i = 0; i < ids.size(); ++i)
    primitives.push_back({ids[i], inputs[i], traces[i], Eigen::AlignedBox3f(low[i], high[i])});
  return primitives;
}

void putShares(TileWriter& writer, const std::vector<TileLayer::Share>& shares) {
  std::set<std::string> classes;
  for (const TileLayer::Share& share : shares) classes.insert(share.part_class);
  std::vector<ContentHash> objects;
  Numbers class_of, counts, components;
  for (const TileLayer::Share& share : shares) {
    objects.push_back(share.object);
    class_of.push_back(static_cast<std::uint32_t>(std::distance(classes.begin(), classes.find(share.part_class))));
    counts.push_back(static_cast<std::uint32_t>(share.components.size()));
    components.insert(components.end(), share.components.begin(), share.components.end());
  }
  writer.put(static_cast<std::uint32_t>(classes.size()));
  for (const std::string& name : classes) putText(writer, name);
  writer.put(objects), writer.put(class_of), writer.put(counts), writer.put(components);
}

bool areAscending(const std::vector<TileLayer::Share>& shares) {
  for (std::size_t i = 1; i < shares.size(); ++i)
    if (std::tie(shares[i - 1].object, shares[i - 1].part_class) >= std::tie(shares[i].object, shares[i].part_class))
      return false;
  return true;
}

/// The components of each share, of which there are `count`.
std::vector<Numbers> componentsFrom(TileReader& reader, std::size_t count, std::size_t primitives) {
  const Numbers counts = reader.getMany<std::uint32_t>(count), all = reader.getMany<std::uint32_t>();
  reader.require(perception::allBelow(all, primitives), "names a component that is not there");
  std::vector<Numbers> by_share;
  std::size_t at = 0;
  for (const std::uint32_t own : counts) {
    reader.require(own > 0 && own <= all.size() - at, "has shares of other components");
    const auto begin = all.begin() + static_cast<std::ptrdiff_t>(at);
    by_share.emplace_back(begin, begin + own);
    reader.require(std::adjacent_find(begin, begin + own, std::greater_equal<>()) == begin + own,
                   "has components out of order");
    at += own;
  }
  reader.require(at == all.size(), "has components of no share");
  return by_share;
}

std::vector<TileLayer::Share> sharesFrom(TileReader& reader, std::size_t primitives) {
  std::vector<std::string> classes;
  for (auto left = reader.get<std::uint32_t>(); left > 0; --left) classes.push_back(textFrom(reader));
  const auto objects = reader.getMany<ContentHash>();
  const Numbers class_of = reader.getMany<std::uint32_t>(objects.size());
  reader.require(perception::allBelow(class_of, classes.size()), "names a class that it does not list");
  const std::vector<Numbers> components = componentsFrom(reader, objects.size(), primitives);
  std::vector<TileLayer::Share> shares;
  for (std::size_t i = 0; i < objects.size(); ++i) shares.push_back({objects[i], classes[class_of[i]], components[i]});
  reader.require(areAscending(shares), "has shares out of order");
  return shares;
}

/// 0 stands for no share, so that small numbers come first.
Numbers shiftedUp(Numbers shares) {
  for (std::uint32_t& share : shares) ++share;
  return shares;
}

Numbers cluxelsFrom(TileReader& reader, std::size_t shares) {
  Numbers share_of = reader.getMany<std::uint32_t>();
  std::vector<bool> has_cluxel(shares, false);
  for (std::uint32_t& share : share_of) {
    reader.require(share <= shares, "names a share that is not there");
    --share;
    if (share != kNoShare) has_cluxel[share] = true;
  }
  reader.require(std::all_of(has_cluxel.begin(), has_cluxel.end(), [](bool has) { return has; }),
                 "has a share without cluxels");
  return share_of;
}

}  // namespace

Eigen::AlignedBox2d boxInMap(const TileLayer::PrimitiveHere& primitive, const Eigen::Vector3d& corner) {
  return {Eigen::Vector2d(corner.head<2>() + primitive.bounds.min().head<2>().cast<double>()),
          Eigen::Vector2d(corner.head<2>() + primitive.bounds.max().head<2>().cast<double>())};
}

std::string toBytes(const TileLayer& layer) {
  TileWriter writer(kLayerKind, kLayerVersion, layer.key);
  putPrimitives(writer, layer.primitives);
  putShares(writer, layer.shares);
  writer.put(shiftedUp(layer.share_of_cluxel));
  return writer.take();
}

TileLayer tileLayerFromBytes(std::string_view bytes) {
  TileReader reader(bytes, kLayerKind, kLayerVersion);
  TileLayer layer;
  layer.key = reader.key();
  layer.primitives = primitivesFrom(reader);
  layer.shares = sharesFrom(reader, layer.primitives.size());
  layer.share_of_cluxel = cluxelsFrom(reader, layer.shares.size());
  reader.finish();
  return layer;
}

}  // namespace cluxel::mapping
