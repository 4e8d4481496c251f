// SPDX-License-Identifier: Apache-2.0
// Heights are multiples of a step, so that they are stored exactly as whole numbers.
#include "mapping/ways/way_tile.hpp"

#include <algorithm>
#include <cmath>

#include "perception/tile_bytes.hpp"

namespace cluxel::mapping {

namespace {

using perception::TileReader;
using perception::TileWriter;

/// Kerbs over gaps have the mean of two steps.
constexpr double kKerbStep_m = 0.5 * perception::kEvenStep_m;

std::vector<std::uint32_t> wholeSteps(const std::vector<float>& heights, double step_m) {
  std::vector<std::uint32_t> steps;
  steps.reserve(heights.size());
  for (const float height : heights)
    steps.push_back(static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround(height / step_m))));
  return steps;
}

std::vector<float> fromSteps(const std::vector<std::uint32_t>& steps, double step_m) {
  std::vector<float> heights;
  heights.reserve(steps.size());
  for (const std::uint32_t step : steps)
    heights.push_back(static_cast<float>(static_cast<std::int32_t>(step) * step_m));
  return heights;
}

void put(const LineCells& cells, TileWriter& writer) {
  writer.put(cells.cell);
  writer.put(cells.edge_distance2);
  writer.putSteps(wholeSteps(cells.height, perception::kEvenStep_m));
}

LineCells lineCellsFrom(TileReader& reader) {
  LineCells cells;
  cells.cell = reader.getMany<std::uint16_t>();
  cells.edge_distance2 = reader.getMany<std::uint16_t>(cells.cell.size());
  cells.height = fromSteps(reader.getSteps(cells.cell.size()), perception::kEvenStep_m);
  bool ascends = cells.cell.empty() || cells.cell.back() < kCellsOfTile;
  for (std::size_t i = 1; i < cells.cell.size(); ++i) ascends = ascends && cells.cell[i - 1] < cells.cell[i];
  reader.require(ascends, "has impossible cells of lines");
  return cells;
}

static_assert(sizeof(AcrossWay) == 4 && sizeof(RegionPart) == 8);

}  // namespace

std::string toBytes(const WayTile& tile) {
  TileWriter writer("WAYS", 1, tile.key);
  put(tile.middle, writer);
  std::vector<std::uint8_t> left, right, beside;
  for (const AcrossWay& across : tile.across) {
    left.push_back(across.left), right.push_back(across.right);
    beside.push_back(static_cast<std::uint8_t>((across.is_lower ? 1 : 0) + (across.is_higher ? 2 : 0)));
  }
  for (const auto* column : {&left, &right, &beside}) writer.put(*column);
  writer.put(tile.region);
  put(tile.kerbs, writer);
  writer.put(wholeSteps(tile.step_m, kKerbStep_m));
  writer.put(tile.parts);
  std::vector<std::uint16_t> links;
  for (const RegionLink& link : tile.links) links.insert(links.end(), {link.ring, link.own, link.other});
  writer.put(links);
  return writer.take();
}

WayTile wayTileFromBytes(std::string_view bytes) {
  TileReader reader(bytes, "WAYS", 1);
  WayTile tile;
  tile.key = reader.key();
  tile.middle = lineCellsFrom(reader);
  const std::size_t count = tile.middle.cell.size();
  const auto left = reader.getMany<std::uint8_t>(count), right = reader.getMany<std::uint8_t>(count),
             beside = reader.getMany<std::uint8_t>(count);
  tile.across.reserve(count);
  for (std::size_t i = 0; i < count; ++i)
    tile.across.push_back({left[i], right[i], (beside[i] & 1U) != 0, (beside[i] & 2U) != 0});
  tile.region = reader.getMany<std::uint16_t>(count);
  tile.kerbs = lineCellsFrom(reader);
  tile.step_m = fromSteps(reader.getMany<std::uint32_t>(tile.kerbs.cell.size()), kKerbStep_m);
  tile.parts = reader.getMany<RegionPart>();
  const auto links = reader.getMany<std::uint16_t>();
  reader.finish();
  const auto is_part = [&](std::uint16_t part) { return part < tile.parts.size(); };
  for (const std::uint16_t region : tile.region)
    reader.require(region == kNoRegion || is_part(region), "names a part that it does not have");
  for (const RegionPart& part : tile.parts)
    reader.require(
        part.first < kCellsOfTile && std::max({part.min_x, part.min_y, part.max_x, part.max_y}) < kCellsPerTile,
        "has a part outside of the tile");
  reader.require(links.size() % 3 == 0, "has arrays of different lengths");
  for (std::size_t i = 0; i < links.size(); i += 3) {
    reader.require(links[i] < 9 && is_part(links[i + 1]), "has an impossible link");
    tile.links.push_back({static_cast<std::uint8_t>(links[i]), links[i + 1], links[i + 2]});
  }
  return tile;
}

std::string surfaceBytes(const perception::TileKey& key, const SurfaceTile& surface) {
  TileWriter writer("SURF", 1, key);
  std::vector<std::uint8_t> bits(kCellsOfTile / 8);
  for (std::size_t cell = 0; cell < surface.size(); ++cell)
    bits[cell / 8] = static_cast<std::uint8_t>(bits[cell / 8] | surface[cell] << cell % 8);
  writer.put(bits);
  return writer.take();
}

SurfaceTile surfaceTileFromBytes(std::string_view bytes, const perception::TileKey& key) {
  TileReader reader(bytes, "SURF", 1);
  reader.require(reader.key() == key, "is of another tile");
  const auto bits = reader.getMany<std::uint8_t>(kCellsOfTile / 8);
  reader.finish();
  SurfaceTile surface(kCellsOfTile);
  for (std::size_t cell = 0; cell < surface.size(); ++cell) surface[cell] = bits[cell / 8] >> cell % 8 & 1U;
  return surface;
}

}  // namespace cluxel::mapping
