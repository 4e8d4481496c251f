// SPDX-License-Identifier: Apache-2.0
// Points are summed in their canonical order.
#include "perception/segments/summary_tile.hpp"

#include <algorithm>
#include <cmath>

#include "perception/tile_bytes.hpp"

namespace cluxel::perception {

namespace {

constexpr double kMillimetres = 1000;
/// Own points are nearer to their mean than this, see kMaxReach_m.
constexpr double kMaxShift_mm = 32767;

struct ViewSum {
  std::uint32_t count = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
};

/// The points of each cluxel, in their order: those of cluxel c are at offset[c] to offset[c + 1].
struct PointsByCluxel {
  std::vector<std::uint32_t> offset, point;
};

PointsByCluxel pointsByCluxel(const CluxelTile& cluxels) {
  PointsByCluxel sorted;
  sorted.offset.assign(cluxels.size() + 1, 0);
  for (const std::uint32_t cluxel : cluxels.point_cluxel) ++sorted.offset[cluxel + 1];
  for (std::size_t c = 0; c < cluxels.size(); ++c) sorted.offset[c + 1] += sorted.offset[c];
  std::vector<std::uint32_t> next(sorted.offset.begin(), sorted.offset.end() - 1);
  sorted.point.resize(cluxels.point_cluxel.size());
  for (std::uint32_t i = 0; i < sorted.point.size(); ++i) sorted.point[next[cluxels.point_cluxel[i]]++] = i;
  return sorted;
}

ViewShift shiftFrom(const Eigen::Vector3f& mean, const ViewSum& view) {
  const Eigen::Vector3d shift = (view.sum / view.count - mean.cast<double>()) * kMillimetres;
  ViewShift rounded;
  for (int axis = 0; axis < 3; ++axis)
    rounded[static_cast<std::size_t>(axis)] =
        static_cast<std::int16_t>(std::lround(std::clamp(shift[axis], -kMaxShift_mm, kMaxShift_mm)));
  return rounded;
}

void addViews(const TilePoints& points, const CluxelTile& cluxels, SummaryTile& tile) {
  const PointsByCluxel sorted = pointsByCluxel(cluxels);
  std::vector<ViewSum> sums(points.scans.size());
  std::vector<std::uint32_t> seen;
  tile.view_offset.assign(1, 0);
  tile.view_offset.reserve(cluxels.size() + 1);
  for (std::size_t c = 0; c < cluxels.size(); ++c) {
    for (std::uint32_t at = sorted.offset[c]; at < sorted.offset[c + 1]; ++at) {
      const std::uint32_t i = sorted.point[at];
      ViewSum& view = sums[points.scan[i]];
      if (view.count++ == 0) seen.push_back(points.scan[i]);
      view.sum += points.at(i).cast<double>();
    }
    std::sort(seen.begin(), seen.end());
    for (const std::uint32_t scan : seen) {
      tile.view_scan.push_back(scan);
      tile.view_point_count.push_back(sums[scan].count);
      tile.view_shift.push_back(shiftFrom(tile.mean[c], sums[scan]));
      sums[scan] = {};
    }
    seen.clear();
    tile.view_offset.push_back(static_cast<std::uint32_t>(tile.view_scan.size()));
  }
}

bool areViews(const SummaryTile& tile) {
  for (std::size_t c = 0; c < tile.size(); ++c) {
    std::uint64_t points = 0;
    for (std::uint32_t v = tile.view_offset[c]; v < tile.view_offset[c + 1]; ++v) {
      if (v > tile.view_offset[c] && tile.view_scan[v] <= tile.view_scan[v - 1]) return false;
      if (tile.view_point_count[v] == 0) return false;
      points += tile.view_point_count[v];
    }
    if (points != tile.point_count[c]) return false;
  }
  return true;
}

std::vector<std::uint32_t> countsOf(const std::vector<std::uint32_t>& offset) {
  std::vector<std::uint32_t> counts;
  for (std::size_t i = 1; i < offset.size(); ++i) counts.push_back(offset[i] - offset[i - 1]);
  return counts;
}

}  // namespace

SummaryTile summaryOf(const TilePoints& points, const CluxelTile& cluxels) {
  SummaryTile tile;
  tile.key = cluxels.key;
  tile.scans = points.scans;
  for (const std::uint32_t seed : cluxels.seed) {
    tile.seed_scan.push_back(points.scan[seed]);
    tile.seed_point.push_back(points.point[seed]);
  }
  for (const Moments& own : cluxels.own) {
    tile.point_count.push_back(static_cast<std::uint32_t>(own.count));
    tile.mean.push_back(own.mean);
  }
  tile.box_min = cluxels.box_min;
  for (std::size_t c = 0; c < cluxels.size(); ++c) tile.size_m.push_back(cluxels.box_max[c] - cluxels.box_min[c]);
  addViews(points, cluxels, tile);
  return tile;
}

std::string toBytes(const SummaryTile& tile) {
  TileWriter writer("SUMM", 1, tile.key);
  writer.put(tile.scans);
  writer.put(tile.seed_scan);
  writer.putSteps(tile.seed_point);
  writer.put(tile.point_count);
  writer.put(tile.mean);
  writer.put(tile.box_min);
  writer.put(tile.size_m);
  writer.put(countsOf(tile.view_offset));
  writer.put(tile.view_scan);
  writer.put(tile.view_point_count);
  writer.put(tile.view_shift);
  return writer.take();
}

namespace {

SummaryTile readSeeds(TileReader& reader) {
  SummaryTile tile;
  tile.key = reader.key();
  tile.scans = reader.getMany<scan::ScanId>();
  tile.seed_scan = reader.getMany<std::uint32_t>();
  tile.seed_point = reader.getSteps(tile.seed_scan.size());
  reader.require(allBelow(tile.seed_scan, tile.scans.size()), "names a scan that it does not list");
  return tile;
}

void readMeans(TileReader& reader, SummaryTile& tile) {
  tile.point_count = reader.getMany<std::uint32_t>(tile.size());
  tile.mean = reader.getMany<Eigen::Vector3f>(tile.size());
  reader.require(allWithin(tile.mean, kMaxHeight_m + kTileSize_m), "has a cluxel that is too far away");
}

}  // namespace

SummaryTile seedsFromBytes(std::string_view bytes) {
  TileReader reader(bytes, "SUMM", 1);
  SummaryTile tile = readSeeds(reader);
  readMeans(reader, tile);
  tile.point_count.clear();
  return tile;
}

std::size_t cluxelsIn(std::string_view bytes) {
  TileReader reader(bytes, "SUMM", 1);
  reader.getMany<scan::ScanId>();
  return reader.getMany<std::uint32_t>().size();
}

SummaryTile summaryTileFromBytes(std::string_view bytes) {
  TileReader reader(bytes, "SUMM", 1);
  SummaryTile tile = readSeeds(reader);
  const std::size_t count = tile.size();
  readMeans(reader, tile);
  tile.box_min = reader.getMany<Eigen::Vector3f>(count);
  tile.size_m = reader.getMany<Eigen::Vector3f>(count);
  for (const auto* vectors : {&tile.box_min, &tile.size_m})
    reader.require(allWithin(*vectors, kMaxHeight_m + kTileSize_m), "has a cluxel that is too far away");
  const auto views = reader.getMany<std::uint32_t>(count);
  tile.view_scan = reader.getMany<std::uint32_t>();
  tile.view_point_count = reader.getMany<std::uint32_t>(tile.view_scan.size());
  tile.view_shift = reader.getMany<ViewShift>(tile.view_scan.size());
  reader.finish();
  std::uint64_t sum = 0;
  tile.view_offset.assign(1, 0);
  for (const std::uint32_t number : views) {
    sum += number;
    reader.require(sum <= tile.view_scan.size(), "has fewer views than it counts");
    tile.view_offset.push_back(static_cast<std::uint32_t>(sum));
  }
  reader.require(sum == tile.view_scan.size(), "has more views than it counts");
  reader.require(allBelow(tile.view_scan, tile.scans.size()), "names a scan that it does not list");
  reader.require(areViews(tile), "has views that are not its cluxels'");
  return tile;
}

}  // namespace cluxel::perception
