// SPDX-License-Identifier: Apache-2.0
// The ground stage's surface, refined by points near it; points above it name things. No more than a region's points
// are in memory.
#include "tasks/ways/terrain_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/text/short_number.hpp"
#include "cluxel/error.hpp"
#include "mapping/regions/tile_objects.hpp"
#include "mapping/stored_grid.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rdf/vocabulary.hpp"
#include "tasks/ways/low_points.hpp"

namespace cluxel::tasks {

namespace {

using perception::kStackSize_m;
using perception::kStacksPerTile;
using perception::kTileSize_m;
using perception::TileKey;
using GroundTiles = std::map<TileKey, perception::GroundTile>;

/// Of tiles whose points are in memory together.
constexpr std::size_t kCluxelsInMemory = 100'000;

constexpr std::uint64_t kMaxCells = 200'000'000;

GridFrame boundedFrame(const GridFrame& frame, double columns, double rows) {
  if (!(columns * rows <= static_cast<double>(kMaxCells)))
    throw Error(ErrorKind::BudgetExceeded, "the extent is too large for a grid of cells of " +
                                               shortNumber(frame.cell_m) + " m; choose larger cells");
  GridFrame bounded = frame;
  bounded.columns = static_cast<int>(columns);
  bounded.rows = static_cast<int>(rows);
  return bounded;
}

/// Cells begin at multiples of their edge from the corner of a tile.
GridFrame frameOfArea(const Eigen::AlignedBox2d& area, const perception::TileGrid& tiles, double cell_m) {
  const Eigen::Vector2d corner = tiles.corner().head<2>();
  const Eigen::Vector2d low = corner.array() + ((area.min() - corner) / cell_m).array().floor() * cell_m;
  const Eigen::Vector2d count = ((area.max() - low) / cell_m).array().ceil();
  return boundedFrame({low.x(), low.y(), cell_m, 0, 0}, std::max(1.0, count.x()), std::max(1.0, count.y()));
}

GridFrame frameOf(const GroundTiles& ground, const perception::TileGrid& tiles, double cell_m) {
  if (ground.empty()) throw Error(ErrorKind::NotFound, "the map has no ground: it holds no points");
  TileKey low = ground.begin()->first, high = low;
  for (const auto& [key, tile] : ground) {
    low = {std::min(low.x, key.x), std::min(low.y, key.y)};
    high = {std::max(high.x, key.x), std::max(high.y, key.y)};
  }
  const Eigen::Vector3d corner = tiles.cornerOf(low);
  GridFrame frame{corner.x(), corner.y(), cell_m, 0, 0};
  const double columns = std::ceil((high.x - low.x + 1) * kTileSize_m / cell_m);
  const double rows = std::ceil((high.y - low.y + 1) * kTileSize_m / cell_m);
  return boundedFrame(frame, columns, rows);
}

/// Whether ground was measured somewhere in a square of a tile. `local`: its corner relative to that of the tile [m].
bool isMeasured(const perception::GroundTile& tile, const Eigen::Vector2d& local, double edge_m) {
  constexpr double inside_m = 1e-6;
  const auto stackAt = [](double at_m) {
    return std::clamp(static_cast<int>(std::floor(at_m / kStackSize_m)), 0, kStacksPerTile - 1);
  };
  for (int y = stackAt(local.y() + inside_m); y <= stackAt(local.y() + edge_m - inside_m); ++y)
    for (int x = stackAt(local.x() + inside_m); x <= stackAt(local.x() + edge_m - inside_m); ++x)
      if (tile.source[static_cast<std::size_t>(y * kStacksPerTile + x)] == perception::GroundSource::Measured)
        return true;
  return false;
}

/// Heights of the ground surface, and where it was measured.
void fillGround(const GroundTiles& ground, const perception::TileGrid& tiles, TerrainGrid& grid) {
  const GridFrame& frame = grid.frame;
  const int reach = static_cast<int>(std::ceil(kSeenReach_m / frame.cell_m));
  LargeArray<std::uint8_t> measured(frame.size(), 0);
  for (const auto& [key, tile] : ground) {
    const auto ring = ringIn(ground, key);
    const Eigen::Vector3d corner = tiles.cornerOf(key);
    const int first_column = static_cast<int>(std::round((corner.x() - frame.min_x) / frame.cell_m));
    const int first_row = static_cast<int>(std::round((corner.y() - frame.min_y) / frame.cell_m));
    const int count = static_cast<int>(std::round(kTileSize_m / frame.cell_m));
    for (int i = 0; i < count * count; ++i) {
      const int column = first_column + i % count, row = first_row + i / count;
      if (!frame.holds(column, row)) continue;
      const std::uint32_t cell = frame.index(column, row);
      const Eigen::Vector2d local = frame.centreOf(cell) - corner.head<2>();
      grid.height[cell] = static_cast<float>(corner.z() + groundHeightAt(ring, local.x(), local.y()));
      measured[cell] = isMeasured(tile, local.array() - frame.cell_m / 2, frame.cell_m) ? 1 : 0;
    }
  }
  for (std::uint32_t cell = 0; cell < frame.size(); ++cell)
    if (measured[cell] != 0)
      for (int dy = -reach; dy <= reach; ++dy)
        for (int dx = -reach; dx <= reach; ++dx) {
          const int column = frame.columnOf(cell) + dx, row = frame.rowOf(cell) + dy;
          if (frame.holds(column, row) && dx * dx + dy * dy <= reach * reach) grid.seen[frame.index(column, row)] = 1;
        }
}

/// Which objects are surfaces that one walks on.
std::vector<bool> surfacesAmong(const mapping::MapReader& map) {
  const rdf::OntologyView ontology = ontologyViewOf(map.quads());
  std::vector<bool> is_surface;
  for (const std::string& class_iri : map.objectClasses())
    is_surface.push_back(ontology.isA(class_iri, rdf::vocabulary::clx("Surface")));
  return is_surface;
}

struct CellThing {
  std::uint32_t cell, thing;
  auto operator<=>(const CellThing&) const = default;
};

/// Those that may hold points of the grid.
perception::TileSet tilesUnder(const GridFrame& frame, const GroundTiles& ground, const perception::TileGrid& grid) {
  constexpr double margin_m = 0.01;
  const Eigen::Vector2d corner(frame.min_x, frame.min_y), size(frame.columns, frame.rows);
  const Eigen::AlignedBox2d box(corner.array() - margin_m, (corner + frame.cell_m * size).array() + margin_m);
  perception::TileSet tiles;
  for (const auto& [key, tile] : ground) {
    const Eigen::Vector2d low = grid.cornerOf(key).head<2>();
    if (box.intersects(Eigen::AlignedBox2d(low, low.array() + kTileSize_m))) tiles.insert(key);
  }
  return tiles;
}

/// Sorts out the points of tiles: low ones refine the ground, others become things. The foot of what is left out is no
/// ground, or it would stay as a step.
class PointSorter {
 public:
  PointSorter(const mapping::MapReader& map, const TerrainParams& params, const std::vector<bool>& is_left_out,
              const GridFrame& frame)
      : low(frame),
        params_(params),
        is_left_out_(is_left_out),
        frame_(frame),
        grid_(mapping::storedGrid(map.transaction())),
        is_surface_(surfacesAmong(map)) {}

