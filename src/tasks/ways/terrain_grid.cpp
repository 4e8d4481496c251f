// SPDX-License-Identifier: Apache-2.0
// Points near the ground refine its height; points above it name things.
#include "tasks/ways/terrain_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cluxel/error.hpp"
#include "mapping/build/tile_stages.hpp"
#include "mapping/facts/object_geometry.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::tasks {

namespace {

using perception::kStackSize_m;
using perception::kStacksPerTile;
using perception::kTileSize_m;
using perception::TileKey;

constexpr std::uint64_t kMaxCells = 200'000'000;

GridFrame boundedFrame(const GridFrame& frame, double columns, double rows) {
  if (!(columns * rows <= static_cast<double>(kMaxCells)))
    throw Error(ErrorKind::BudgetExceeded, "the extent is too large for a grid of cells of " +
                                               std::to_string(frame.cell_m) + " m; choose larger cells");
  GridFrame bounded = frame;
  bounded.columns = static_cast<int>(columns);
  bounded.rows = static_cast<int>(rows);
  return bounded;
}

/// Cells begin at multiples of their edge.
GridFrame frameOfArea(const Eigen::AlignedBox2d& area, double cell_m) {
  const Eigen::Vector2d low = (area.min() / cell_m).array().floor() * cell_m;
  const Eigen::Vector2d count = ((area.max() - low) / cell_m).array().ceil();
  return boundedFrame({low.x(), low.y(), cell_m, 0, 0}, std::max(1.0, count.x()), std::max(1.0, count.y()));
}

GridFrame frameOf(const mapping::TileStages& stages, double cell_m) {
  if (stages.ground().empty()) throw Error(ErrorKind::NotFound, "the map has no ground: it holds no points");
  TileKey low = stages.ground().begin()->first, high = low;
  for (const auto& [key, tile] : stages.ground()) {
    low = {std::min(low.x, key.x), std::min(low.y, key.y)};
    high = {std::max(high.x, key.x), std::max(high.y, key.y)};
  }
  GridFrame frame{low.x * kTileSize_m, low.y * kTileSize_m, cell_m, 0, 0};
  const double columns = std::ceil((high.x - low.x + 1) * kTileSize_m / cell_m);
  const double rows = std::ceil((high.y - low.y + 1) * kTileSize_m / cell_m);
  return boundedFrame(frame, columns, rows);
}

/// Heights of the ground surface, and where it was measured.
void fillGround(const mapping::TileStages& stages, TerrainGrid& grid) {
  const GridFrame& frame = grid.frame;
  const int reach = static_cast<int>(std::ceil(kSeenReach_m / frame.cell_m));
  std::vector<std::uint8_t> measured(frame.size(), 0);
  for (const auto& [key, tile] : stages.ground()) {
    const auto ring = ringIn(stages.ground(), key);
    const Eigen::Vector3d corner = cornerOf(key);
    const int first_column = static_cast<int>(std::round((corner.x() - frame.min_x) / frame.cell_m));
    const int first_row = static_cast<int>(std::round((corner.y() - frame.min_y) / frame.cell_m));
    const int count = static_cast<int>(std::round(kTileSize_m / frame.cell_m));
    for (int i = 0; i < count * count; ++i) {
      const int column = first_column + i % count, row = first_row + i / count;
      if (!frame.holds(column, row)) continue;
      const std::uint32_t cell = frame.index(column, row);
      const Eigen::Vector2d local = frame.centreOf(cell) - corner.head<2>();
      grid.height[cell] = static_cast<float>(groundHeightAt(ring, local.x(), local.y()));
      const int x = std::clamp(static_cast<int>(local.x() / kStackSize_m), 0, kStacksPerTile - 1);
      const int y = std::clamp(static_cast<int>(local.y() / kStackSize_m), 0, kStacksPerTile - 1);
      measured[cell] =
          tile.source[static_cast<std::size_t>(y * kStacksPerTile + x)] == perception::GroundSource::Measured;
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
  for (const rules::SemanticObject& object : map.objects())
    is_surface.push_back(ontology.isA(object.class_iri, rdf::vocabulary::clx("Surface")));
  return is_surface;
}

struct CellThing {
  std::uint32_t cell, thing;
  auto operator<=>(const CellThing&) const = default;
};

/// Sums of points at the height of the ground.
struct LowPoints {
  std::vector<float> sum;
  std::vector<std::uint32_t> count;
};

/// Visits the points of all tiles: low ones refine the ground, others become things.
std::vector<CellThing> thingsOf(const mapping::MapReader& map, const TerrainParams& params, const TerrainGrid& grid,
                                LowPoints& low) {
  const mapping::TileStages& stages = map.stagesWithPoints();
  const std::vector<bool> is_surface = surfacesAmong(map);
  const auto object_of = mapping::objectOfCluxel({map.objects(), {}}, map.scene().cluxels.size());
  std::vector<CellThing> found;
  std::uint32_t first = 0;
  for (const auto& [key, tile] : stages.cluxels()) {
    const perception::TilePoints& points = stages.points().at(key);
    const Eigen::Vector3d corner = cornerOf(key);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto cell = grid.frame.cellAt({corner.x() + points.x[i], corner.y() + points.y[i]});
      if (!cell) continue;
      const float above = points.z[i] - grid.height[*cell];
      const std::uint32_t object = object_of[first + tile.point_cluxel[i]];
      const bool is_ground = object != mapping::kNoObject && is_surface[object];
      if (std::abs(above) < params.lowest_m) {
        low.sum[*cell] += above;
        ++low.count[*cell];
      } else if (!is_ground && above > 0 && above <= params.highest_m) {
        found.push_back({*cell, object == mapping::kNoObject ? kUnnamedThing : object});
      }
    }
    first += static_cast<std::uint32_t>(tile.size());
  }
  return found;
}

}  // namespace

std::optional<std::uint32_t> GridFrame::cellAt(const Eigen::Vector2d& p_map) const {
  const double column = std::floor((p_map.x() - min_x) / cell_m), row = std::floor((p_map.y() - min_y) / cell_m);
  if (!(column >= 0 && row >= 0 && column < columns && row < rows)) return std::nullopt;
  return index(static_cast<int>(column), static_cast<int>(row));
}

TerrainGrid terrainOf(const mapping::MapReader& map, const TerrainParams& params) {
  TerrainGrid grid;
  grid.frame = params.area ? frameOfArea(*params.area, params.cell_m) : frameOf(map.stages(), params.cell_m);
  const std::size_t size = grid.frame.size();
  grid.height.assign(size, 0.0F);
  grid.seen.assign(size, 0);
  fillGround(map.stages(), grid);
  LowPoints low{std::vector<float>(size, 0.0F), std::vector<std::uint32_t>(size, 0)};
  std::vector<CellThing> found = thingsOf(map, params, grid, low);
  constexpr std::uint32_t min_points = 3;
  for (std::size_t cell = 0; cell < size; ++cell)
    if (low.count[cell] >= min_points) grid.height[cell] += low.sum[cell] / static_cast<float>(low.count[cell]);
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  grid.first_thing.assign(size + 1, 0);
  for (const CellThing& entry : found) ++grid.first_thing[entry.cell + 1];
  for (std::size_t cell = 0; cell < size; ++cell) grid.first_thing[cell + 1] += grid.first_thing[cell];
  for (const CellThing& entry : found) grid.things.push_back(entry.thing);
  return grid;
}

}  // namespace cluxel::tasks
