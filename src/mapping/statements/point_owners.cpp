// SPDX-License-Identifier: Apache-2.0
// A point that thinning has dropped belongs to the cluxel of the kept point that stands for it.
#include "mapping/statements/point_owners.hpp"

#include <algorithm>

#include "cluxel/error.hpp"

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
  for (const auto& [key, tile] : stages.cluxels()) {
    const auto last = first + static_cast<std::uint32_t>(tile.size());
    const auto begin = std::lower_bound(members.begin(), members.end(), first);
    if (begin != members.end() && *begin < last) {
      const perception::TilePoints& kept = stages.points().at(key);
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

PointOwners::PointOwners(const rdf::ReadTransaction& transaction, const TileStages& stages,
                         const perception::ThinParams& thin, const std::vector<Cloud>& clouds)
    : transaction_(transaction), stages_(stages), thin_(thin), clouds_(clouds) {
  std::uint32_t next = 0;
  for (const auto& [key, tile] : stages.cluxels()) {
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

std::vector<std::uint32_t> PointOwners::cluxelsOf(const PointAnchor& anchor) {
  std::vector<std::uint32_t> cluxels;
  for (const auto& [id, points] : anchor) {
    const Posed* scan = posed(id);
    if (scan == nullptr) continue;
    for (const std::uint32_t point : points) {
      if (point >= scan->points.size()) continue;  // a statement that was written by hand
      const Eigen::Vector3d p_map =
          scan::toMap(scan->T_map_sensor, {scan->points.x[point], scan->points.y[point], scan->points.z[point]});
      const perception::TileKey tile = perception::tileOf(p_map);
      const auto first = first_cluxel_.find(tile);
      if (first == first_cluxel_.end()) continue;
      const auto finder = finders_.try_emplace(tile, stages_.points().at(tile), thin_).first;
      const std::uint32_t kept = finder->second.find(perception::localPoint(tile, p_map));
      if (kept != perception::RepresentativeFinder::kNone)
        cluxels.push_back(first->second + stages_.cluxels().at(tile).point_cluxel[kept]);
    }
  }
  return cluxels;
}

}  // namespace cluxel::mapping
