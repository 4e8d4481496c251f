// SPDX-License-Identifier: Apache-2.0
// Sums, extremes and hulls of class-wide objects, tile by tile.
#include "mapping/layers/wide_tile.hpp"

#include <algorithm>
#include <cmath>

#include "base/convex_hull.hpp"
#include "mapping/damaged_map.hpp"
#include "mapping/map_tables.hpp"
#include "perception/tile_bytes.hpp"

namespace cluxel::mapping {

namespace {

using perception::TileKey;

constexpr std::string_view kWideKind = "WIDE";
constexpr std::uint32_t kWideVersion = 1;

/// Adds what each scan saw of a cluxel. `corner`: of its tile [m, map].
void addViews(const perception::SummaryTile& tile, const Eigen::Vector3d& corner, std::uint32_t cluxel,
              std::map<scan::ScanId, Sighting>& seen) {
  for (std::uint32_t view = tile.view_offset[cluxel]; view < tile.view_offset[cluxel + 1]; ++view) {
    Sighting& sighting = seen[tile.scans[tile.view_scan[view]]];
    sighting.point_count += tile.view_point_count[view];
    sighting.sum += tile.view_point_count[view] * (corner + tile.viewMean(cluxel, view));
  }
}

void putPart(perception::TileWriter& writer, const WidePart& part) {
  const ExtentSums& sums = part.sums;
  writer.put(std::vector<ContentHash>{part.object});
  writer.put(std::vector<char>(part.part_class.begin(), part.part_class.end()));
  for (const Eigen::Vector3d* vector : {&sums.min, &sums.max, &sums.weighted_centre})
    for (int axis = 0; axis < 3; ++axis) writer.put((*vector)[axis]);
  writer.put(sums.point_count), writer.put(sums.bottom_m), writer.put(sums.top_m);
  std::vector<double> corners;
  for (const Eigen::Vector2d& corner : sums.corners) corners.insert(corners.end(), {corner.x(), corner.y()});
  writer.put(corners);
  std::vector<ContentHash> scans;
  std::vector<std::uint64_t> counts;
  std::vector<double> places;
  for (const auto& [scan, sighting] : part.seen) {
    scans.push_back(scan), counts.push_back(sighting.point_count);
    places.insert(places.end(), {sighting.sum.x(), sighting.sum.y(), sighting.sum.z()});
  }
  writer.put(scans), writer.put(counts), writer.put(places);
}

WidePart partFrom(perception::TileReader& reader) {
  WidePart part;
  part.object = reader.getMany<ContentHash>(1).front();
  const auto name = reader.getMany<char>();
  part.part_class.assign(name.begin(), name.end());
  ExtentSums& sums = part.sums;
  for (Eigen::Vector3d* vector : {&sums.min, &sums.max, &sums.weighted_centre})
    for (int axis = 0; axis < 3; ++axis) (*vector)[axis] = reader.get<double>();
  sums.point_count = reader.get<std::uint64_t>();
  sums.bottom_m = reader.get<double>(), sums.top_m = reader.get<double>();
  const auto corners = reader.getMany<double>();
  reader.require(corners.size() % 2 == 0, "has half a corner");
  for (std::size_t i = 0; i < corners.size(); i += 2) sums.corners.emplace_back(corners[i], corners[i + 1]);
  const auto scans = reader.getMany<ContentHash>();
  const auto counts = reader.getMany<std::uint64_t>(scans.size());
  const auto places = reader.getMany<double>(3 * scans.size());
  reader.require(std::none_of(counts.begin(), counts.end(), [](std::uint64_t count) { return count == 0; }) &&
                     std::all_of(places.begin(), places.end(), [](double value) { return std::isfinite(value); }) &&
                     std::all_of(corners.begin(), corners.end(), [](double value) { return std::isfinite(value); }),
                 "has numbers that cannot be");
  for (std::size_t i = 0; i < scans.size(); ++i)
    part.seen.emplace(scans[i], Sighting{counts[i], {places[3 * i], places[3 * i + 1], places[3 * i + 2]}});
  return part;
}

}  // namespace

void WidePart::add(const WidePart& other) {
  sums.add(other.sums);
  for (const auto& [scan, sighting] : other.seen) {
    Sighting& sum = seen[scan];
    sum.point_count += sighting.point_count;
    sum.sum += sighting.sum;
  }
}

std::vector<WideTile> wideTilesOf(const perception::Scene& scene,
                                  const std::map<TileKey, perception::SummaryTile>& summaries,
                                  const std::vector<rules::SemanticObject>& objects) {
  std::map<TileKey, std::map<std::pair<ContentHash, std::string>, std::vector<std::uint32_t>>> members;
  for (const rules::SemanticObject& object : objects) {
    if (!object.is_class_wide) continue;
    for (const rules::ObjectPart& part : object.parts)
      for (const std::uint32_t cluxel : part.cluxels)
        members[scene.cluxels.name[cluxel].tile][{object.id, part.part_class}].push_back(cluxel);
  }
  std::vector<WideTile> tiles;
  for (const auto& [key, of_tile] : members) {
    WideTile& tile = tiles.emplace_back(WideTile{key, {}});
    for (const auto& [name, cluxels] : of_tile) {
      WidePart& part = tile.parts.emplace_back(WidePart{name.first, name.second, sumsOf(scene.cluxels, cluxels), {}});
      part.sums.corners = convexHull(std::move(part.sums.corners));
      for (const std::uint32_t cluxel : cluxels)
        addViews(summaries.at(key), scene.cluxels.grid.cornerOf(key), scene.cluxels.name[cluxel].index, part.seen);
    }
  }
  return tiles;
}

std::string toBytes(const WideTile& tile) {
  perception::TileWriter writer(kWideKind, kWideVersion, tile.key);
  writer.put(static_cast<std::uint32_t>(tile.parts.size()));
  for (const WidePart& part : tile.parts) putPart(writer, part);
  return writer.take();
}

WideTile wideTileFromBytes(std::string_view bytes) {
  perception::TileReader reader(bytes, kWideKind, kWideVersion);
  WideTile tile;
  tile.key = reader.key();
  const auto count = reader.get<std::uint32_t>();
  for (std::uint32_t i = 0; i < count; ++i) tile.parts.push_back(partFrom(reader));
  reader.finish();
  return tile;
}

void storeWideTiles(rdf::WriteTransaction& transaction, const std::vector<WideTile>& wide) {
  perception::TileSet stored;
  transaction.forEachBlock(tables::kWideTiles, "",
                           [&](std::string_view key, std::string_view) { stored.insert(tables::tileOfKey(key)); });
  replaceWideTiles(transaction, wide, stored);
}

void replaceWideTiles(rdf::WriteTransaction& transaction, const std::vector<WideTile>& wide,
                      const perception::TileSet& tiles) {
  perception::TileSet empty = tiles;
  for (const WideTile& tile : wide) {
    empty.erase(tile.key);
    transaction.putIfDifferent(tables::kWideTiles, tables::keyOf(tile.key), toBytes(tile));
  }
  for (const TileKey& tile : empty) transaction.eraseBlock(tables::kWideTiles, tables::keyOf(tile));
}

std::vector<WideTile> storedWideTiles(const rdf::ReadTransaction& transaction) {
  std::vector<WideTile> tiles;
  transaction.forEachBlock(tables::kWideTiles, "", [&](std::string_view key, std::string_view bytes) {
    tiles.push_back(ofTile(tables::tileOfKey(key), wideTileFromBytes(bytes)));
  });
  return tiles;
}

std::vector<WidePart> mergedParts(const std::vector<WideTile>& tiles) {
  std::map<std::pair<ContentHash, std::string>, WidePart> merged;
  for (const WideTile& tile : tiles)
    for (const WidePart& part : tile.parts)
      merged.try_emplace({part.object, part.part_class}, WidePart{part.object, part.part_class, {}, {}})
          .first->second.add(part);
  std::vector<WidePart> parts;
  for (auto& [name, part] : merged) parts.push_back(std::move(part));
  return parts;
}

}  // namespace cluxel::mapping
