// SPDX-License-Identifier: Apache-2.0
// Stored form of component and contact tiles.
#include "perception/segments/component_tile.hpp"
#include "perception/segments/contact_tile.hpp"
#include "perception/tile_bytes.hpp"

namespace cluxel::perception {

// Stored as in memory: padding would make equal tiles differ.
static_assert(sizeof(FootprintCell) == 2 * 2 + 4 + 9 * 4);
static_assert(sizeof(Component) == 4 * 4 + 15 * 8 + 8 * 4);
static_assert(sizeof(Contact) == 6 * 4 + 2 * 8);

namespace {

bool isSound(const Component& component) {
  return component.label < scan::kPrimitiveLabelCount && component.points > 0 && component.cluxels > 0;
}

/// Eigen's fixed-size vectors as pairs of floats.
std::vector<float> flat(const std::vector<Eigen::Vector2f>& points) {
  std::vector<float> values;
  for (const Eigen::Vector2f& point : points) values.insert(values.end(), {point.x(), point.y()});
  return values;
}

std::vector<Eigen::Vector2f> pairs(const std::vector<float>& values) {
  std::vector<Eigen::Vector2f> points;
  for (std::size_t i = 0; i + 1 < values.size(); i += 2) points.emplace_back(values[i], values[i + 1]);
  return points;
}

}  // namespace

std::string toBytes(const ComponentTile& tile) {
  TileWriter writer("CMPT", 2, tile.key);
  writer.put(tile.component_of);
  writer.put(tile.components);
  writer.put(tile.cell_offset);
  writer.put(tile.cells);
  writer.put(tile.hull_offset);
  writer.put(flat(tile.hull));
  writer.put(tile.scan_offset);
  writer.put(tile.scans);
  return writer.take();
}

ComponentTile componentTileFromBytes(std::string_view bytes) {
  TileReader reader(bytes, "CMPT", 2);
  ComponentTile tile;
  tile.key = reader.key();
  tile.component_of = reader.getMany<std::uint32_t>();
  tile.components = reader.getMany<Component>();
  tile.cell_offset = reader.getMany<std::uint32_t>(tile.size() + 1);
  tile.cells = reader.getMany<FootprintCell>();
  tile.hull_offset = reader.getMany<std::uint32_t>(tile.size() + 1);
  const auto corners = reader.getMany<float>();
  reader.require(corners.size() % 2 == 0, "has half a corner");
  tile.hull = pairs(corners);
  tile.scan_offset = reader.getMany<std::uint32_t>(tile.size() + 1);
  tile.scans = reader.getMany<scan::ScanId>();
  reader.require(allBelow(tile.component_of, tile.size()), "names a component that is not there");
  reader.require(isOffsets(tile.cell_offset, tile.cells.size()) && isOffsets(tile.hull_offset, tile.hull.size()) &&
                     isOffsets(tile.scan_offset, tile.scans.size()),
                 "has lists that do not fit");
  for (const Component& component : tile.components) reader.require(isSound(component), "has an impossible component");
  for (const FootprintCell& cell : tile.cells)
    reader.require(cell.x < kFootprintCellsPerTile && cell.y < kFootprintCellsPerTile, "has a cell outside its tile");
  reader.finish();
  return tile;
}

std::string toBytes(const ContactTile& tile) {
  TileWriter writer("CNTC", 2, tile.key);
  writer.put(tile.contacts);
  return writer.take();
}

ContactTile contactTileFromBytes(std::string_view bytes) {
  TileReader reader(bytes, "CNTC", 2);
  ContactTile tile;
  tile.key = reader.key();
  tile.contacts = reader.getMany<Contact>();
  for (const Contact& contact : tile.contacts) reader.require(contact.to_ring < 9, "names a tile outside its ring");
  reader.finish();
  return tile;
}

}  // namespace cluxel::perception
