// SPDX-License-Identifier: Apache-2.0
// Ends a band when its rows have enough points, and unpacks the scans that reach into it.
#include "mapping/build/scan_bands.hpp"

#include <algorithm>
#include <utility>

#include "base/free_memory.hpp"

namespace cluxel::mapping {

using perception::kEndOfRows;
using perception::rowOf;

ScanBands::ScanBands(const rdf::ReadTransaction& transaction, PointChanges changes,
                     const std::map<perception::TileKey, std::uint64_t>& points_there, std::uint64_t max_points,
                     unsigned threads)
    : transaction_(transaction),
      changes_(std::move(changes)),
      max_points_(max_points),
      threads_(threads),
      axis_(perception::longerAxis(changes_.tiles())) {
  for (const auto& [tile, segments] : changes_.added)
    for (const perception::ScanSegment& segment : segments) points_of_row_[rowOf(tile, axis_)] += segment.size();
  for (const auto& [tile, points] : changes_.stored_points) points_of_row_[rowOf(tile, axis_)] += points;
  for (const auto& [tile, points] : points_there) points_of_row_[rowOf(tile, axis_)] += points;
  std::map<scan::ScanId, std::int64_t> first_rows;
  for (const auto* scans : {&changes_.stored, &changes_.scans_anew})
    for (const auto& [scan, lowest] : *scans) {
      const std::int64_t row = rowOf(lowest, axis_);
      const auto [there, is_new] = first_rows.try_emplace(scan, row);
      there->second = std::min(there->second, row);
    }
  for (const auto& [scan, row] : first_rows) scans_.emplace(row, scan);
}

perception::PointBand ScanBands::next() {
  returnFreeMemory();  // of the band before
  perception::PointBand band;
  band.end = nextEnd();
  unpackBefore(band.end);
  if (band.end == kEndOfRows) {
    band.segments = std::exchange(changes_.added, {});
    return band;
  }
  for (auto at = changes_.added.begin(); at != changes_.added.end();) {
    const auto tile = at++;
    if (rowOf(tile->first, axis_) < band.end) band.segments.insert(changes_.added.extract(tile));
  }
  return band;
}

std::int64_t ScanBands::nextEnd() {
  if (points_of_row_.empty()) return kEndOfRows;
  std::uint64_t points = 0;
  do {
    points += points_of_row_.begin()->second;
    points_of_row_.erase(points_of_row_.begin());
  } while (!points_of_row_.empty() && points < max_points_);
  return points_of_row_.empty() ? kEndOfRows : points_of_row_.begin()->first;
}

void ScanBands::unpackBefore(std::int64_t end) {
  constexpr std::size_t kAtOnce = 16;
  while (!scans_.empty() && scans_.begin()->first < end) {
    std::vector<scan::ScanId> scans;
    while (scans.size() < kAtOnce && !scans_.empty() && scans_.begin()->first < end) {
      scans.push_back(scans_.begin()->second);
      scans_.erase(scans_.begin());
    }
    for (ScanSegments& segments : segmentsOfScans(transaction_, scans, threads_))
      for (auto& [tile, segment] : segments)
        if (isWanted(segment.scan, tile)) changes_.added[tile].push_back(std::move(segment));
  }
}

bool ScanBands::isWanted(const scan::ScanId& scan, const perception::TileKey& tile) const {
  return (changes_.anew.contains(tile) ? changes_.scans_anew : changes_.stored).contains(scan);
}

}  // namespace cluxel::mapping
