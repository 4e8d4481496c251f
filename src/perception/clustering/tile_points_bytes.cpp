// SPDX-License-Identifier: Apache-2.0
// Stored form of tile points: only their names; everything else follows from the scans.
#include "perception/clustering/tile_points.hpp"
#include "perception/tile_bytes.hpp"

namespace cluxel::perception {

std::string toBytes(const TilePoints& tile) {
  TileWriter writer("PNTS", 3, tile.key);
  writer.put(tile.scans);
  writer.put(tile.scan);
  writer.putSteps(tile.point);
  writer.put(static_cast<std::uint8_t>(tile.intensity.empty() ? 0 : 1));
  writer.leaveOut(tile.x);
  writer.leaveOut(tile.y);
  writer.leaveOut(tile.z);
  writer.leaveOut(tile.intensity);
  writer.leaveOut(tile.rank);
  return writer.take();
}

TilePoints tilePointsFromBytes(std::string_view bytes) {
  TileReader reader(bytes, "PNTS", 3);
  TilePoints tile;
  tile.key = reader.key();
  tile.scans = reader.getMany<scan::ScanId>();
  tile.scan = reader.getMany<std::uint32_t>();
  tile.point = reader.getSteps(tile.scan.size());
  const auto has_intensity = reader.get<std::uint8_t>();
  reader.require(has_intensity <= 1, "has an impossible flag");
  reader.require(allBelow(tile.scan, tile.scans.size()), "names a scan that it does not list");
  reader.finish();
  for (auto* values : {&tile.x, &tile.y, &tile.z}) values->resize(tile.point.size());
  tile.intensity.resize(has_intensity * tile.point.size());
  tile.rank.resize(tile.point.size());
  return tile;
}

}  // namespace cluxel::perception
