// SPDX-License-Identifier: Apache-2.0
// A point that thinning has dropped belongs to the cluxel of the kept point that stands for it.
#include "mapping/statements/point_owners.hpp"

#include <algorithm>

#include "cluxel/error.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/map_part.hpp"
#include "mapping/stored_grid.hpp"

namespace cluxel::mapping {

namespace {

/// The kept points of an object by scan.
PointAnchor pointsOf(const TileStages& stages, const rules::SemanticObject& object) {
  std::vector<std::uint32_t> members;
  for (const rules::ObjectPart& part : object.parts)
    members.insert(members.end(), part.cluxels.begin(), part.cluxels.end());
  std::sort(members.begin(), members.end());
  PointAnchor points;
  std::uint32_t first = 0;
  for (const auto& [key, summary] : stages.summaries()) {
    const auto last = first + static_cast<std::uint32_t>(summary.size());
    const auto begin = std::lower_bound(members.begin(), members.end(), first);
    if (begin != members.end() && *begin < last) {
      const perception::TilePoints& kept = stages.points().at(key);
      const perception::CluxelTile& tile = stages.cluxels().at(key);
      for (std::size_t i = 0; i < kept.size(); ++i)
        if (std::binary_search(members.begin(), members.end(), first + tile.point_cluxel[i]))
          points[kept.scans[kept.scan[i]]].push_back(kept.point[i]);
    }
    first = last;
  }
  return points;
}

std::vector<std::uint32_t> sampleOf(const scan::ScanId& scan, const std::vector<std::uint32_t>& points) {
  std::vector<std::pair<ContentHash, std::uint32_t>> ranked;
  ranked.reserve(points.size());
  for (const std::uint32_t point : points) ranked.emplace_back(ContentHasher().add(scan).add(point).finish(), point);
  const std::size_t count = std::min(ranked.size(), kAnchorPointsOfAScan);
  std::partial_sort(ranked.begin(), ranked.begin() + static_cast<std::ptrdiff_t>(count), ranked.end());
  std::vector<std::uint32_t> sample;
  for (std::size_t i = 0; i < count; ++i) sample.push_back(ranked[i].second);
  std::sort(sample.begin(), sample.end());
  return sample;
}

}  // namespace

PointAnchor anchorOf(const TileStages& stages, const rules::SemanticObject& object) {
  const PointAnchor points = pointsOf(stages, object);
  if (points.empty()) throw Error(ErrorKind::InvalidArgument, "object " + object.id.hex() + " has no points");
  std::vector<std::pair<std::size_t, scan::ScanId>> scans;
  for (const auto& [scan, numbers] : points) scans.emplace_back(numbers.size(), scan);
  std::sort(scans.begin(), scans.end(),
            [](const auto& a, const auto& b) { return a.first != b.first ? a.first > b.first : a.second < b.second; });
  scans.resize(std::min(scans.size(), kAnchorScans));
  PointAnchor anchor;
  for (const auto& [count, scan] : scans) anchor.emplace(scan, sampleOf(scan, points.at(scan)));
  return anchor;
}

PointAnchor anchorOfStored(const rdf::ReadTransaction& transaction, TileStages& stages, const ContentHash& object) {
  const perception::TileSet tiles = tilesOfObject(transaction, object);
  if (tiles.empty()) throw Error(ErrorKind::NotFound, "the map has no object " + object.hex());
  stages.hold(transaction, tiles, {});
  stages.loadPoints(transaction, tiles);
  rules::SemanticObject here;
  here.id = object;
  rules::ObjectPart& part = here.parts.emplace_back();
  std::uint32_t first = 0;
  for (const perception::TileKey& tile : tiles) {
    const std::optional<TileLayer> layer = storedLayer(transaction, tile);
    if (!layer) continue;
    for (std::uint32_t c = 0; c < layer->size(); ++c)
      if (const std::uint32_t share = layer->share_of_cluxel[c]; share != kNoShare)
        if (layer->shares[share].object == object) part.cluxels.push_back(first + c);
    first += static_cast<std::uint32_t>(layer->size());
  }
  return anchorOf(stages, here);
}

PointOwners::PointOwners(const rdf::ReadTransaction& transaction, TileStages& stages,
                         const perception::ThinParams& thin, const std::vector<Cloud>& clouds)
    : transaction_(transaction), grid_(storedGrid(transaction)), stages_(stages), thin_(thin), clouds_(clouds) {
  std::uint32_t next = 0;
  for (const auto& [key, tile] : stages.summaries()) {
    first_cluxel_.emplace(key, next);
    next += static_cast<std::uint32_t>(tile.size());
  }
}

const PointOwners::Posed* PointOwners::posed(const scan::ScanId& id) {
  if (const auto known = scans_.find(id); known != scans_.end()) return &known->second;
  for (const Cloud& cloud : clouds_)
    if (cloud.id == id)
      return &scans_.emplace(id, Posed{storedPoints(transaction_, id), cloud.T_map_sensor}).first->second;
  return nullptr;
}

void PointOwners::forEachPoint(const PointAnchor& anchor, const std::function<void(const Eigen::Vector3d&)>& visit) {
  for (const auto& [id, points] : anchor) {
    const Posed* scan = posed(id);
    if (scan == nullptr) continue;
    for (const std::uint32_t point : points)
      if (point < scan->points.size())  // a statement that was written by hand may name others
        visit(scan::toMap(scan->T_map_sensor, {scan->points.x[point], scan->points.y[point], scan->points.z[point]}));
  }
}

perception::TileSet PointOwners::tilesOf(const PointAnchor& anchor) {
  perception::TileSet tiles;
  forEachPoint(anchor, [&](const Eigen::Vector3d& p_map) { tiles.insert(grid_.tileOf(p_map)); });
  return tiles;
}

std::vector<std::uint32_t> PointOwners::cluxelsOf(const PointAnchor& anchor) {
  perception::TileSet tiles = tilesOf(anchor);
  std::erase_if(tiles, [&](const perception::TileKey& tile) { return !first_cluxel_.contains(tile); });
  stages_.loadPoints(transaction_, tiles);
  std::vector<std::uint32_t> cluxels;
  forEachPoint(anchor, [&](const Eigen::Vector3d& p_map) {
    const perception::TileKey tile = grid_.tileOf(p_map);
    const auto first = first_cluxel_.find(tile);
    if (first == first_cluxel_.end()) return;
    const CluxelFinder& finder = finders_.try_emplace(tile, grid_, stages_, tile, thin_).first->second;
    cluxels.push_back(first->second + finder.cluxelOf(p_map));
  });
  return cluxels;
}

}  // namespace cluxel::mapping
