// SPDX-License-Identifier: Apache-2.0
// A record holds what one tile tells of one object: its number and that of the tile, the extremes, and the points that
// may be corners of its hulls.
#include "tasks/export/object_outlines.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "base/convex_hull.hpp"
#include "mapping/clouds/scan_store.hpp"
#include "mapping/damaged_map.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/stored_grid.hpp"
#include "perception/segments/summary_tile.hpp"

namespace cluxel::tasks {

namespace {

using Points = std::vector<Eigen::Vector2d>;

/// Gives an object of one point an area [m].
constexpr double kMargin_m = 0.005;

void addCorners(const Eigen::Vector2d& low, const Eigen::Vector2d& high, Points& points) {
  points.insert(points.end(), {low, {high.x(), low.y()}, {low.x(), high.y()}, high});
}

void addCluxel(const Eigen::Vector3d& low, const Eigen::Vector3f& size_m, ObjectOutline& outline) {
  const Eigen::Vector3d high = low + size_m.cast<double>();
  outline.extent.min = outline.extent.min.cwiseMin(low), outline.extent.max = outline.extent.max.cwiseMax(high);
  addCorners(low.head<2>(), high.head<2>(), outline.extent.corners);
  addCorners(low.head<2>().array() - kMargin_m, high.head<2>().array() + kMargin_m, outline.footprint);
}

void thin(ObjectOutline& outline) {
  outline.footprint = outerPoints(std::move(outline.footprint));
  outline.extent.corners = outerPoints(std::move(outline.extent.corners));
}

/// Numbers of which the bytes sort as they do.
void appendSorted(std::string& record, std::uint32_t number) {
  for (int shift = 24; shift >= 0; shift -= 8) record += static_cast<char>(number >> shift & 0xFFU);
}

std::uint32_t objectOf(std::string_view record) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < 4; ++i) number = number << 8U | static_cast<std::uint8_t>(record[i]);
  return number;
}
constexpr std::size_t kHeadBytes = 2 * sizeof(std::uint32_t);  // object and tile

template <typename T>
void append(std::string& record, const T* values, std::size_t count) {
  record.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

std::string recordOf(std::uint32_t object, std::uint32_t tile, const ObjectOutline& outline) {
  std::string record;
  appendSorted(record, object), appendSorted(record, tile);
  append(record, outline.extent.min.data(), 3), append(record, outline.extent.max.data(), 3);
  const std::array<std::uint64_t, 2> counts{outline.footprint.size(), outline.extent.corners.size()};
  append(record, counts.data(), counts.size());
  append(record, outline.footprint.data(), counts[0]), append(record, outline.extent.corners.data(), counts[1]);
  return record;
}

ObjectOutline outlineOf(std::string_view record) {
  std::size_t at = kHeadBytes;
  const auto take = [&]<typename T>(T* values, std::size_t count) {
    std::memcpy(static_cast<void*>(values), record.data() + at, count * sizeof(T));
    at += count * sizeof(T);
  };
  ObjectOutline outline;
  take(outline.extent.min.data(), 3), take(outline.extent.max.data(), 3);
  std::array<std::uint64_t, 2> counts{};
  take(counts.data(), counts.size());
  outline.footprint.resize(counts[0]), outline.extent.corners.resize(counts[1]);
  take(outline.footprint.data(), counts[0]), take(outline.extent.corners.data(), counts[1]);
  return outline;
}

/// Reads the tiles of a map into records.
class OutlineRecords {
 public:
  OutlineRecords(const mapping::MapReader& map, std::size_t bytes_in_memory)
      : map_(map), grid_(mapping::storedGrid(map.transaction())), records_(bytes_in_memory) {
    std::uint32_t number = 0;
    for (const perception::TileKey& tile : mapping::storedTiles(map.transaction())) addTile(tile, number++);
  }

  void drain(const OutlineVisit& visit) {
    constexpr std::size_t kManyPoints = 20'000;  // of an object that reaches through the map, as ground does
    std::uint32_t object = 0;
    std::size_t thinned = 0;  // points of the outline after it was thinned last
    ObjectOutline outline;
    const auto visitUpTo = [&](std::size_t end) {
      for (; object < end; ++object) visit(object, std::exchange(outline, {})), thinned = 0;
    };
    records_.drain([&](std::string_view record) {
      visitUpTo(objectOf(record));
      const ObjectOutline here = outlineOf(record);
      outline.extent.add(here.extent);
      outline.footprint.insert(outline.footprint.end(), here.footprint.begin(), here.footprint.end());
      if (outline.footprint.size() > kManyPoints + 2 * thinned) thin(outline), thinned = outline.footprint.size();
    });
    visitUpTo(map_.objectIds().size());
  }

 private:
  void addTile(const perception::TileKey& tile, std::uint32_t number) {
    const auto layer = mapping::storedLayer(map_.transaction(), tile);
    if (!layer) mapping::refuseIncompleteTile();
    const auto summary = mapping::ofTile(tile, perception::summaryTileFromBytes(mapping::requiredBlock(
                                                   map_.transaction(), mapping::tables::kSummaries, tile)));
    if (layer->size() != summary.size()) mapping::refuseDamaged("a stored tile does not fit its objects");
    std::map<std::uint32_t, ObjectOutline> outlines;
    std::vector<ObjectOutline*> of_share;
    for (const mapping::TileLayer::Share& share : layer->shares) of_share.push_back(&outlines[numberOf(share.object)]);
    for (std::size_t c = 0; c < summary.size(); ++c)
      if (const std::uint32_t share = layer->share_of_cluxel[c]; share != mapping::kNoShare)
        addCluxel(grid_.cornerOf(tile) + summary.box_min[c].cast<double>(), summary.size_m[c], *of_share.at(share));
    for (auto& [object, outline] : outlines) {
      thin(outline);
      records_.add(recordOf(object, number, outline));
    }
  }

  std::uint32_t numberOf(const ContentHash& object) const {
    const std::vector<ContentHash>& ids = map_.objectIds();
    const auto at = std::lower_bound(ids.begin(), ids.end(), object);
    if (at == ids.end() || *at != object) mapping::refuseDamaged("a tile names an object that is not there");
    return static_cast<std::uint32_t>(at - ids.begin());
  }

  const mapping::MapReader& map_;
  const perception::TileGrid grid_;
  SortedRecords records_;
};

}  // namespace

void forEachOutline(const mapping::MapReader& map, const OutlineVisit& visit, std::size_t bytes_in_memory) {
  OutlineRecords(map, bytes_in_memory).drain(visit);
}

}  // namespace cluxel::tasks
