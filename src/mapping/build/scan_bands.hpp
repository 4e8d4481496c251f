// SPDX-License-Identifier: Apache-2.0
// The points of a batch that is larger than memory should hold, band by band, from the scans as they are stored.
#pragma once

#include <cstdint>
#include <map>

#include "mapping/clouds/scan_store.hpp"
#include "perception/point_bands.hpp"

namespace cluxel::mapping {

/// Unpacks each scan once, when the first band comes to it. What it has in later bands stays in memory until then.
class ScanBands final : public perception::PointBands {
 public:
  /// A band has rows with `max_points` points or more, of `changes` and of `points_there`, which the tiles had before.
  /// `transaction` must outlive it, and keep its scans.
  ScanBands(const rdf::ReadTransaction& transaction, PointChanges changes,
            const std::map<perception::TileKey, std::uint64_t>& points_there, std::uint64_t max_points,
            unsigned threads);

  perception::Axis axis() const override { return axis_; }
  perception::PointBand next() override;

 private:
  std::int64_t nextEnd();
  void unpackBefore(std::int64_t end);
  /// Whether what the scan has in the tile is wanted: all of tiles that are read anew, in others what is new.
  bool isWanted(const scan::ScanId& scan, const perception::TileKey& tile) const;

  const rdf::ReadTransaction& transaction_;
  PointChanges changes_;  ///< `added`: what is unpacked and in no band yet
  std::uint64_t max_points_;
  unsigned threads_;
  perception::Axis axis_;
  std::map<std::int64_t, std::uint64_t> points_of_row_;  ///< that are in no band yet
  std::multimap<std::int64_t, scan::ScanId> scans_;      ///< by first row: those not unpacked yet
};

}  // namespace cluxel::mapping