  void add(const mapping::TileOfPoints& tile, const perception::Ring<perception::GroundTile>& ring) {
    const perception::TilePoints& points = tile.points;
    const Eigen::Vector3d corner = grid_.cornerOf(tile.key);
    LargeArray<CellThing> found;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto cell = frame_.cellAt({corner.x() + points.x[i], corner.y() + points.y[i]});
      if (!cell) continue;
      const auto above = static_cast<float>(points.z[i] - groundHeightAt(ring, points.x[i], points.y[i]));
      const std::uint32_t object = tile.object[i];
      const bool is_ground = object != mapping::kNoObjectOfPoint && is_surface_[object];
      const bool counts =
          object == mapping::kNoObjectOfPoint || is_ground || is_left_out_.empty() || !is_left_out_[object];
      if (!counts && above <= params_.highest_m) low.addLeftOut(*cell);
      if (std::abs(above) < params_.lowest_m) {
        if (counts) low.add(*cell, corner + Eigen::Vector3d(points.x[i], points.y[i], points.z[i]));
      } else if (!is_ground && above > 0 && above <= params_.highest_m) {
        found.push_back({*cell, object == mapping::kNoObjectOfPoint ? kUnnamedThing : object});
      }
    }
    std::sort(found.begin(), found.end());
    found_.insert(found_.end(), found.begin(), std::unique(found.begin(), found.end()));
  }

  /// All things, sorted, each once.
  LargeArray<CellThing> takeThings() {
    std::sort(found_.begin(), found_.end());
    found_.erase(std::unique(found_.begin(), found_.end()), found_.end());
    return std::move(found_);
  }

  LowPoints low;

 private:
  const TerrainParams& params_;
  const std::vector<bool>& is_left_out_;
  const GridFrame& frame_;
  const perception::TileGrid grid_;
  std::vector<bool> is_surface_;
  LargeArray<CellThing> found_;
};

}  // namespace

std::optional<std::uint32_t> GridFrame::cellAt(const Eigen::Vector2d& p_map) const {
  const double column = std::floor((p_map.x() - min_x) / cell_m), row = std::floor((p_map.y() - min_y) / cell_m);
  if (!(column >= 0 && row >= 0 && column < columns && row < rows)) return std::nullopt;
  return index(static_cast<int>(column), static_cast<int>(row));
}

TerrainGrid terrainOf(const mapping::MapReader& map, const TerrainParams& params,
                      const std::vector<bool>& is_left_out) {
  TerrainGrid grid;
  const GroundTiles ground = mapping::groundOfTiles(map);
  const perception::TileGrid tiles = mapping::storedGrid(map.transaction());
  grid.frame = params.area ? frameOfArea(*params.area, tiles, params.cell_m) : frameOf(ground, tiles, params.cell_m);
  const std::size_t size = grid.frame.size();
  grid.height.assign(size, std::numeric_limits<float>::quiet_NaN());
  grid.seen.assign(size, 0);
  fillGround(ground, tiles, grid);
  PointSorter sorter(map, params, is_left_out, grid.frame);
  mapping::forEachTileOfPoints(
      map, tilesUnder(grid.frame, ground, tiles),
      [&](const mapping::TileOfPoints& tile) { sorter.add(tile, ringIn(ground, tile.key)); }, kCluxelsInMemory);
  sorter.low.refine(grid);
  const LargeArray<CellThing> found = sorter.takeThings();
  for (float& height : grid.height)
    if (std::isnan(height)) height = 0;
  grid.first_thing.assign(size + 1, 0);
  for (const CellThing& entry : found) ++grid.first_thing[entry.cell + 1];
  for (std::size_t cell = 0; cell < size; ++cell) grid.first_thing[cell + 1] += grid.first_thing[cell];
  for (const CellThing& entry : found) grid.things.push_back(entry.thing);
  return grid;
}

}  // namespace cluxel::tasks
