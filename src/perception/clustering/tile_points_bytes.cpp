// SPDX-License-Identifier: Apache-2.0
// Stored form of scan segments and tile points.
#include "perception/clustering/tile_points.hpp"
#include "perception/tile_bytes.hpp"

namespace cluxel::perception {
namespace {

bool isInTile(const std::vector<float>& values) {
  for (const float value : values)
    if (!(value >= 0.0F && value < static_cast<float>(kTileSize_m))) return false;
  return true;
}

template <typename Part>
void putPoints(TileWriter& writer, const Part& part) {
  writer.put(part.x);
  writer.put(part.y);
  writer.put(part.z);
  writer.put(part.intensity);
  writer.put(part.point);
  writer.put(part.rank);
}

template <typename Part>
void getPoints(TileReader& reader, Part& part) {
  part.x = reader.getMany<float>();
  part.y = reader.getMany<float>(part.x.size());
  part.z = reader.getMany<float>(part.x.size());
  part.intensity = reader.getMany<float>(part.x.size(), true);
  part.point = reader.getMany<std::uint32_t>(part.x.size());
  part.rank = reader.getMany<std::uint32_t>(part.x.size());
  reader.require(isInTile(part.x) && isInTile(part.y) && allWithin(part.z, kMaxHeight_m),
                 "has points outside its tile");
}

}  // namespace

std::string toBytes(const ScanSegment& segment) {
  TileWriter writer("SEGM", 2, segment.key);
  writer.put(std::vector<scan::ScanId>{segment.scan});
  putPoints(writer, segment);
  return writer.take();
}

ScanSegment scanSegmentFromBytes(std::string_view bytes) {
  TileReader reader(bytes, "SEGM", 2);
  ScanSegment segment;
  segment.key = reader.key();
  segment.scan = reader.getMany<scan::ScanId>(1).front();
  getPoints(reader, segment);
  reader.finish();
  return segment;
}

std::string toBytes(const TilePoints& tile) {
  TileWriter writer("PNTS", 2, tile.key);
  writer.put(tile.scans);
  putPoints(writer, tile);
  writer.put(tile.scan);
  return writer.take();
}

TilePoints tilePointsFromBytes(std::string_view bytes) {
  TileReader reader(bytes, "PNTS", 2);
  TilePoints tile;
  tile.key = reader.key();
  tile.scans = reader.getMany<scan::ScanId>();
  getPoints(reader, tile);
  tile.scan = reader.getMany<std::uint32_t>(tile.x.size());
  reader.require(allBelow(tile.scan, tile.scans.size()), "names a scan that it does not list");
  reader.finish();
  return tile;
}

}  // namespace cluxel::perception
