// SPDX-License-Identifier: Apache-2.0
// The ground stage's surface, refined by points near it; points above it name things.
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

/// Cells begin at multiples of their edge from the corner of a tile.
GridFrame frameOfArea(const Eigen::AlignedBox2d& area, const perception::TileGrid& tiles, double cell_m) {
  const Eigen::Vector2d corner = tiles.corner().head<2>();
  const Eigen::Vector2d low = corner.array() + ((area.min() - corner) / cell_m).array().floor() * cell_m;
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
  const Eigen::Vector3d corner = stages.grid().cornerOf(low);
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
void fillGround(const mapping::TileStages& stages, TerrainGrid& grid) {
  const GridFrame& frame = grid.frame;
  const int reach = static_cast<int>(std::ceil(kSeenReach_m / frame.cell_m));
  std::vector<std::uint8_t> measured(frame.size(), 0);
  for (const auto& [key, tile] : stages.ground()) {
    const auto ring = ringIn(stages.ground(), key);
    const Eigen::Vector3d corner = stages.grid().cornerOf(key);
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
  for (const rules::SemanticObject& object : map.objects())
    is_surface.push_back(ontology.isA(object.class_iri, rdf::vocabulary::clx("Surface")));
  return is_surface;
}

struct CellThing {
  std::uint32_t cell, thing;
  auto operator<=>(const CellThing&) const = default;
};

/// Points at the height of the ground.
class LowPoints {
 public:
  explicit LowPoints(const TerrainGrid& grid)
      : frame_(grid.frame), surface_(grid.height), had_thing_(grid.height.size(), 0) {}

  void add(std::uint32_t cell, const Eigen::Vector3d& p_map) {
    points_.push_back({cell, (p_map - Eigen::Vector3d(frame_.min_x, frame_.min_y, 0)).cast<float>()});
  }

  /// Something stood in the cell that does not count. Its lowest points may be among those of the ground.
  void addLeftOut(std::uint32_t cell) { had_thing_[cell] = 1; }

  /// Gives each cell the median height of its points, so that a cell at a kerb has the height of the side of which it
  /// holds more; where something stood that is left out, the lower quartile of at least eight heights. Where a cell has
  /// few points, those within half a metre count, moved along the slope of the surface.
  void refine(TerrainGrid& grid) {
    std::stable_sort(points_.begin(), points_.end(), [](const auto& a, const auto& b) { return a.cell < b.cell; });
    first_.assign(frame_.size() + 1, 0);
    for (const LowPoint& point : points_) ++first_[point.cell + 1];
    for (std::size_t cell = 0; cell < frame_.size(); ++cell) first_[cell + 1] += first_[cell];
    const int reach = std::max(1, static_cast<int>(std::lround(0.5 / frame_.cell_m)));
    std::vector<float> heights;
    for (std::uint32_t cell = 0; cell < frame_.size(); ++cell) {
      constexpr std::size_t enough = 3;
      heights.clear();
      if (grid.seen[cell] == 0) continue;
      const Eigen::Vector2f slope(slopeOf(cell, 1, 0), slopeOf(cell, 0, 1));
      // The lowest of few heights may be that of a stray return.
      constexpr std::size_t enough_for_quartile = 8;
      const std::size_t wanted = had_thing_[cell] != 0 ? enough_for_quartile : enough;
      for (int ring = 0; ring <= reach && heights.size() < wanted; ++ring) heightsWithin(cell, ring, slope, heights);
      if (heights.size() < enough) continue;
      const bool takes_quartile = had_thing_[cell] != 0 && heights.size() >= enough_for_quartile;
      const std::size_t rank = heights.size() / (takes_quartile ? 4 : 2);
      const auto chosen = heights.begin() + static_cast<std::ptrdiff_t>(rank);
      std::nth_element(heights.begin(), chosen, heights.end());
      grid.height[cell] = *chosen;
    }
  }

 private:
  struct LowPoint {
    std::uint32_t cell;
    Eigen::Vector3f place;  ///< x and y from the corner of the frame [m], height in the map
  };

  /// Of the cells up to `ring` columns and rows away.
  void heightsWithin(std::uint32_t cell, int ring, const Eigen::Vector2f& slope, std::vector<float>& heights) const {
    heights.clear();
    const int x = frame_.columnOf(cell), y = frame_.rowOf(cell);
    const int left = std::max(0, x - ring), right = std::min(frame_.columns - 1, x + ring);
    const Eigen::Vector2f middle = (frame_.centreOf(cell) - Eigen::Vector2d(frame_.min_x, frame_.min_y)).cast<float>();
    for (int row = std::max(0, y - ring); row <= std::min(frame_.rows - 1, y + ring); ++row)
      for (std::uint32_t i = first_[frame_.index(left, row)]; i < first_[frame_.index(right, row) + 1]; ++i)
        heights.push_back(points_[i].place.z() - slope.dot(points_[i].place.head<2>() - middle));
  }

  /// Of the surface over two metres, as far as there is one.
  float slopeOf(std::uint32_t cell, int dx, int dy) const {
    const int x = frame_.columnOf(cell), y = frame_.rowOf(cell);
    const int reach = std::max(1, static_cast<int>(std::lround(1 / frame_.cell_m)));
    const auto end = [&](int direction) {
      int last = 0;
      for (int i = 1; i <= reach; ++i) {
        const int column = x + direction * i * dx, row = y + direction * i * dy;
        if (!frame_.holds(column, row) || std::isnan(surface_[frame_.index(column, row)])) break;
        last = direction * i;
      }
      return last;
    };
    const int from = end(-1), to = end(1);
    if (from == to) return 0;
    const float rise =
        surface_[frame_.index(x + to * dx, y + to * dy)] - surface_[frame_.index(x + from * dx, y + from * dy)];
    return rise / static_cast<float>((to - from) * frame_.cell_m);
  }

  const GridFrame& frame_;
  std::vector<float> surface_;           ///< NaN outside of tiles
  std::vector<std::uint8_t> had_thing_;  ///< 1: addLeftOut()
  std::vector<LowPoint> points_;
  std::vector<std::uint32_t> first_;  ///< of each cell's points
};

/// Visits the points of all tiles: low ones refine the ground, others become things. The foot of what is left out is no
/// ground, or it would stay as a step.
std::vector<CellThing> thingsOf(const mapping::MapReader& map, const TerrainParams& params,
                                const std::vector<bool>& is_left_out, const TerrainGrid& grid, LowPoints& low) {
  const mapping::TileStages& stages = map.stagesWithPoints();
  const std::vector<bool> is_surface = surfacesAmong(map);
  const auto object_of = mapping::objectOfCluxel({map.objects(), {}}, map.scene().cluxels.size());
  std::vector<CellThing> found;
  std::uint32_t first = 0;
  for (const auto& [key, tile] : stages.cluxels()) {
    const perception::TilePoints& points = stages.points().at(key);
    const auto ring = ringIn(stages.ground(), key);
    const Eigen::Vector3d corner = stages.grid().cornerOf(key);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto cell = grid.frame.cellAt({corner.x() + points.x[i], corner.y() + points.y[i]});
      if (!cell) continue;
      const auto above = static_cast<float>(points.z[i] - groundHeightAt(ring, points.x[i], points.y[i]));
      const std::uint32_t object = object_of[first + tile.point_cluxel[i]];
      const bool is_ground = object != mapping::kNoObject && is_surface[object];
      const bool counts = object == mapping::kNoObject || is_ground || is_left_out.empty() || !is_left_out[object];
      if (!counts && above <= params.highest_m) low.addLeftOut(*cell);
      if (std::abs(above) < params.lowest_m) {
        if (counts) low.add(*cell, corner + Eigen::Vector3d(points.x[i], points.y[i], points.z[i]));
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

TerrainGrid terrainOf(const mapping::MapReader& map, const TerrainParams& params,
                      const std::vector<bool>& is_left_out) {
  TerrainGrid grid;
  grid.frame = params.area ? frameOfArea(*params.area, map.stages().grid(), params.cell_m)
                           : frameOf(map.stages(), params.cell_m);
  const std::size_t size = grid.frame.size();
  grid.height.assign(size, std::numeric_limits<float>::quiet_NaN());
  grid.seen.assign(size, 0);
  fillGround(map.stages(), grid);
  LowPoints low(grid);
  std::vector<CellThing> found = thingsOf(map, params, is_left_out, grid, low);
  low.refine(grid);
  for (float& height : grid.height)
    if (std::isnan(height)) height = 0;
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  grid.first_thing.assign(size + 1, 0);
  for (const CellThing& entry : found) ++grid.first_thing[entry.cell + 1];
  for (std::size_t cell = 0; cell < size; ++cell) grid.first_thing[cell + 1] += grid.first_thing[cell];
  for (const CellThing& entry : found) grid.things.push_back(entry.thing);
  return grid;
}

}  // namespace cluxel::tasks
