// SPDX-License-Identifier: Apache-2.0
// The cloud layer: scans with points and poses in the map file; tiles get segments cut from them.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mapping/clouds/cloud.hpp"
#include "perception/pipeline.hpp"
#include "rdf/file/environment.hpp"
#include "scan/scan.hpp"

namespace cluxel::mapping {

using TileSet = perception::TileSet;
using ScanSegments = std::map<perception::TileKey, perception::ScanSegment>;

/// What changed of the points of tiles, for TileStages::update().
struct PointChanges {
  perception::TileSegments added;
  TileSet anew;  ///< tiles that lost points or got them at other places
  /// Scans that were added, too, whose points are read again when the stages come to them: by id the lowest x and y of
  /// their tiles. They are stored.
  std::map<scan::ScanId, perception::TileKey> stored;
  /// How many points these, and scans that moved, have in each tile.
  std::map<perception::TileKey, std::uint64_t> stored_points;
  /// Scans that may have points in `anew`, where these are read when the stages come to them: the lowest x and y of the
  /// tiles. Empty where they are in `added`.
  std::map<scan::ScanId, perception::TileKey> scans_anew;
  /// Another map with the same model and settings. All its scans were copied to this map, and its tiles come with them.
  /// Tiles that both maps have are in `anew`.
  const rdf::ReadTransaction* copied = nullptr;
  /// Nothing else changes in the transaction, so that a large batch may commit some of what it writes early.
  bool is_alone = false;
  bool is_lender = false;  ///< what it decided may be taken, too: it has the same inputs (canLendDecisions())

  TileSet tiles() const;
  bool hasAdded() const { return !added.empty() || !stored.empty(); }
  /// Whether there are so many points that none stays in memory, and nothing else changes.
  bool mayCommitEarly() const { return is_alone && !stored.empty(); }
  /// Adds all points of `anew`.
  void readAnew(const rdf::ReadTransaction& transaction);
  /// Notes the scans that have them instead, so that none stay in memory.
  void noteAnew(const rdf::ReadTransaction& transaction);
  /// Adds what a stored scan has. From one and a half times `part_points` points on, none stay in memory.
  void add(ScanSegments segments, std::uint64_t part_points);

 private:
  void note(const perception::ScanSegment& segment);

  std::uint64_t points_ = 0;
};

/// All of a scan that is stored or goes through the stages. A function of the scan alone, so that scans can be prepared
/// on several threads.
struct PreparedScan {
  Cloud cloud;
  std::string packed_points;
  ScanSegments segments;
};

/// Throws InputError for a scan that cannot be of a place (requirePlausible()), or whose time has no date.
PreparedScan prepareScan(const scan::Scan& scan, const perception::TileGrid& grid);

/// Stores a scan; returns its points by tile. A scan that was measured alike and has the same pose is the same cloud:
/// nothing is stored but the later of the two times (a time is later than none), and nothing is returned. The same scan
/// with another pose, or with a pose where there was none, is an InputError.
ScanSegments storeScan(rdf::WriteTransaction& transaction, const scan::Scan& scan);
ScanSegments storeScan(rdf::WriteTransaction& transaction, PreparedScan scan);

/// How the pose of a scan differs from the one that it has elsewhere: "with another pose (0.123 m and 0.450 degrees
/// away)". Nothing where both are equal.
std::optional<std::string> differenceOfPoses(const Cloud& given, const Cloud& there);

/// Gives a stored scan another time.
void storeTime(rdf::WriteTransaction& transaction, Cloud cloud, double time_s);

/// Copies a scan of another map as it is stored there. False, and the later of both times, when the scan is here.
/// Errors as for storeScan().
bool copyScan(rdf::WriteTransaction& transaction, const rdf::ReadTransaction& other, const Cloud& cloud);

/// Removes a scan; returns the tiles that it touched. Throws Error (NotFound) when there is none.
TileSet removeScan(rdf::WriteTransaction& transaction, const scan::ScanId& id);

/// The points of these scans by tile, in their order, read on the calling thread and unpacked on up to `threads`.
std::vector<ScanSegments> segmentsOfScans(const rdf::ReadTransaction& transaction, std::span<const scan::ScanId> scans,
                                          unsigned threads);

/// A cloud with its points as the scan that it was given as.
scan::Scan scanOf(const Cloud& cloud, scan::ScanPoints points);
/// A stored scan as it was given. Throws Error (NotFound) when there is none.
scan::Scan storedScan(const rdf::ReadTransaction& transaction, const scan::ScanId& id);

/// All tiles that hold points of some scan, as of the last run of the stages.
TileSet storedTiles(const rdf::ReadTransaction& transaction);
void storeTiles(rdf::WriteTransaction& transaction, const TileSet& tiles);

/// Those of `tiles` that lie within the bounds of the cloud, a box: all in which it can have points.
TileSet tilesInBounds(const Cloud& cloud, const TileSet& tiles, const perception::TileGrid& grid);
/// The clouds of the map, ascending by id.
std::vector<Cloud> storedClouds(const rdf::ReadTransaction& transaction);
std::optional<Cloud> storedCloud(const rdf::ReadTransaction& transaction, const scan::ScanId& id);
/// Throws Error (NotFound) when there is none.
Cloud requiredCloud(const rdf::ReadTransaction& transaction, const scan::ScanId& id);
/// Points of a cloud as they were given.
scan::ScanPoints storedPoints(const rdf::ReadTransaction& transaction, const scan::ScanId& id);

}  // namespace cluxel::mapping
